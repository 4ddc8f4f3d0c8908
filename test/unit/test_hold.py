"""Cartesian motions of arms that cannot hold every pose: exact positions, the closest orientations."""

from pathlib import Path

import numpy as np
import pytest

from robots_controller.program_check.walk import walk_program
from robots_controller.report.run_report import RunReport, run_report
from robots_controller.simulate import simulate
from robots_controller.simulation.cell_parts import CellSetup
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core import Pose, load_robot_model
from robots_core.blocks.following.realtime_movement import RealtimeMovement
from robots_core.blocks.inverse_kinematics.closest_orientation_kernel import correct
from robots_core.blocks.inverse_kinematics.held_inverse_kinematics import HeldInverseKinematics
from robots_core.blocks.inverse_kinematics.hold import held_angle, held_by, turns_in_place
from robots_core.errors import InvalidInputError, RobotsError, UnreachablePoseError
from robots_core.kernels.serial_chain import SerialChain
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_planning.guidance.teach_box import TeachBox
from robots_planning.motion_kinds import CIRCLE, JOINT_TO_POSE, LINE, SPLINE, MotionKind
from robots_planning.motion_settings import MotionSettings
from robots_planning.pathplanning import PathPlanning

from .simulated_program import outputs
from .small_arms import name_of, small_arm, start_of, to_the_start

ARMS = [3, 4, 5, 'scara']
PLANNERS = ['limited', 'dynamic_programming']
TOOL = Pose.from_angles([0.02, 0.01, 0.1], [0.2, -0.3, 0.4])
# Inverse kinematics converges to 1e-10; what is planned stays on its path to 2e-7.
EXACT = 1e-9
# Angle by which the orientation may be off the closest one: that of a posture found to 1e-10 rad.
CLOSEST = 1e-8


def tool_at(robot: BaseRobotModel, q: np.ndarray, tool: Pose = TOOL) -> Pose:
    return Pose(*robot.direct_kinematics(q)) @ tool


def a_target(robot: BaseRobotModel, q: np.ndarray, tool: Pose = TOOL) -> Pose:
    """Near, in an orientation that no arm of fewer than six axes has there."""
    here = tool_at(robot, q, tool)
    return Pose(
        here.r + np.array([-0.08, 0.06, 0.05]), Pose.from_angles([0, 0, 0], [0.2, 0.15, -0.25]).T @ here.T
    )


def settings_of(tool: Pose, **others: str) -> MotionSettings:
    return MotionSettings(tool=(*tool.r.tolist(), *tool.quaternion().tolist()), **others)


def turned_least(robot: BaseRobotModel, q: np.ndarray, target: Pose, tool: Pose) -> bool:
    """No self-motion from `q` comes closer to the target's orientation."""
    chain, rng = SerialChain.of(robot, tool), np.random.default_rng(3)
    angle = tool_at(robot, q, tool).distance_to(target)[1]
    for size in (1e-3, 1e-2, 0.1):
        for _ in range(30):
            other = q + size * rng.normal(size=q.size)
            if correct(chain.arrays, other, np.array(target.r), np.array(target.T), 3, 1e-11, 20, 1.0):
                closer = chain.forward(other).distance_to(target)[1] < angle - 1e-9
                if closer and np.abs(other - q).max() < 0.5:
                    return False
    return True


@pytest.mark.parametrize('planner', PLANNERS)
@pytest.mark.parametrize('kind', [LINE, CIRCLE, SPLINE, JOINT_TO_POSE], ids=lambda kind: kind.name)
@pytest.mark.parametrize('which', ARMS)
def test_every_motion_ends_at_its_position_in_the_closest_orientation(
    which: int | str, kind: MotionKind, planner: str
):
    robot, q = small_arm(which), start_of(which)
    target = a_target(robot, q)
    here = tool_at(robot, q)
    via = Pose(0.5 * (here.r + target.r) + [0.0, 0.03, 0.0], here.T)
    wanted = (via, target) if kind.target == 'poses' else target
    settings = settings_of(TOOL, cartesian_planner=planner)
    motion = PathPlanning(robot).plan(kind, q, wanted, settings)  # verified: positions stay on the path
    end = motion.trajectory.position[-1]
    assert tool_at(robot, end).distance_to(target)[0] < EXACT
    if which == 3:
        return
    assert held_angle(robot, end, TOOL, target, 'directions') < CLOSEST
    assert turned_least(robot, end, target, TOOL)


@pytest.mark.parametrize('which', ARMS)
def test_a_pose_that_the_arm_can_have_is_reached_exactly(which: int | str):
    robot, q = small_arm(which), start_of(which)
    goal = q + 0.15 * np.array([1.0, -1.0, 1.0, 0.8, -0.7])[: q.size]
    target = tool_at(robot, goal)
    for kind in (LINE, JOINT_TO_POSE):
        end = PathPlanning(robot).plan(kind, q, target, settings_of(TOOL)).trajectory.position[-1]
        assert max(tool_at(robot, end).distance_to(target)) < 1e-8


@pytest.mark.parametrize('which', ARMS)
def test_a_held_position_leaves_the_orientation_to_the_arm(which: int | str):
    robot, q = small_arm(which), start_of(which)
    target = a_target(robot, q)
    half_turn = Pose(target.r, Pose.from_angles([0, 0, 0], [np.pi, 0, 0]).T @ target.T)
    settings = settings_of(TOOL, hold='position')
    ends = []
    for goal in (target, half_turn):
        motion = PathPlanning(robot).plan(LINE, q, goal, settings)
        ends.append(motion.trajectory.position[-1])
        assert tool_at(robot, ends[-1]).distance_to(target)[0] < EXACT
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-9)


def test_an_arm_of_six_axes_may_hold_a_position_too():
    robot = load_robot_model('ur5e')
    q = np.array([0.2, -1.3, 1.4, -1.2, -1.4, 0.3])
    target = a_target(robot, q)
    motion = PathPlanning(robot).plan(LINE, q, target, settings_of(TOOL, hold='position'))
    position, angle = tool_at(robot, motion.trajectory.position[-1]).distance_to(target)
    assert position < EXACT
    assert angle > 0.1


@pytest.mark.parametrize(
    ('which', 'text'),
    [
        (3, 'arm_3 has 3 axes: in place it cannot turn its tool about any axis'),
        (4, 'arm_4 has 4 axes: in place it cannot turn its tool about .* or .* of the base frame'),
        (5, 'arm_5 has 5 axes: in place it cannot turn its tool about .* of the base frame'),
    ],
)
def test_a_held_pose_is_refused_with_what_the_arm_cannot_hold(which: int, text: str):
    robot, q = small_arm(which), start_of(which)
    for kind in (LINE, JOINT_TO_POSE):
        with pytest.raises(
            RobotsError, match=rf"{text}.*; hold 'directions' or 'position' instead of 'pose'"
        ):
            PathPlanning(robot).plan(kind, q, a_target(robot, q), settings_of(TOOL, hold='pose'))


def test_a_position_out_of_reach_is_refused():
    robot, q = small_arm(4), start_of(4)
    far = Pose(np.array([3.0, 0.0, 0.5]), np.eye(3))
    for kind in (LINE, JOINT_TO_POSE):
        with pytest.raises(UnreachablePoseError, match=r'cannot reach position \(3\.0000.* m off'):
            PathPlanning(robot).plan(kind, q, far)


def test_what_is_held_by_default_follows_from_the_axes():
    assert [held_by(n) for n in (2, 3, 4, 5, 6, 7)] == ['position'] * 2 + ['directions'] * 2 + ['pose'] * 2
    assert held_by(3, 'pose') == held_by(6, 'directions') == 'pose'
    with pytest.raises(
        InvalidInputError, match="'all' is unknown; valid are '', pose, directions and position"
    ):
        MotionSettings(hold='all')


@pytest.mark.parametrize(('which', 'count'), [(3, 0), (4, 1), (5, 2), ('scara', 1)])
def test_an_arm_turns_its_tool_in_as_many_directions_as_it_has_axes_left(which: int | str, count: int):
    robot, q = small_arm(which), start_of(which)
    directions = turns_in_place(robot, q, TOOL)
    assert directions.shape == (3, count)
    np.testing.assert_allclose(directions.T @ directions, np.eye(count), atol=1e-12)


def test_the_inverse_kinematics_finds_the_closest_of_all_orientations():
    robot, rng = small_arm(5), np.random.default_rng(4)
    block = HeldInverseKinematics(robot, tool=TOOL)
    for _ in range(20):
        goal = start_of(5) + rng.uniform(-0.8, 0.8, 5)
        target = tool_at(robot, goal)
        result = block.solve(target, start_of(5))
        assert result.converged
        assert max(result.position_error, result.orientation_error) < 1e-8


@pytest.mark.parametrize('which', ARMS)
def test_the_tool_is_jogged_along_a_line(which: int | str):
    robot, q = small_arm(which), start_of(which)
    box = TeachBox(robot, 0.004, q, tool=TOOL)
    start, now = tool_at(robot, q), 0.0
    for _ in range(200):
        box.jog_tool([0.0, 0.03, 0.0, 0.0, 0.0, 0.0], now)
        step = box.step(now)
        now += 0.004
    way = tool_at(robot, step.q).r - start.r
    assert way[1] == pytest.approx(0.8 * 0.03, rel=0.2)  # it speeds up first
    # A quarter of a millimetre: steps go along the tangent, and are corrected in the next ones.
    assert np.abs(way[[0, 2]]).max() < 2.5e-4


@pytest.mark.parametrize('method', ['constrained', 'damped_least_squares'])
@pytest.mark.parametrize('which', ARMS)
def test_a_guided_arm_follows_positions(which: int | str, method: str):
    robot, q = small_arm(which), start_of(which)
    movement = RealtimeMovement(robot, 0.004, q, tool=TOOL, method=method)
    start, now = tool_at(robot, q), 0.0
    target = Pose(start.r + np.array([0.0, 0.03, 0.02]), start.T)
    for _ in range(500):
        movement.put(target, now)
        step = movement.step(now)
        now += 0.004
    assert step.feasible, step.reason
    assert tool_at(robot, step.q).distance_to(target)[0] < 1e-4


def test_a_closed_form_follows_whole_poses_alone():
    with pytest.raises(
        InvalidInputError, match="'analytical' follows whole poses; for hold = 'position' use"
    ):
        RealtimeMovement(
            load_robot_model('ur5e'),
            0.004,
            [0.2, -1.3, 1.4, -1.2, -1.4, 0.3],
            method='analytical',
            hold='position',
        )


PROGRAM = """
local p = getCartesianPosition()
local function at(x, y, z) return {p[1] + x, p[2] + y, p[3] + z, p[4] + 10, p[5] - 15, p[6] + 20} end
local switch = {distance_before_end = 0.01, output = 1, value = 1}
ptpCartesianSpace(at(-0.05, 0.05, 0.02), {blend = 0.02, on_path = switch})
ptpCartesianSpace(at(-0.08, -0.02, 0.05), {blend = 0.02})
splineCartesianSpace(at(-0.1, 0.0, 0.0), at(-0.05, 0.03, -0.02))
circCartesianSpace(at(-0.03, 0.01, -0.02), at(-0.01, -0.02, -0.02), {blend = 0.01})
ptpJointSpacePosition(at(-0.05, 0.05, 0.02))
linearRelative(0, 0, 0.02, 0, 0, 10, 'tool')
"""


def simulated(folder: Path, which: int | str, text: str) -> tuple[SimulationRun, RunReport]:
    program = folder / 'program.lua'
    program.write_text(f'{to_the_start(which)} {text}')
    run = simulate(program, robot=name_of(which), drive='ideal', bag=folder / 'bag')
    return run, run_report(folder / 'bag')


@pytest.mark.parametrize('which', ARMS)
def test_programs_of_small_arms_run_and_are_judged_by_what_they_hold(tmp_path: Path, which: int | str):
    run, report = simulated(tmp_path, which, PROGRAM)
    assert run.state == 'FINISHED', run.error
    assert report.ok, report.problems
    assert [motion.command.line for motion in run.motions] == [1, 5, 6, 7, 8, 9, 10]
    assert len(outputs(run)) == 1
    problems = walk_program(CellSetup(program=tmp_path / 'program.lua', robot=name_of(which))).problems
    assert [problem.reason for problem in problems] == []


def test_a_program_that_holds_poses_says_what_its_arm_cannot_hold(tmp_path: Path):
    run, report = simulated(tmp_path, 4, f"setHold('pose') {PROGRAM}")
    assert run.state == 'FAILED'
    assert 'arm_4 has 4 axes: in place it cannot turn its tool about' in str(run.error)
    assert not report.ok
    found = walk_program(CellSetup(program=tmp_path / 'program.lua', robot=name_of(4))).problems
    assert any('arm_4 has 4 axes' in problem.reason for problem in found)
