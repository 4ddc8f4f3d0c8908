"""What the README and the pages of the documentation say is so."""

from __future__ import annotations

import re
from dataclasses import fields
from importlib import import_module
from importlib.metadata import entry_points
from pathlib import Path

import pytest

from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS
from robots_core import available_robot_models, load_robot_model
from robots_planning import MotionSettings
from robots_planning.motion_kinds import MOTION_KINDS

from .lua_signatures import signature

ROOT = Path(__file__).parents[2]
README = ROOT / 'README.md'
DOCS = ROOT / 'docs'
PAGES = [README, *sorted(DOCS.glob('*.md'))]
EVERYTHING = '\n'.join(page.read_text() for page in PAGES)


def section(page: Path, title: str) -> str:
    """The text below a heading of a page, up to the next one of the same or a higher level."""
    text = page.read_text()
    level = re.search(rf'^(#+) {re.escape(title)}$', text, re.MULTILINE)
    assert level, f'no heading {title!r} in {page.name}'
    rest = text[level.end() :]
    following = re.search(rf'^#{{1,{len(level.group(1))}}} ', rest, re.MULTILINE)
    return rest[: following.start()] if following else rest


def table(page: Path, title: str) -> list[list[str]]:
    """Rows of the first table of a section, cells stripped, without the heading."""
    found = re.search(r'(?:^\|.*\n)+', section(page, title), re.MULTILINE)
    assert found, f'no table below {title!r}'
    rows = [
        [cell.strip() for cell in re.split(r'(?<!\\)\|', line)[1:-1]] for line in found.group().splitlines()
    ]
    return rows[2:]


def names(cell: str) -> list[str]:
    return re.findall(r'`([^`]+)`', cell)


def test_the_robots_are_those_that_are_installed() -> None:
    listed = {names(row[0])[0]: int(row[1]) for row in table(README, 'The robots')}
    ours = [
        point.name
        for point in entry_points(group='robots_core.robot_models')
        if point.value.startswith('robots_models.')
    ]
    assert set(listed) == set(ours) <= set(available_robot_models())
    for name, axes in listed.items():
        assert load_robot_model(name).num_axes == axes, name


def test_the_nodes_are_the_executables() -> None:
    listed = {(row[1], names(row[0])[0]) for row in table(DOCS / 'nodes.md', 'Nodes and executables')}
    packages = ('robots_core', 'robots_planning', 'robots_controller')
    installed = {
        (point.value.split('.')[0], point.name)
        for point in entry_points(group='console_scripts')
        if point.value.startswith(packages)
    }
    assert listed == installed


def test_the_names_of_the_paper_lead_to_something() -> None:
    rows = table(DOCS / 'from_the_paper.md', 'From the paper to the code')
    assert len(rows) > 15
    for row in rows:
        for name in names(row[1]):
            if '/' in name:
                assert (ROOT / name).is_file(), name
            else:
                module, _, attribute = name.rpartition('.')
                assert hasattr(import_module(module), attribute), name


def test_the_lua_functions_are_those_of_the_interpreter() -> None:
    listed = {
        names(row[0])[0]: (row[1], row[2]) for row in table(DOCS / 'robot_programs.md', 'Robot programs')
    }
    assert listed == {signature(f): (f.doc, f.result or '-') for f in LUA_FUNCTIONS.values()}


def test_the_topics_of_motion_commands_are_those_of_the_table() -> None:
    listed = {
        topic: row[1]
        for row in table(DOCS / 'topics.md', 'Topics')
        if 'command:' in row[3]
        for topic in names(row[0])
    }
    assert listed == {kind.topic: kind.message_type.replace('/msg', '') for kind in MOTION_KINDS}


def test_the_motion_settings_are_those_of_the_planner() -> None:
    listed = {names(row[0])[0]: row[1] for row in table(DOCS / 'planners.md', 'Motion settings')}
    said = {'': 'nearest', False: 'false', 'tool': 'tool0', 'base': "the robot's base", 'payload': 'nothing'}
    said['hold'] = 'what the arm can'
    for field in fields(MotionSettings):
        number = isinstance(field.default, float)
        expected = f'{field.default:g}' if number else said.get(field.name) or said.get(field.default)
        assert listed.pop(field.name) == (expected or field.default)
    assert not listed


def test_the_ten_lines_run(capsys: pytest.CaptureFixture[str]) -> None:
    (code,) = re.findall(r'```python\n(.*?)```', section(README, 'Ten lines'), re.DOTALL)
    exec(compile(code, 'README.md', 'exec'), {})  # noqa: S102  # our own README
    out = capsys.readouterr().out
    assert out.count('all limits kept') == 2


def test_what_pages_link_to_exists() -> None:
    for page in PAGES:
        for target in re.findall(r'\]\(([^)#]+)(?:#[^)]*)?\)', page.read_text()):
            assert '://' in target or (page.parent / target).exists(), f'{page.name}: {target}'


def test_the_readme_leads_to_every_page() -> None:
    text = README.read_text()
    assert not [page.name for page in DOCS.glob('*.md') if f'](docs/{page.name})' not in text]


def test_the_programs_exist() -> None:
    for path in re.findall(r'programs/\w+\.lua', EVERYTHING):
        assert (ROOT / path).is_file(), path


def test_the_make_targets_exist() -> None:
    makefile = (ROOT / 'Makefile').read_text()
    targets = set(re.findall(r'^([a-z][a-z-]*):', makefile, re.MULTILINE))
    code = '\n'.join(
        re.findall(r'```bash\n(.*?)```', EVERYTHING, re.DOTALL) + re.findall(r'`([^`\n]+)`', EVERYTHING)
    )
    named = set(re.findall(r'\bmake ([a-z][a-z-]*)', code))
    assert {'demo', 'test', 'build'} <= named <= targets


def test_the_contributors_page_names_files_that_exist() -> None:
    page = (ROOT / 'docs' / 'contributing.md').read_text()
    files = {path.as_posix() for path in ROOT.glob('robots_*/**/*.py')} | {
        path.as_posix() for path in ROOT.glob('test/**/*.py')
    }
    for name in names(page):
        if name.endswith('.py'):
            assert any(file.endswith(f'/{name}') for file in files), name
