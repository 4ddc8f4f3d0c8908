"""Whatever a file of a user holds: it is read, or refused by a RobotsError."""

import contextlib
import copy
import math
import operator
import re
from collections.abc import Callable, Iterator
from datetime import date
from functools import cache, reduce
from pathlib import Path
from typing import Any, Final

import pytest
import trimesh
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from counted_cases import count_cases
from opcua_partners import certificate
from robots_controller.cell.contact_setup import read_contact
from robots_controller.commands.command_table import CHECK_PROGRAM
from robots_controller.io.io_map import read_io_map
from robots_controller.io.plc_script import read_plc_script
from robots_controller.opcua.server_access import ServerAccess
from robots_controller.opcua.server_settings import read_server_settings
from robots_controller.program.files.cell_frames import read_frames
from robots_controller.program.files.persistent_values import PersistentValues
from robots_controller.program.files.taught_points import read_points
from robots_controller.simulate import simulate
from robots_controller.study.study_file import read_study
from robots_core import UrdfRobotModel
from robots_core.blocks import read_scene
from robots_core.blocks.floating_base.orbit import read_orbit
from robots_core.blocks.motion_cueing.cabin import read_cabin
from robots_core.cell_interface.driver_file import read_driver
from robots_core.errors import RobotsError
from robots_core.robot_model.urdf.mesh_file import read_mesh

SCENE = """\
objects:
  - name: table
    box: {size: [1.0, 2.0, 0.1]}
    pose: {position: [1.0, 0.0, 0.5], angles: [1.5, 0, 0]}
    colour: [0.1, 0.2, 0.3]
  - name: pole
    cylinder: {radius: 0.05, length: 2.0}
    pose: {position: [0, 1, 1], quaternion: [0, 0, 0, 2]}
  - name: part
    mesh: {file: part.stl, scale: 0.001}
attached:
  - name: torch
    capsule: {radius: 0.02, length: 0.3}
may_touch:
  - [torch, pole]
zones:
  - name: press
    box: {size: [1.0, 1.0, 2.0]}
    pose: {position: [1.8, 0.0, 1.0], angles: [0.3, 0, 0]}
    keep: out
    what: bodies
    closed_by: {press_open: off, digital_input.2: on}
    shared_with: [/robot_b]
  - name: floor
    plane: {point: [0, 0, 0.1], normal: [0, 0, -1]}
    keep: out
    what: tool
"""
FRAMES = """\
tools:
  gripper:
    position: [0.0, 0.0, 0.24]
    quaternion: [0, 0, 0, 1]
    payload: [12.5, 0.0, 0.0, 0.09]
bases:
  table: {position: [1.4, -0.3, 0.8], angles: [0.5, 0, 0]}
"""
URDF = """\
<robot name="arm">
  <material name="green"><color rgba="0 1 0 0.5"/></material>
  <link name="base"/>
  <link name="upper">
    <inertial><origin xyz="0.5 0 0" rpy="0 0 0"/><mass value="2"/>
      <inertia ixx="0.01" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><origin xyz="0.5 0 0"/><geometry><box size="1 0.1 0.1"/></geometry>
      <material name="green"/></visual>
    <collision><geometry><cylinder radius="0.1" length="0.5"/></geometry></collision>
  </link>
  <link name="tool0">
    <collision><geometry><mesh filename="part.stl" scale="1 1 1"/></geometry></collision></link>
  <joint name="one" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
    <origin xyz="1 0 0" rpy="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="100"/>
    <dynamics damping="1" friction="2"/></joint>
  <joint name="two" type="continuous"><parent link="upper"/><child link="tool0"/><axis xyz="0 1 0"/>
    <limit velocity="1" effort="100"/></joint>
  <transmission name="t"><joint name="one"/>
    <actuator><mechanicalReduction>50</mechanicalReduction></actuator></transmission>
</robot>
"""
LIMITS = """\
joint_limits:
  one: {max_acceleration: 10.0, has_jerk_limits: true, max_jerk: 50, min_position: -1, gear_ratio: 100}
  two: {max_velocity: 2, rotor_inertia: 0.001, coulomb_friction: 1}
"""
CONFIGURATIONS = [path.read_text() for path in sorted(Path('robots_controller/config').glob('*.yaml'))]
IO_MAPS = [text for text in CONFIGURATIONS if '/**' not in text]  # the others are parameters of nodes
CONTACT = Path('programs/wheel_laboratory/regolith_simulant.yaml').read_text()
PLC_SCRIPTS = [path.read_text() for path in sorted(Path('programs/io').glob('*.yaml'))]
DRIVERS = [
    """\
trajectory: /scaled_joint_trajectory_controller/joint_trajectory
joint_states: /joint_states
lead: 0.1
speed_scaling: {topic: /speed_scaling_state_broadcaster/speed_scaling, full: 100}
running: /io_and_status_controller/robot_program_running
""",
    'action: {name: /controller/follow_joint_trajectory, period: 0.2}\nlead: 0.5\n',
    'primitives: {name: /forward_controller/motion_sequence, frame: base}\nrunning: /program_running\n',
]
ORBIT = Path('programs/debris_removal/orbit.yaml').read_text()
CABINS = [path.read_text() for path in sorted(Path('programs/motion_simulator').glob('cabin*.yaml'))]
STUDY = """\
programs: program.lua
robots: [kuka_kr210_r2700, ur5e]
drives: [ideal, rigid_body]
overrides: [1, 0.5]
parameters:
  PARTS: [1, 2, true, welded]
scene: scene_of_study.yaml
io: io_of_study.yaml
longest: 600
"""
ACCESS = """\
anonymous: false
certificate: server.der
key: server.pem
security: [basic256sha256, aes128_sha256_rsaoaep]
trusted: [server.der]
users:
  scada: {password_file: server.pem}
  press: {certificate: server.der, operate: true}
nameplate: {manufacturer: KUKA, model: KR 210 R2700, serial_number: '4711', product_code: x}
"""
POINTS = Path('programs/language/taught_points.points.yaml').read_text()
VALUES = 'values:\n  parts: 3\n  level: 0.5\n  name: table\n  done: true\n  place: [1.0, 2, -3.5]\n'
PROGRAMS = [path.read_text() for path in sorted(Path('programs/language').glob('*.lua'))]
SIMULATED = 3.0  # s
PIECES = re.compile(r'[\w.-]+|\s+|.')
NUMBERS = ['0', '-1', '1e999', '-1e308', 'nan', '.nan', '.inf', 'null', '9' * 5000]
SIGNS = ['', '[]', '{}', '[[', ']', '"', '<', '>', '/>', '&a', '*a', '?', '\t', '\n', '\r', '\0', '\ud800']
TAGS = ['!!int x', '!!binary x', '2001-01-01', '..', '/', 'fixed', 'floating', 'mimic', 'link']
NAMES = ['table', 'base', 'upper', 'tool0', 'one', 'two']
VALUES_OF_ANY_TYPE: Final = (
    *(0, -1, 1e308, -1e308, 1e-308, math.nan, math.inf, 10**400, None, True, date(2001, 1, 1), b'abc'),
    *('', 'x', '..', '/', '.', '~', '~nobody/x', 'a\0b', 5000 * 'x', '1e999', '0x10', '1_0', 'server.pem'),
    *('/dev/zero', 'digital_input.1', 'digital_output.99999999999', 'every 1e-300 s', 'opc.tcp://[', '/a//~'),
    *([], {}, [[]], [1], [1, 2, 3], {'a': 1}, {1: 2}, {None: 3}, {'x': []}),
)
NASTY = st.sampled_from([*NUMBERS, *SIGNS, *TAGS, *NAMES])


@st.composite
def damaged(draw: st.DrawFn, text: str) -> bytes:
    """A text of which some pieces are replaced, repeated, exchanged or lost, or that ends early."""
    pieces = PIECES.findall(text)
    places = st.integers(0, len(pieces) - 1)
    for _ in range(draw(st.integers(1, 4))):
        place, other = draw(places), draw(places)
        match draw(st.sampled_from(('replace', 'repeat', 'exchange', 'end'))):
            case 'replace':
                pieces[place] = draw(NASTY)
            case 'repeat':
                pieces[place] = ' '.join([pieces[place], *pieces[other : other + 9]])
            case 'exchange':
                pieces[place], pieces[other] = pieces[other], pieces[place]
            case _:
                pieces[place:] = [''] * (len(pieces) - place)
    return ''.join(pieces).encode(errors='surrogatepass')


def paths(data: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Keys and indices that lead to each value of a file."""
    entries = data.items() if isinstance(data, dict) else enumerate(data if isinstance(data, list) else ())
    for key, value in entries:
        yield (*path, key)
        yield from paths(value, (*path, key))


@cache
def contents(text: str) -> Any:
    """What a YAML file has; it is not to be changed."""
    return yaml.safe_load(text)


@st.composite
def with_other_values(draw: st.DrawFn, text: str) -> bytes:
    """A YAML file of which some values are of any other type and size."""
    data = copy.deepcopy(contents(text))
    for _ in range(draw(st.integers(1, 3))):
        *above, key = draw(st.sampled_from(list(paths(data))))
        place = reduce(operator.getitem, above, data)
        place[key] = copy.deepcopy(draw(st.sampled_from(VALUES_OF_ANY_TYPE)))
        if not list(paths(data)):
            break
    return str(yaml.dump(data, Dumper=yaml.CSafeDumper, allow_unicode=True)).encode()


def damaged_yaml(text: str) -> st.SearchStrategy[bytes]:
    return damaged(text) | with_other_values(text)


@pytest.fixture(scope='module')
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp('files')
    trimesh.creation.box((1.0, 2.0, 3.0)).export(made / 'part.stl')
    certificate(made, 'server')
    (made / 'program.lua').write_text('local PARTS = 2\nprint(PARTS)\n')
    (made / 'scene_of_study.yaml').write_text('objects: []\n')
    (made / 'io_of_study.yaml').write_text(PLC_SCRIPTS[0])
    return made


def read_robot(path: Path) -> None:
    UrdfRobotModel(path)


def read_access(path: Path) -> None:
    ServerAccess(read_server_settings(path), print)


def read_taught_points(path: Path) -> None:
    read_points(path, num_axes=6)


def read_values(path: Path) -> None:
    PersistentValues(path, kept=False).get('parts')


def cases_of_study(path: Path) -> None:
    read_study(path).cases()


def simulate_shortly(path: Path) -> None:
    simulate(path, robot='kuka_kr210_r2700', longest=SIMULATED)


def refused(read: Callable[[Path], object], path: Path, data: bytes) -> None:
    count_cases('damaged files')
    path.write_bytes(data)
    with contextlib.suppress(RobotsError):
        read(path)


READ = [
    (read_scene, [SCENE]),
    (read_frames, [FRAMES]),
    (read_robot, [URDF]),
    (read_io_map, IO_MAPS),
    (read_contact, [CONTACT]),
    (read_plc_script, PLC_SCRIPTS),
    (read_driver, DRIVERS),
    (read_orbit, [ORBIT]),
    (read_cabin, CABINS),
    (cases_of_study, [STUDY]),
    (read_access, [ACCESS]),
    (read_taught_points, [POINTS]),
    (read_values, [VALUES]),
]


@pytest.mark.parametrize(
    ('read', 'text'), [(read, text) for read, texts in READ for text in texts], ids=lambda _: ''
)
def test_whole_files_are_read(folder: Path, read: Callable[[Path], object], text: str) -> None:
    (folder / 'whole').write_text(text)
    with contextlib.chdir(folder):
        read(folder / 'whole')


@given(data=damaged_yaml(SCENE))
def test_damaged_scenes(folder: Path, data: bytes):
    refused(read_scene, folder / 'scene.yaml', data)


@given(data=damaged_yaml(FRAMES))
def test_damaged_frames(folder: Path, data: bytes):
    refused(read_frames, folder / 'frames.yaml', data)


@given(data=damaged(URDF))
def test_damaged_urdfs(folder: Path, data: bytes):
    (folder / 'joint_limits.yaml').unlink(missing_ok=True)
    refused(read_robot, folder / 'robot.urdf', data)


@given(data=damaged_yaml(LIMITS))
def test_damaged_limits(folder: Path, data: bytes):
    (folder / 'joint_limits.yaml').write_bytes(data)
    refused(read_robot, folder / 'robot.urdf', URDF.encode())


@given(data=st.sampled_from(IO_MAPS).flatmap(damaged_yaml))
def test_damaged_io_maps(folder: Path, data: bytes):
    refused(read_io_map, folder / 'map.yaml', data)


@given(data=damaged_yaml(CONTACT))
def test_damaged_contacts(folder: Path, data: bytes):
    refused(read_contact, folder / 'contact.yaml', data)


@given(data=st.sampled_from(PLC_SCRIPTS).flatmap(damaged_yaml))
def test_damaged_plc_scripts(folder: Path, data: bytes):
    refused(read_plc_script, folder / 'plc.yaml', data)


@given(data=st.sampled_from(DRIVERS).flatmap(damaged_yaml))
def test_damaged_drivers(folder: Path, data: bytes):
    refused(read_driver, folder / 'driver.yaml', data)


@given(data=damaged_yaml(ORBIT))
def test_damaged_orbits(folder: Path, data: bytes):
    refused(read_orbit, folder / 'orbit.yaml', data)


@given(data=st.sampled_from(CABINS).flatmap(damaged_yaml))
def test_damaged_cabins(folder: Path, data: bytes):
    refused(read_cabin, folder / 'cabin.yaml', data)


@given(data=damaged_yaml(STUDY))
def test_damaged_studies(folder: Path, data: bytes):
    refused(cases_of_study, folder / 'study.yaml', data)


@given(data=damaged_yaml(ACCESS))
def test_damaged_accesses(folder: Path, data: bytes):
    with contextlib.chdir(folder):  # from which certificates are named
        refused(read_access, folder / 'access.yaml', data)


@given(data=damaged_yaml(POINTS))
def test_damaged_points(folder: Path, data: bytes):
    refused(read_taught_points, folder / 'program.points.yaml', data)


@given(data=damaged_yaml(VALUES))
def test_damaged_values(folder: Path, data: bytes):
    refused(read_values, folder / 'program.values.yaml', data)


# Each runs for as long as it may.
@settings(max_examples=20 if settings().derandomize else 300)
@given(data=st.sampled_from(PROGRAMS).flatmap(damaged))
def test_damaged_programs(folder: Path, data: bytes):
    (folder / 'damaged.lua').write_bytes(data)
    assert CHECK_PROGRAM.run([str(folder / 'damaged.lua')]) in {0, 1, 2}
    refused(simulate_shortly, folder / 'damaged.lua', data)


MESHES = {
    kind: trimesh.creation.box((1.0, 2.0, 3.0)).export(file_type=kind)
    for kind in ('stl', 'obj', 'ply', 'dae', 'glb')
}


@pytest.mark.parametrize('kind', MESHES)
@given(data=st.data())
def test_damaged_meshes(folder: Path, kind: str, data: st.DataObject):
    whole = MESHES[kind]
    mesh = bytearray(whole.encode() if isinstance(whole, str) else whole)
    for _ in range(data.draw(st.integers(1, 4))):
        place = data.draw(st.integers(0, len(mesh) - 1))
        mesh[place : place + data.draw(st.integers(0, 4))] = data.draw(st.binary(max_size=6))
    refused(read_mesh, folder / f'part_of_its_own.{kind}', bytes(mesh))
