"""Motions of Lua programs beyond the paper's: relative, blended, along paths, with switches and settings."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robots_controller.program.joint_feedback import JointFeedback
from robots_controller.program.motions.motion_command import PathSwitch
from robots_core import load_robot_model
from robots_core.errors import PlanningError
from robots_core.pose import Pose
from robots_planning.robot_command_state import RobotCommandState

from .lua_host import DEADLINE, LuaHost

ROUNDING = 1e-12  # m, rad: of a chain of products in double precision


class RobotHost(LuaHost):
    """A host with a KUKA KR 210 that stands where a test puts it."""

    def __init__(self, folder: Path, **options: Any) -> None:
        self.robot = load_robot_model('kuka_kr210_r2700')
        self.q = self.robot.home
        super().__init__(
            folder,
            joint_feedback=lambda: JointFeedback(self.q),
            direct=self.robot.pose,
            **options,
        )


def assert_pose(command: Any, expected: Pose) -> None:
    assert command.pose.distance_to(expected) == pytest.approx((0.0, 0.0), abs=ROUNDING)


def pose(*values: float) -> Pose:
    return Pose.from_angles(values[:3], np.radians(values[3:]))


def test_relative_joint_motions_add_up(tmp_path: Path):
    host = RobotHost(tmp_path)
    assert (
        host.run("""
            ptpJointSpaceAnglesRelative(10, 0, 0, 0, 0, 0)
            ptpJointSpaceAnglesRelative({0, 5, 0, 0, 0, -5})
            ptpJointSpaceAngles(0, -90, 90, 0, 45, 0)
            ptpJointSpaceAnglesRelative(0, 0, 0, 0, 0, 30)""")
        is None
    )
    first, second, _, last = (command.q for command in host.commands)
    np.testing.assert_allclose(first, host.q + np.radians([10, 0, 0, 0, 0, 0]), atol=ROUNDING)
    np.testing.assert_allclose(second, first + np.radians([0, 5, 0, 0, 0, -5]), atol=ROUNDING)
    np.testing.assert_allclose(last, np.radians([0, -90, 90, 0, 45, 30]), atol=ROUNDING)


def test_relative_joint_motion_after_a_line_begins_where_the_robot_is(tmp_path: Path):
    host = RobotHost(tmp_path)
    host.run('ptpCartesianSpace(1, 0, 1, 0, 90, 0) ptpJointSpaceAnglesRelative(1, 0, 0, 0, 0, 0)')
    np.testing.assert_allclose(host.commands[1].q, host.q + np.radians([1, 0, 0, 0, 0, 0]), atol=ROUNDING)


def test_relative_lines_in_base_and_tool_frame(tmp_path: Path):
    host = RobotHost(tmp_path)
    assert (
        host.run("""
            ptpCartesianSpace(1, 0, 1, 0, 90, 0)
            linearRelative(0, 0, 0.1, 0, 0, 0)
            linearRelative(0, 0, 0.2, 0, 0, 0, 'tool')
            linearRelative({0, 0, 0, 90, 0, 0}, {blend = 0.01})
            linearRelative(0.1, 0, 0, 0, 0, 0, 'base')""")
        is None
    )
    _, up, forward, turned, last = host.commands
    assert_pose(up, pose(1, 0, 1.1, 0, 90, 0))
    # The tool's z axis points along the base's x.
    assert_pose(forward, pose(1.2, 0, 1.1, 0, 90, 0))
    assert_pose(turned, pose(1.2, 0, 1.1, 90, 90, 0))
    assert_pose(last, pose(1.3, 0, 1.1, 90, 90, 0))
    assert turned.blend == 0.01


@pytest.mark.parametrize('frame', ['base', 'tool'])
def test_way_there_and_back_is_none(tmp_path: Path, frame: str):
    host = RobotHost(tmp_path)
    assert (
        host.run(f"""
            setTool(0.1, 0, 0.2, 0, 45, 0)
            setBase(1, 0.5, 0, 30, 0, 0)
            ptpJointSpaceAngles(0, -90, 90, 0, 45, 0)
            linearRelative(0, 0, 0, 0, 0, 0)
            linearRelative(0.1, -0.2, 0.05, 0, 0, 0, '{frame}')
            linearRelative(-0.1, 0.2, -0.05, 0, 0, 0, '{frame}')""")
        is None
    )
    _, here, _, back = host.commands
    assert_pose(back, here.pose)
    flange = Pose(*host.robot.direct_kinematics(np.radians([0, -90, 90, 0, 45, 0])))
    expected = pose(1, 0.5, 0, 30, 0, 0).inverse() @ flange @ pose(0.1, 0, 0.2, 0, 45, 0)
    assert_pose(here, expected)


def test_position_is_read_in_degrees_of_tool_and_base(tmp_path: Path):
    host = RobotHost(tmp_path)
    host.q = np.radians([10.0, -80.0, 90.0, 20.0, 40.0, -30.0])
    assert (
        host.run("""
            for i, q in ipairs(getJointAngles()) do setAnalogOutput(i, q) end
            setTool(0, 0, 0.25, 0, 0, 0)
            setBase(1, 0, 0, 0, 0, 0)
            ptpCartesianSpace(getCartesianPosition())""")
        is None
    )
    np.testing.assert_allclose(host.program.analog_outputs[:6], [10, -80, 90, 20, 40, -30], atol=1e-10)
    r, T = host.robot.direct_kinematics(host.q)
    assert_pose(host.commands[0], Pose(r + 0.25 * T[:, 2] - [1, 0, 0], T))


def test_the_payload_travels_with_the_motion(tmp_path: Path):
    host = RobotHost(tmp_path)
    assert (
        host.run("""
            setPayload(5, nil, nil, 0.1)
            ptpJointSpaceAngles(0, -90, 90, 0, 45, 0)""")
        is None
    )
    assert host.commands[0].settings['payload'] == (5.0, 0.0, 0.0, 0.1)


def test_settings_travel_with_the_motion_in_si(tmp_path: Path):
    host = RobotHost(tmp_path)
    assert (
        host.run("""
            ptpJointSpaceAngles(0, -90, 90, 0, 45, 0)
            setSpeed(0.5, 0.25, 90)
            setAcceleration(nil, 1.5)
            setTool(0, 0, 0.2, 90, 0, 0)
            ptpJointSpaceAngles(0, -90, 90, 0, 45, 10)
            setSpeed(1)
            ptpJointSpaceAngles(0, -90, 90, 0, 45, 20)""")
        is None
    )
    first, second, third = (dict(command.settings) for command in host.commands)
    half = np.sqrt(0.5)
    assert first == {}
    assert second.pop('tool') == pytest.approx((0, 0, 0.2, 0, 0, half, half))
    assert second.pop('rotation_speed') == pytest.approx(np.pi / 2)
    assert second == {'speed_fraction': 0.5, 'cartesian_speed': 0.25, 'cartesian_acceleration': 1.5}
    assert third['speed_fraction'] == 1.0
    assert third['cartesian_speed'] == 0.25


def test_override_scales_at_once(tmp_path: Path):
    told: list[float] = []
    host = LuaHost(tmp_path, set_override=told.append)
    assert host.run('setOverride(0.25)') is None
    assert told == [0.25]
    np.testing.assert_array_equal(host.program.overrides, np.full(6, 0.25))


def test_arc_and_spline_are_paths_of_poses(tmp_path: Path):
    host = LuaHost(tmp_path)
    assert (
        host.run("""
            circCartesianSpace({1, 0, 1, 0, 90, 0}, {1, 0.5, 1, 0, 90, 0})
            splineCartesianSpace({1, 0, 1, 0, 90, 0}, {1, 0.5, 1, 0, 90, 0}, {1, 1, 1, 0, 90, 0},
              {blend = 0.05})""")
        is None
    )
    arc, spline = host.commands
    assert arc.kind.state is spline.kind.state is RobotCommandState.TRAJECTORY
    assert [len(arc.path), len(spline.path)] == [2, 3]
    np.testing.assert_array_equal(spline.path[1].r, [1, 0.5, 1])
    assert spline.pose is spline.path[-1]
    assert (arc.blend, spline.blend) == (0.0, 0.05)


def test_blended_motions_follow_each_other_without_waiting(tmp_path: Path):
    flushed: list[int] = []
    host = LuaHost(tmp_path, flush=lambda: flushed.append(len(host.commands)))
    host.holding = True
    host.start("""
        ptpCartesianSpace(1, 0, 1, 0, 90, 0, {blend = 0.05})
        ptpJointSpaceAngles({0, -90, 90, 0, 45, 0}, {jointBlend = 10})
        setDigitalOutput(1, 1)
        wait(0)
        setDigitalOutput(2, 1)""")
    host.wait_for_command()
    host.wait_for_command()
    while not flushed:
        assert not host.program.join(0.001)
    assert [command.blend for command in host.commands] == [0.05, pytest.approx(np.radians(10))]
    assert [dict(c.settings) for c in host.commands] == [
        {'blend_zone': 0.05, 'joint_blend_zone': 0.0},
        {'blend_zone': 0.0, 'joint_blend_zone': pytest.approx(np.radians(10))},
    ]
    assert len(host.program.motions) == 2
    host.program.finish_motion()
    assert not host.program.join(0.05)  # the wait lets both motions finish: it holds
    assert [change.index for change in host.outputs] == [1]
    host.program.finish_motion()
    assert host.program.join(DEADLINE)
    assert flushed == [2]


def test_last_motion_of_a_chain_comes_before_the_end_of_blending(tmp_path: Path):
    flushed: list[int] = []
    host = LuaHost(tmp_path, flush=lambda: flushed.append(len(host.commands)))
    host.holding = True
    host.start("""
        ptpCartesianSpace(1, 0, 1, 0, 90, 0, {blend = 0.05})
        ptpCartesianSpace(1, 0.5, 1, 0, 90, 0)
        ptpCartesianSpace(1, 0, 1, 0, 90, 0)""")
    for _ in range(2):
        host.wait_for_command()
    host.program.finish_motion(None, host.commands[1])
    host.wait_for_command()
    host.program.finish_motion()
    assert host.program.join(DEADLINE)
    assert [command.settings['blend_zone'] for command in host.commands] == [0.05, 0.05, 0.0]
    assert flushed == [2]


def test_result_of_the_last_blended_motion_ends_all(tmp_path: Path):
    host = LuaHost(tmp_path)
    host.holding = True
    host.start("""
        ptpCartesianSpace(1, 0, 1, 0, 90, 0, {blend = 0.05})
        ptpCartesianSpace(1, 0.5, 1, 0, 90, 0)""")
    host.wait_for_command()
    host.wait_for_command()
    host.program.finish_motion(None, host.commands[1])
    assert host.program.join(DEADLINE)
    assert host.program.motions == ()


def test_failure_of_a_blended_motion_names_its_line(tmp_path: Path):
    host = LuaHost(tmp_path)
    host.errors[0] = PlanningError('no way')
    error = host.fails("""
        ptpCartesianSpace(1, 0, 1, 0, 90, 0, {blend = 0.05})
        wait(0)""")
    assert str(error) == 'test.lua:3: ptpCartesianSpace of line 2: no way'


def test_program_ends_when_the_last_blended_motion_does(tmp_path: Path):
    host = LuaHost(tmp_path)
    host.holding = True
    host.start('ptpCartesianSpace(1, 0, 1, 0, 90, 0, {blend = 0.05})')
    host.wait_for_command()
    assert not host.program.join(0.05)
    host.program.finish_motion()
    assert host.program.join(DEADLINE)


def test_switches_on_the_path(tmp_path: Path):
    host = LuaHost(tmp_path)
    assert (
        host.run("""
            ptpCartesianSpace({1, 0, 1, 0, 90, 0},
              {on_path = {distance_before_end = 0.02, output = 1, value = true}})
            ptpCartesianSpace({1, 0, 1, 0, 90, 0}, {on_path = {
              {time_after_start = 0.5, analog_output = 2, value = 1.5},
              {time_before_end = 0.1, output = 3, value = 0}}})""")
        is None
    )
    assert host.commands[0].switches == (PathSwitch('distance_before_end', 0.02, 'digital', 1, 1.0),)
    assert host.commands[1].switches == (
        PathSwitch('time_after_start', 0.5, 'analog', 2, 1.5),
        PathSwitch('time_before_end', 0.1, 'digital', 3, 0.0),
    )
    assert host.outputs == []


MOVE = 'ptpCartesianSpace({1, 0, 1, 0, 90, 0}, '
SWITCH = '{distance_before_end (m) | distance_after_start | time_before_end | time_after_start = ..., '


@pytest.mark.parametrize(
    ('call', 'message'),
    [
        (MOVE + '{blend = 0})', 'ptpCartesianSpace: options.blend = 0 m; valid is a finite number above 0'),
        (MOVE + '{zone = 1})', 'options has no zone; valid are blend (m), avoid and on_path'),
        (MOVE + '{jointBlend = 1})', "has no jointBlend; did you mean 'blend'?; valid are"),
        (MOVE + "{on_path = 'x'})", f"options.on_path = the string 'x'; valid is {SWITCH}"),
        (MOVE + '{on_path = {output = 1, value = 1}})', 'options.on_path has output, value; valid is'),
        (
            MOVE + '{on_path = {{time_before_end = -1, output = 1, value = 1}}})',
            'options.on_path[1].time_before_end = -1 s; valid is a finite number of at least 0',
        ),
        (
            MOVE + '{on_path = {time_before_end = 1, output = 99, value = 1}})',
            'options.on_path.output = 99; valid is a whole number in 1..32',
        ),
        (
            'ptpCartesianSpace({1, 0, 1, 0, 90, 0, blend = 0.1})',
            'blend stands among the values of the target; options are a table of their own',
        ),
        (
            "linearRelative(0, 0, 0, 0, 0, 0, 'world')",
            "frame = the string 'world'; valid is 'base' or 'tool'",
        ),
        ('circCartesianSpace({1, 2}, {3})', 'via = a table with 2 values; valid is a table {x, y, z, phi1'),
        ('circCartesianSpace({1, 0, 1, 0, 90, 0})', 'got 1 arguments, needed are 2: via, target'),
        (
            "splineCartesianSpace({1, 0, 1, 0, 90, 0}, {1, 0, 1, 'x', 90, 0})",
            "pose2.phi1 = the string 'x'; valid is a finite number",
        ),
        ('setSpeed(0)', 'fraction = 0; valid is a number above 0, at most 1'),
        ('setSpeed(1, 0.5, -1)', 'rotation = -1 deg/s; valid is a finite number above 0'),
        ('setSpeed(1, 1e9)', 'cartesian_speed = 1e+09 m/s must be in [1e-05, 20] m/s'),
        ('setSpeed(1, 1, 1e9)', 'must be in [0.00057296, 5729.6] deg/s'),
        ('setTool(0, 0, 1e9, 0, 0, 0)', 'tool[2] = 1e+09 m must be within +-10 m'),
        ('setPayload(1e9)', 'payload[0] = 1e+09'),
        ('ptpCartesianSpace(1, 0, 1, 0, 0, 0, {blend = 1e9})', 'blend_zone = 1e+09 m must be in [0, 1] m'),
        ('setOverride(1.5)', 'value = 1.5; valid is a number in 0..1'),
        ('setPayload(-1)', 'mass = -1.0 kg must be a finite number, 0 or above'),
        ('setTool(1, 2, 3)', 'got 3 arguments, needed are 6: x (m), y (m), z (m), phi1 (deg)'),
        ('getJointAngles()', 'nothing is measured here'),
        ('getJointAngles(1)', 'got 1 arguments, needed are 0'),
    ],
)
def test_wrong_wishes_are_explained(tmp_path: Path, call: str, message: str):
    LuaHost(tmp_path).refuses(call, message)
