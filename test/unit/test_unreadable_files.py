"""Files that other files name are read as carefully as those: whole, or refused at once."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest
import trimesh

from robots_controller.io.plant.credentials import read_credentials
from robots_controller.opcua.server_access import ServerAccess
from robots_controller.opcua.server_settings import ServerSettings, ServerUser, read_server_settings
from robots_controller.recording.bag_file import read_bag
from robots_controller.study.run_study import ROWS, StudyResults
from robots_core import UrdfRobotModel
from robots_core.errors import RobotsError
from robots_core.files.user_file import when_written
from robots_core.files.yaml_section import parse_yaml
from robots_core.robot_model.urdf.mesh_file import read_mesh
from robots_core.robot_model.urdf.package_places import package_places

XACRO = '<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">{}</robot>'
HUGE = 2_000_000_000  # bytes, none of them on the disk


def make_huge(path: Path) -> None:
    path.touch()
    os.truncate(path, HUGE)


MAKE = {
    'device': (lambda path: path.symlink_to('/dev/zero'), 'it is no regular file'),
    'pipe': (os.mkfifo, 'it is no regular file'),
    'directory': (Path.mkdir, 'is a directory'),
    'circular link': (lambda path: path.symlink_to(path), r'there is no|cannot be read|No such file'),
    'huge': (make_huge, r'has \d+ bytes; at most \d+ are read'),
}


def io_map_certificate(path: Path) -> None:
    read_credentials(parse_yaml(f'certificate: {path}\nkey: {path}', 'map.yaml'))


def settings_certificate(path: Path) -> None:
    file = path.with_name('access.yaml')
    file.write_text(f'users:\n  plc: {{certificate: {path}}}\n')
    read_server_settings(file)


def settings_password(path: Path) -> None:
    file = path.with_name('access.yaml')
    file.write_text(f'users:\n  plc: {{password_file: {path}}}\n')
    read_server_settings(file)


def server_certificate(path: Path) -> None:
    ServerAccess(ServerSettings(users=(ServerUser('plc', operate=True, certificate=str(path)),)), print)


def xacro_include(path: Path) -> None:
    pytest.importorskip('xacro')
    file = path.with_name('arm.xacro')
    file.write_text(XACRO.format(f'<xacro:include filename="{path}"/>'))
    UrdfRobotModel(file, xacro_arguments={})


def xacro_yaml(path: Path) -> None:
    pytest.importorskip('xacro')
    file = path.with_name('arm.xacro')
    file.write_text(XACRO.format(f'<link name="${{xacro.load_yaml(\'{path}\')}}"/>'))
    UrdfRobotModel(file, xacro_arguments={})


READ = [
    io_map_certificate,
    settings_certificate,
    settings_password,
    server_certificate,
    xacro_include,
    xacro_yaml,
]


@pytest.mark.parametrize('kind', MAKE)
@pytest.mark.parametrize('read', READ)
def test_a_named_file_that_cannot_be_read_is_refused(
    tmp_path: Path, read: Callable[[Path], None], kind: str
) -> None:
    make, message = MAKE[kind]
    make(tmp_path / 'named')  # type: ignore[operator]
    with pytest.raises(RobotsError, match=message):
        read(tmp_path / 'named')


@pytest.mark.parametrize('read', [io_map_certificate, settings_certificate, settings_password])
def test_the_refusal_names_the_line_that_names_the_file(tmp_path: Path, read: Callable[[Path], None]) -> None:
    with pytest.raises(RobotsError, match=r'(map\.yaml:1|access\.yaml:2): there is no (certificate|passw)'):
        read(tmp_path / 'missing')


@pytest.mark.parametrize('kind', ['device', 'pipe', 'directory'])
def test_results_of_a_study_that_cannot_be_read_are_refused(tmp_path: Path, kind: str) -> None:
    make, message = MAKE[kind]
    make(tmp_path / ROWS)  # type: ignore[operator]
    with pytest.raises(RobotsError, match=message):
        StudyResults(tmp_path)


def test_results_of_a_study_that_are_nested_without_end_are_refused(tmp_path: Path) -> None:
    (tmp_path / ROWS).write_text(100_000 * '[' + '\n')
    with pytest.raises(RobotsError, match=r'rows\.jsonl:1: no result of a study'):
        StudyResults(tmp_path)


@pytest.mark.parametrize('name', ['bag.mcap', 'bag.db3', 'metadata.yaml'])
@pytest.mark.parametrize('kind', ['device', 'pipe', 'directory'])
def test_bags_that_cannot_be_read_are_refused(tmp_path: Path, name: str, kind: str) -> None:
    make, message = MAKE[kind]
    make(tmp_path / name)  # type: ignore[operator]
    with pytest.raises(RobotsError, match=message):
        read_bag(tmp_path)


def test_a_huge_file_that_is_no_recording_is_refused_by_its_first_bytes(tmp_path: Path) -> None:
    make_huge(tmp_path / 'bag.mcap')
    with pytest.raises(RobotsError, match='is no MCAP file'):
        read_bag(tmp_path / 'bag.mcap')


def test_metadata_of_a_bag_are_bounded(tmp_path: Path) -> None:
    make_huge(tmp_path / 'metadata.yaml')
    with pytest.raises(RobotsError, match=MAKE['huge'][1]):
        read_bag(tmp_path)


@pytest.mark.parametrize('name', ['', 'missing', 300 * 'long', 'null\0'])
def test_what_is_no_file_was_never_written(tmp_path: Path, name: str) -> None:
    assert when_written(tmp_path / name) == 0
    (tmp_path / 'file').write_text('text')
    assert when_written(tmp_path / 'file') == (tmp_path / 'file').stat().st_mtime_ns


@pytest.mark.parametrize('kind', MAKE)
def test_a_package_file_that_cannot_be_read_names_no_package(tmp_path: Path, kind: str) -> None:
    MAKE[kind][0](tmp_path / 'package.xml')  # type: ignore[operator]
    assert tmp_path not in package_places('arm_description', tmp_path)


LAUGHS = 'a: &a [x, x, x, x, x, x, x, x, x, x]\n' + ''.join(
    f'{name}: &{name} [{", ".join(10 * [f"*{before}"])}]\n'
    for before, name in zip('abcdefgh', 'bcdefghi', strict=True)
)


@pytest.mark.parametrize(
    ('read', 'text', 'message'),
    [
        (xacro_yaml, LAUGHS, 'its aliases stand for over'),
        (xacro_yaml, 'a:\n' + 10_000 * '- ', 'nested too deeply'),
        (xacro_include, 10_000 * '<a>' + 10_000 * '</a>', 'cannot be expanded'),
        (xacro_include, 'no XML', 'cannot be expanded'),
    ],
    ids=['many aliases', 'deep YAML', 'deep XML', 'no XML'],
)
def test_nesting_of_files_in_xacro_files_is_bounded(
    tmp_path: Path, read: Callable[[Path], None], text: str, message: str
) -> None:
    (tmp_path / 'named').write_text(text)
    with pytest.raises(RobotsError, match=message):
        read(tmp_path / 'named')


def test_optional_includes_may_be_missing(tmp_path: Path) -> None:
    pytest.importorskip('xacro')
    include = '<xacro:include filename="missing.xacro" optional="true"/><link name="base"/>'
    (tmp_path / 'arm.xacro').write_text(XACRO.format(include))
    with pytest.raises(RobotsError, match='no moving joint'):
        UrdfRobotModel(tmp_path / 'arm.xacro', xacro_arguments={})


@pytest.mark.parametrize('kind', MAKE)
def test_materials_of_a_mesh_that_cannot_be_read_are_left_out(tmp_path: Path, kind: str) -> None:
    mesh = trimesh.creation.box((1.0, 2.0, 3.0))
    text = str(mesh.export(file_type='obj'))
    (tmp_path / 'part.obj').write_text(f'mtllib part.mtl\nusemtl red\n{text}')
    MAKE[kind][0](tmp_path / 'part.mtl')  # type: ignore[operator]
    assert len(read_mesh(tmp_path / 'part.obj').faces) == len(mesh.faces)


def test_data_of_a_mesh_that_cannot_be_read_are_refused(tmp_path: Path) -> None:
    for name, data in trimesh.creation.box((1.0, 2.0, 3.0)).scene().export(file_type='gltf').items():
        (tmp_path / name).write_bytes(data)
    assert len(read_mesh(tmp_path / 'model.gltf').faces) == 12
    for data in tmp_path.glob('*.bin'):
        data.unlink()
        os.mkfifo(data)
    with pytest.raises(RobotsError, match='cannot be read'):
        read_mesh(tmp_path / 'model.gltf')
