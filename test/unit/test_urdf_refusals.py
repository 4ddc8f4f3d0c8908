"""UrdfRobotModel: URDFs that are refused, with file, line and reason."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from robots_core import UrdfRobotModel
from robots_core.errors import InvalidInputError, JointLimitError, RobotsError, UnknownRobotError
from robots_core.robot_model.urdf.urdf_meshes import mesh_path

from .plane_arm import ARM, INERTIAL, write_arm


def test_home_outside_the_limits_is_refused(tmp_path: Path):
    with pytest.raises(JointLimitError, match='one = 0'):
        UrdfRobotModel(write_arm(tmp_path), home=[0.0, 0.0, 0.0])
    with pytest.raises(InvalidInputError, match='home must have shape'):
        UrdfRobotModel(write_arm(tmp_path), home=[1.0])


@pytest.mark.parametrize('name', [5000 * 'x', 'package://[none', 'file://[/x'])
def test_text_that_names_no_mesh_file_is_refused(tmp_path: Path, name: str):
    with pytest.raises(UnknownRobotError, match='names no mesh file'):
        mesh_path(name, tmp_path)


def test_mesh_that_is_missing_or_broken_is_refused(tmp_path: Path):
    with pytest.raises(UnknownRobotError, match=r"'none\.stl' not found"):
        UrdfRobotModel(write_arm(tmp_path, mesh='none.stl'), strict=True)
    (tmp_path / 'broken.stl').write_text('nothing of a mesh')
    with pytest.raises(UnknownRobotError, match='cannot be read'):
        UrdfRobotModel(write_arm(tmp_path, mesh='broken.stl'), strict=True)


def test_missing_urdf_is_refused():
    with pytest.raises(UnknownRobotError, match=r'there is no URDF file /no/where\.urdf'):
        UrdfRobotModel('/no/where.urdf')


def test_xacro_file_is_refused_with_what_to_do(tmp_path: Path):
    text = '<robot name="x" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arm/></robot>'
    with pytest.raises(UnknownRobotError, match='expand it first'):
        UrdfRobotModel(write_arm(tmp_path, text=text))


def body(mass: object = 1.0, moments: str = 'ixx="1" iyy="1" izz="1"') -> str:
    return f'<inertial><mass value="{mass}"/><inertia ixy="0" ixz="0" iyz="0" {moments}/></inertial>'


def write_hand(folder: Path, inertial: str) -> Path:
    hand = f'<link name="hand">{INERTIAL.format(mass=0.5)}</link>'
    assert hand in ARM
    return write_arm(folder, text=ARM.replace(hand, f'<link name="hand">{inertial}</link>'))


@pytest.mark.parametrize(
    ('inertial', 'message'),
    [
        (body(-1.0), r"arm\.urdf:\d+: link 'hand' has a mass of -1 kg; a body has more than 0 kg"),
        (body(0.0), 'has a mass of 0 kg'),
        (body(moments='ixx="-1" iyy="1" izz="1"'), 'moments of inertia of -1, 1 and 1 kg m'),
        (body(moments='ixx="-1e-5" iyy="1" izz="1"'), 'moments of inertia of -1e-05, 1 and 1 kg m'),
        (body('heavy'), "link 'hand': value = 'heavy' of <mass> must be a finite number"),
        (body('1e999'), "'1e999' of <mass> must be a finite number"),
        ('<inertial><mass value="1"/></inertial>', "link 'hand' has an <inertial> without <inertia>"),
    ],
)
def test_masses_and_inertias_of_no_body_are_refused(tmp_path: Path, inertial: str, message: str):
    with pytest.raises(UnknownRobotError, match=message):
        UrdfRobotModel(write_hand(tmp_path, inertial))


@pytest.mark.parametrize(
    'inertial',
    [
        '',
        body(),
        body(moments='ixx="1" iyy="1" izz="2"'),
        body(moments='ixx="-1e-35" iyy="0" izz="1e-35"'),
        body(0, 'ixx="0" iyy="0" izz="0"'),
    ],
)
def test_links_may_be_bodies_or_frames(tmp_path: Path, inertial: str):
    UrdfRobotModel(write_hand(tmp_path, inertial))


def test_a_link_of_no_body_is_refused_beside_a_heavy_one_that_carries_it(tmp_path: Path):
    text = ARM.replace('<link name="tool0"/>', f'<link name="tool0">{body(-0.1)}</link>')
    assert text != ARM
    with pytest.raises(UnknownRobotError, match=r"link 'tool0' has a mass of -0\.1 kg"):
        UrdfRobotModel(write_arm(tmp_path, text=text))


def test_a_link_without_mass_and_inertia_is_a_frame(tmp_path: Path):
    frame = body(0.0, 'ixx="0" iyy="0" izz="0"')
    text = ARM.replace('<link name="tool0"/>', f'<link name="tool0">{frame}</link>')
    UrdfRobotModel(write_arm(tmp_path, text=text))


@pytest.mark.parametrize(
    ('old', 'new', 'line_of', 'message'),
    [
        ('</robot>', '', '', 'not a URDF'),
        ('<child link="hand"/>', '<child link="arm"/>', 'name="three"', "child link 'arm' of joint 'three'"),
        ('<child link="hand"/>', '', 'name="three"', "joint 'three' has no <child> link"),
        ('<child link="hand"/>', '<child link="lower"/>', 'name="three"', "link 'lower' has two parents"),
        ('name="three" ', '', '<joint type="', "'hand' has no name"),
        ('name="three"', 'name="two"', '<child link="hand"/>', "'hand' is named 'two', as another joint is"),
        (
            'name="two" type="revolute"',
            'name="two" type="floating"',
            'name="two"',
            "joint 'two' is 'floating'",
        ),
        ('lower="-2"', 'lower="low"', 'lower="low"', "joint 'two': lower = 'low' must be a number"),
        (
            'lower="-2" upper="2"',
            'lower="2" upper="-2"',
            'name="two"',
            'axis two: lower limit 2 must be below',
        ),
        ('MESH', 300 * 'x' + 'b.stl', 'b.stl', 'names no mesh file'),
    ],
)
def test_refusals_name_file_and_line(tmp_path: Path, old: str, new: str, line_of: str, message: str):
    assert old in ARM
    text = ARM.replace(old, new)
    with pytest.raises(RobotsError, match=message) as caught:
        UrdfRobotModel(write_arm(tmp_path, text=text))
    lines = text.split('\n')
    line = next(number for number, one in enumerate(lines, 1) if line_of in one) if line_of else len(lines)
    assert str(caught.value).startswith(f'arm.urdf:{line}: ')
    assert (caught.value.details['file'], caught.value.details['line']) == ('arm.urdf', line)


@pytest.mark.parametrize(
    ('options', 'message'),
    [
        ({'tip': 'nowhere'}, "arm.urdf: tip link 'nowhere' not found"),
        ({'tip': 'base'}, 'arm.urdf: the URDF has no'),
    ],
)
def test_refusals_without_a_line_name_the_file(tmp_path: Path, options: dict[str, str], message: str):
    with pytest.raises(UnknownRobotError, match=re.escape(message)):
        UrdfRobotModel(write_arm(tmp_path), **options)


def test_refusals_of_an_expanded_file_name_no_line(tmp_path: Path):
    pytest.importorskip('xacro')
    with pytest.raises(UnknownRobotError, match=r"^arm\.urdf: tip link 'nowhere' not found"):
        UrdfRobotModel(write_arm(tmp_path), tip='nowhere', xacro_arguments={})


def test_refusals_of_a_limits_file_name_that_file(tmp_path: Path):
    urdf = write_arm(tmp_path)
    (tmp_path / 'joint_limits.yaml').write_text('joint_limits:\n  one: {max_jerk: high}\n')
    with pytest.raises(UnknownRobotError, match=r"^joint_limits\.yaml: joint 'one': max_jerk = 'high'"):
        UrdfRobotModel(urdf)
