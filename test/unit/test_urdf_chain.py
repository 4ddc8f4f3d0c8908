"""The serial chain inside a URDF: what is taken, what is held fixed, what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from robots_core.errors import InvalidInputError, UnknownRobotError
from robots_core.robot_model.urdf.urdf_chain import DEFAULT_JERK_TIME, DEFAULT_RAMP_TIME, read_urdf_chain

LIMIT = '<limit lower="-1" upper="2" velocity="3" effort="4"/>'


def joint(name: str, parent: str, child: str, kind: str = 'revolute', inside: str = LIMIT) -> str:
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<axis xyz="0 0 1"/>{inside}</joint>'
    )


def robot(*joints: str, links: str = 'base a b c') -> str:
    bodies = ''.join(f'<link name="{link}"/>' for link in links.split())
    return f'<robot name="test">{bodies}{"".join(joints)}</robot>'


CHAIN = robot(joint('one', 'base', 'a'), joint('two', 'a', 'b'), joint('end', 'b', 'c', 'fixed', ''))


def limits_file(folder: Path, text: str) -> Path:
    file = folder / 'joint_limits.yaml'
    file.write_text(text)
    return file


def test_chain_goes_from_the_root_to_the_end():
    chain = read_urdf_chain(CHAIN)
    assert (chain.base, chain.tip, chain.axes_data.names) == ('base', 'c', ('one', 'two'))
    axes = chain.axes_data
    np.testing.assert_array_equal(
        [axes.lower, axes.upper, axes.velocity, axes.effort], [[-1] * 2, [2] * 2, [3] * 2, [4] * 2]
    )


def test_tool0_is_the_tip_even_if_another_branch_is_longer():
    xml = robot(
        joint('one', 'base', 'tool0'),
        joint('two', 'base', 'a'),
        joint('three', 'a', 'b'),
        links='base a b tool0',
    )
    chain = read_urdf_chain(xml)
    assert (chain.tip, chain.axes_data.names) == ('tool0', ('one',))


def test_base_and_tip_can_be_chosen():
    chain = read_urdf_chain(CHAIN, base='a', tip='b')
    assert (chain.base, chain.tip, chain.axes_data.names) == ('a', 'b', ('two',))
    assert '"base"' not in chain.xml


def test_moving_joints_beside_the_chain_are_held_fixed():
    finger = joint('finger', 'b', 'f', 'prismatic', LIMIT + '<mimic joint="two"/>')
    xml = robot(joint('one', 'base', 'a'), joint('two', 'a', 'b'), finger, links='base a b f')
    chain = read_urdf_chain(xml, tip='b')
    assert chain.axes_data.names == ('one', 'two')
    held = chain.xml.partition('name="finger"')[2]
    assert held.startswith(' type="fixed"')
    assert '<mimic' not in held
    assert '<limit' not in held


def test_without_limits_file_ramps_follow_the_rule():
    axes = read_urdf_chain(CHAIN).axes_data
    np.testing.assert_allclose(axes.acceleration, axes.velocity / DEFAULT_RAMP_TIME)
    np.testing.assert_allclose(axes.jerk, axes.acceleration / DEFAULT_JERK_TIME)


def test_limits_file_goes_before_the_urdf(tmp_path: Path):
    file = limits_file(
        tmp_path,
        """
        joint_limits:
          one: {max_acceleration: 7, max_jerk: 70, max_velocity: 2.5, max_effort: 3.5, gear_ratio: -100}
          two: {min_position: -0.5, max_position: 0.5, has_position_limits: true, rotor_inertia: 1e-4}
          finger: {max_acceleration: 1}
        """,
    )
    axes = read_urdf_chain(CHAIN, joint_limits=file).axes_data
    np.testing.assert_array_equal(axes.acceleration, [7.0, 3.0 / DEFAULT_RAMP_TIME])
    np.testing.assert_array_equal(axes.jerk, [70.0, 3.0 / DEFAULT_RAMP_TIME / DEFAULT_JERK_TIME])
    np.testing.assert_array_equal(axes.velocity, [2.5, 3.0])
    np.testing.assert_array_equal(axes.effort, [3.5, 4.0])
    np.testing.assert_array_equal([axes.lower, axes.upper], [[-1.0, -0.5], [2.0, 0.5]])
    np.testing.assert_array_equal(axes.gear_ratio, [-100.0, np.nan])
    np.testing.assert_array_equal(axes.rotor_inertia, [0.0, 1e-4])


def test_limit_that_is_switched_off_does_not_count(tmp_path: Path):
    file = limits_file(tmp_path, 'joint_limits: {one: {has_acceleration_limits: false, max_acceleration: 7}}')
    axes = read_urdf_chain(CHAIN, joint_limits=file).axes_data
    assert axes.acceleration[0] == 3.0 / DEFAULT_RAMP_TIME


def test_continuous_and_prismatic_axes():
    xml = robot(
        joint('spin', 'base', 'a', 'continuous', '<limit velocity="3" effort="4"/>'),
        joint('slide', 'a', 'b', 'prismatic'),
        links='base a b',
    )
    axes = read_urdf_chain(xml).axes_data
    np.testing.assert_array_equal(axes.continuous, [True, False])
    assert axes.prismatic == (False, True)


def test_friction_of_the_urdf_and_of_the_limits_file(tmp_path: Path):
    xml = robot(
        joint('one', 'base', 'a', inside=f'{LIMIT}<dynamics damping="0.5" friction="2"/>'),
        joint('two', 'a', 'b', inside=f'{LIMIT}<dynamics damping="0.1"/>'),
        links='base a b',
    )
    axes = read_urdf_chain(xml).axes_data
    np.testing.assert_array_equal(axes.coulomb_friction, [2.0, 0.0])
    np.testing.assert_array_equal(axes.viscous_friction, [0.5, 0.1])
    file = limits_file(tmp_path, 'joint_limits: {one: {coulomb_friction: 3, viscous_friction: 0.7}}')
    axes = read_urdf_chain(xml, joint_limits=file).axes_data
    np.testing.assert_array_equal(axes.coulomb_friction, [3.0, 0.0])
    np.testing.assert_array_equal(axes.viscous_friction, [0.7, 0.1])


def test_gear_ratio_of_a_transmission():
    transmission = (
        '<transmission name="t"><joint name="two"/><actuator name="m">'
        '<mechanicalReduction>120</mechanicalReduction></actuator></transmission>'
    )
    axes = read_urdf_chain(CHAIN.replace('</robot>', transmission + '</robot>')).axes_data
    np.testing.assert_array_equal(axes.gear_ratio, [np.nan, 120.0])


@pytest.mark.parametrize(
    ('xml', 'message'),
    [
        ('no xml', 'not a URDF'),
        ('<sdf/>', 'root element is <sdf>'),
        (robot(links='base'), 'no moving joint'),
        (robot(joint('one', 'base', 'a', 'fixed', ''), links='base a'), 'no moving joint'),
        (robot(joint('one', 'base', 'a'), links='base a b'), '2 root links'),
        ('<robot name="x"><joint name="one" type="revolute"/></robot>', "'one' has no <parent>"),
        (robot(joint('one', 'base', 'a', inside=''), links='base a'), 'one: no velocity limit above 0'),
        (
            robot(joint('one', 'base', 'a', inside='<limit velocity="1" effort="0"/>'), links='base a'),
            'one: no effort limit above 0',
        ),
        (
            robot(joint('one', 'base', 'a', inside='<limit velocity="fast" effort="1"/>'), links='base a'),
            "'one': velocity = 'fast' must be a number",
        ),
        (
            robot(joint('one', 'base', 'a'), joint('two', 'a', 'b', 'floating'), links='base a b'),
            "'two' is 'floating'",
        ),
        (
            robot(
                joint('one', 'base', 'a'),
                joint('two', 'a', 'b', inside=LIMIT + '<mimic joint="one"/>'),
                links='base a b',
            ),
            "'two' mimics",
        ),
    ],
)
def test_what_is_no_serial_robot_is_refused(xml: str, message: str):
    with pytest.raises(UnknownRobotError, match=message):
        read_urdf_chain(xml, tip='b' if 'name="two"' in xml else None)


@pytest.mark.parametrize('role', ['base', 'tip'])
def test_unknown_link_is_refused_with_the_known_ones(role: str):
    with pytest.raises(UnknownRobotError, match="'nowhere' not found; links are base, a, b, c"):
        read_urdf_chain(CHAIN, **{role: 'nowhere'})


@pytest.mark.parametrize(
    ('text', 'message'),
    [
        ('joint_limits: [', 'not YAML'),
        ('[1, 2]', 'expected a mapping `joint_limits:`'),
        ('joint_limits: {one: 3}', 'expected a mapping `joint_limits:`'),
        ('joint_limits: {one: {max_jerk: quick}}', "'one': max_jerk = 'quick' must be a number"),
    ],
)
def test_broken_limits_file_is_refused(tmp_path: Path, text: str, message: str):
    with pytest.raises(UnknownRobotError, match=message):
        read_urdf_chain(CHAIN, joint_limits=limits_file(tmp_path, text))


def test_missing_limits_file_is_refused(tmp_path: Path):
    with pytest.raises(UnknownRobotError, match='there is no limits file'):
        read_urdf_chain(CHAIN, joint_limits=tmp_path / 'none.yaml')


def test_limits_that_the_urdf_lacks_can_come_from_the_limits_file(tmp_path: Path):
    xml = robot(joint('one', 'base', 'a', inside='<limit lower="-1" upper="1"/>'), links='base a')
    file = limits_file(tmp_path, 'joint_limits: {one: {max_velocity: 2, max_effort: 3}}')
    axes = read_urdf_chain(xml, joint_limits=file).axes_data
    np.testing.assert_array_equal([axes.velocity, axes.effort], [[2.0], [3.0]])


def test_range_of_no_width_is_refused():
    xml = robot(joint('one', 'base', 'a', inside='<limit velocity="1" effort="1"/>'), links='base a')
    with pytest.raises(InvalidInputError, match='axis one: lower limit 0 must be below upper limit 0'):
        read_urdf_chain(xml)


def test_continuous_axis_with_a_range_in_the_limits_file_turns_within_it(tmp_path: Path):
    xml = robot(joint('one', 'base', 'a', 'continuous', LIMIT), links='base a')
    file = limits_file(tmp_path, 'joint_limits: {one: {min_position: -3, max_position: 3}}')
    chain = read_urdf_chain(xml, joint_limits=file)
    assert not chain.axes_data.continuous[0]
    assert read_urdf_chain(chain.xml).axes_data.upper[0] == 3.0


def test_links_beside_a_loop_are_refused_too():
    loop = robot(joint('one', 'a', 'b'), joint('two', 'b', 'a'), joint('three', 'b', 'c'), links='c base a b')
    with pytest.raises(UnknownRobotError, match='hangs on itself'):
        read_urdf_chain(loop)


def test_endless_chains_are_refused():
    names = [f'l{i}' for i in range(300)]
    joints = [joint(f'j{i}', *names[i : i + 2]) for i in range(299)]
    with pytest.raises(UnknownRobotError, match='over 200 links hang on each other'):
        read_urdf_chain(robot(*joints, links=' '.join(names)))
