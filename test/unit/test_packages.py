"""What the ROS packages declare is what they are."""

from __future__ import annotations

import ast
import json
import re
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from package_of_test import PACKAGES, package_of_test

ROOT = Path(__file__).parents[2]
OURS = re.compile(
    r'robots_\w+|rclpy|launch|launch_ros|ament_index_python|rosidl_generator_py|\w+_(msgs|srvs|interfaces)'
)
"""Modules that are ROS packages by the same name."""
MOST_MODULES = 16
"""In one folder, besides `__init__`: so many are found without a search."""
SENTENCE = re.compile(r'[A-Z].*\.')
IMPORT = re.compile(r"(?:^\s*(?:from|import) |import_module\(')(\w+)", re.MULTILINE)


def manifest(package: str) -> ET.Element:
    return ET.parse(ROOT / package / 'package.xml').getroot()  # noqa: S314  # our own file


@pytest.mark.parametrize('package', PACKAGES)
def test_the_licence_is_in_the_package(package: str) -> None:
    licence = manifest(package).find('license')
    assert licence is not None
    assert licence.text == 'Apache-2.0'
    assert (ROOT / package / licence.get('file', '')).read_bytes() == (ROOT / 'LICENSE').read_bytes()
    setup = (ROOT / package / 'setup.py').read_text()
    assert "'LICENSE'" in setup
    assert "license='Apache-2.0'" in setup


@pytest.mark.parametrize('package', PACKAGES)
def test_the_version_is_that_of_the_setup(package: str) -> None:
    (version,) = re.findall(r"version='(.*)'", (ROOT / package / 'setup.py').read_text())
    assert manifest(package).findtext('version') == version


@pytest.mark.parametrize('package', PACKAGES)
def test_what_is_imported_from_ros_is_declared(package: str) -> None:
    declared = {depend.text for depend in manifest(package).iter('exec_depend')}
    files = [*(ROOT / package / package).rglob('*.py'), *(ROOT / package).glob('launch/*.py')]
    imported = {name for file in files for name in IMPORT.findall(file.read_text())}
    assert {name for name in imported if OURS.fullmatch(name)} - {package} <= declared


@pytest.mark.parametrize('package', PACKAGES)
def test_colcon_runs_the_tests_of_the_package(package: str) -> None:
    settings = json.loads((ROOT / 'colcon.meta').read_text())['names'][package]['pytest-args']
    assert f'--package={package}' in settings
    assert (ROOT / package / settings[-1]).resolve() == ROOT / 'test'
    assert any(package_of_test(file) == package for file in ROOT.glob('test/*/test_*.py'))


@pytest.mark.parametrize('package', PACKAGES)
def test_the_index_page_lists_the_folders(package: str) -> None:
    rows = re.findall(r'^\| `(\w+)` \| (.+) \|$', (ROOT / package / 'README.md').read_text(), re.MULTILINE)
    texts = {init.parent.name: init.read_text() for init in (ROOT / package / package).glob('*/__init__.py')}
    assert rows == [
        (folder, str(ast.get_docstring(ast.parse(text))).splitlines()[0])
        for folder, text in sorted(texts.items())
    ]


def folders(package: str) -> dict[str, Path]:
    """All folders of a package with Python files, by their paths."""
    found = sorted({file.parent for file in (ROOT / package / package).rglob('*.py')})
    return {folder.relative_to(ROOT / package).as_posix(): folder for folder in found}


@pytest.mark.parametrize('package', PACKAGES)
def test_no_folder_holds_more_modules_than_one_finds_at_a_glance(package: str) -> None:
    modules = {name: len(list(folder.glob('*.py'))) - 1 for name, folder in folders(package).items()}
    assert {name: number for name, number in modules.items() if number > MOST_MODULES} == {}


@pytest.mark.parametrize('package', PACKAGES)
def test_each_folder_says_in_a_sentence_what_is_in_it(package: str) -> None:
    said = {
        name: str(ast.get_docstring(ast.parse((folder / '__init__.py').read_text()))).splitlines()[0]
        for name, folder in folders(package).items()
    }
    assert [name for name, text in said.items() if not SENTENCE.fullmatch(text)] == []


@pytest.mark.parametrize('package', PACKAGES)
def test_the_changelog_has_the_form_of_rep_132(package: str) -> None:
    title, *rest = (ROOT / package / 'CHANGELOG.rst').read_text().splitlines()[1:]
    assert title == f'Changelog for package {package}'
    assert rest[0] == '^' * len(title)
    assert rest[2:4] == ['Forthcoming', '-----------']
