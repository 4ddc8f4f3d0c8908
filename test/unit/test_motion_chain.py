"""Blended motions: one motion, in its zones, inside all limits, faster than with stops."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.errors import PlanningError
from robots_planning import MotionSettings, PathPlanning, verify
from robots_planning.commands.motion_chain import MotionChain
from robots_planning.commands.motion_plan import CommandChain, QueuedCommand
from robots_planning.motion_kinds import CIRCLE, JOINT, LINE, MotionKind
from robots_planning.pathplanning import PlannedMotion
from robots_planning.timing.time_optimal import EXCESS
from robots_planning.trajectory_generators.trajectory_generator import Target

ZONE = 0.03  # m
JOINT_ZONE = 0.1  # rad


@pytest.fixture(scope='module')
def robot() -> BaseRobotModel:
    return load_robot_model('ur10e')


@pytest.fixture(scope='module')
def chain(robot: BaseRobotModel) -> MotionChain:
    return MotionChain(PathPlanning(robot))


@pytest.fixture
def start() -> np.ndarray:
    return np.array([0.2, -1.2, 1.6, -1.9, -1.4, 0.3])


def order(number: int, kind: MotionKind, target: Target, **settings: object) -> QueuedCommand:
    return QueuedCommand(str(number), kind, target, MotionSettings(**settings), 0.0)  # type: ignore[arg-type]


def planned(
    chain: MotionChain, orders: tuple[QueuedCommand, ...], start: np.ndarray
) -> tuple[PlannedMotion, tuple[float, ...]]:
    plan = chain.plan(CommandChain(orders), start)
    return plan.motion, tuple(plan.ends.values())


def square(robot: BaseRobotModel, start: np.ndarray, side: float = 0.2) -> list[Pose]:
    """Corners of a square in a horizontal plane, the start last."""
    pose = Pose(*robot.direct_kinematics(start))
    steps = ([side, 0.0, 0.0], [side, side, 0.0], [0.0, side, 0.0], [0.0, 0.0, 0.0])
    return [Pose(pose.r + np.array(step), pose.T) for step in steps]


def tool_positions(robot: BaseRobotModel, q: np.ndarray) -> np.ndarray:
    return np.array([robot.direct_kinematics(row)[0] for row in q])


def test_a_square_runs_through_its_corners_inside_their_zones(
    robot: BaseRobotModel, chain: MotionChain, start: np.ndarray
) -> None:
    corners = square(robot, start)
    orders = tuple(
        order(number, LINE, pose, blend_zone=ZONE if number < 3 else 0.0)
        for number, pose in enumerate(corners)
    )
    motion, ends = planned(chain, orders, start)
    report = verify(motion.trajectory, robot)
    assert report.ok, report.describe()
    t = np.linspace(0.0, motion.duration, 4000)
    q, q_dot, _ = motion.trajectory.sample(t)
    r = tool_positions(robot, q)
    vertices = np.array([robot.direct_kinematics(start)[0], *(pose.r for pose in corners)])
    # Outside the zones the tool is on the sides of the square; inside, within the zone around the corner.
    sides = []
    for begin, end in pairwise(vertices):
        way = end - begin
        part = np.clip((r - begin) @ way / (way @ way), 0.0, 1.0)
        sides.append(np.linalg.norm(r - begin - part[:, None] * way, axis=1))
    near = np.min([np.linalg.norm(r - vertex, axis=1) for vertex in vertices[1:-1]], axis=0) <= ZONE
    assert np.min(sides, axis=0)[~near].max() < 1e-5  # the line's own tolerance
    # It does not stop in between, and is faster than four motions.
    speed = np.abs(q_dot).max(axis=1)
    assert speed[(t > 0.1) & (t < motion.duration - 0.1)].min() > 0.01
    q_now, with_stops = start, 0.0
    for pose in corners:
        single = PathPlanning(robot).plan(LINE, q_now, pose).trajectory
        q_now, with_stops = single.position[-1], with_stops + single.duration
    assert motion.duration < 0.9 * with_stops
    assert len(ends) == 4
    assert list(ends) == sorted(ends)
    assert ends[-1] == motion.duration
    passed = tool_positions(robot, motion.trajectory.sample(np.array(ends))[0])
    assert np.linalg.norm(passed - vertices[1:], axis=1).max() <= ZONE


def test_a_zone_is_one_of_the_tools_tip(robot: BaseRobotModel, chain: MotionChain, start: np.ndarray) -> None:
    """A long tool turns about the flange: that stays in any zone, its tip moves far."""
    tool = (0.0, 0.0, 0.4, 0.0, 0.0, 0.0, 1.0)
    flange, tip = Pose(*robot.direct_kinematics(start)), Pose(np.array(tool[:3]), np.eye(3))
    targets, turned = [flange @ tip], flange
    for angles in ([0.0, 25.0, 0.0], [0.0, 0.0, 25.0]):
        turned = turned @ Pose.from_angles([0.0, 0.0, 0.0], np.radians(angles))
        targets.append(turned @ tip)
    orders = (order(0, LINE, targets[1], tool=tool, blend_zone=ZONE), order(1, LINE, targets[2], tool=tool))
    motion, _ = planned(chain, orders, start)
    q = motion.trajectory.sample(np.linspace(0.0, motion.duration, 4000))[0]
    r = np.array([r + T @ tip.r for r, T in map(robot.direct_kinematics, q)])
    away = []
    for first, last in pairwise(targets):
        direction = (last.r - first.r) / np.linalg.norm(last.r - first.r)
        away.append(np.linalg.norm(np.cross(r - first.r, direction), axis=1))
    outside = np.linalg.norm(r - targets[1].r, axis=1) > ZONE
    assert not outside.all()
    assert np.min(away, axis=0)[outside].max() < 1e-5  # the line's own tolerance


@pytest.mark.parametrize('long', [0, 1])
def test_every_motion_of_a_chain_keeps_its_speed_for_its_own_tool(
    robot: BaseRobotModel, chain: MotionChain, start: np.ndarray, long: int
) -> None:
    """A long tool that turns about the flange: the speed of the flange says nothing about its tip."""
    tools = [(0.0, 0.0, 0.4 if number == long else 0.0, 0.0, 0.0, 0.0, 1.0) for number in range(2)]
    flange = Pose(*robot.direct_kinematics(start))
    frames = [Pose(np.array(tool[:3]), np.eye(3)) for tool in tools]
    turned = flange @ Pose.from_angles([0.05, 0.0, 0.0], np.radians([0.0, 60.0, 0.0]))
    back = flange @ Pose.from_angles([0.1, 0.0, 0.0], np.zeros(3))
    wanted = {'cartesian_speed': 0.1, 'cartesian_acceleration': 1.0, 'rotation_speed': 3.0}
    orders = (
        order(0, LINE, turned @ frames[0], tool=tools[0], blend_zone=ZONE, **wanted),
        order(1, LINE, back @ frames[1], tool=tools[1], **wanted),
    )
    motion, ends = planned(chain, orders, start)
    t = np.linspace(0.0, motion.duration, 4000)
    q = motion.trajectory.sample(t)[0]
    for tool, part in zip(frames, (t < ends[0], t > ends[0]), strict=True):
        r = np.array([r + T @ tool.r for r, T in map(robot.direct_kinematics, q[part])])
        # The tolerance of verification.
        assert np.linalg.norm(np.diff(r, axis=0), axis=1).max() / t[1] <= 0.1 * (1.0 + 1e-3)
    assert motion.report.uses['speed'].ratio == pytest.approx(1.0, abs=1e-2)


def test_a_chain_that_goes_back_passes_each_target_once_and_in_turn(
    robot: BaseRobotModel, chain: MotionChain, start: np.ndarray
) -> None:
    pose = Pose(*robot.direct_kinematics(start))
    there = Pose(pose.r + np.array([0.2, 0.0, 0.0]), pose.T)
    aside = Pose(pose.r + np.array([0.2, 0.1, 0.0]), pose.T)
    # The last motion stands at the first target; the first motion only passes it.
    targets = [there, aside, pose, there]
    orders = tuple(
        order(k, LINE, target, blend_zone=ZONE if k < 3 else 0.0) for k, target in enumerate(targets)
    )
    motion, ends = planned(chain, orders, start)
    assert 0.1 * motion.duration < ends[0] < ends[1] < ends[2] < 0.9 * motion.duration
    passed = tool_positions(robot, motion.trajectory.sample(np.array(ends))[0])
    assert np.linalg.norm(passed - [target.r for target in targets], axis=1).max() <= ZONE


def test_joint_motions_and_lines_blend_with_each_other(
    robot: BaseRobotModel, chain: MotionChain, start: np.ndarray
) -> None:
    away = start + np.array([0.5, 0.1, -0.1, 0.0, 0.1, 0.2])
    pose = Pose(*robot.direct_kinematics(away))
    lower = Pose(pose.r - [0.0, 0.0, 0.15], pose.T)
    arc = tuple(Pose(lower.r + np.array(step), pose.T) for step in ([0.1, 0.1, 0.0], [0.0, 0.2, 0.0]))
    orders = (
        order(0, JOINT, away, joint_blend_zone=JOINT_ZONE),
        order(1, LINE, lower, blend_zone=ZONE),
        order(2, CIRCLE, arc, blend_zone=ZONE),
        order(3, JOINT, start),
    )
    motion, _ = planned(chain, orders, start)
    report = verify(motion.trajectory, robot)
    assert report.ok, report.describe()
    q = motion.trajectory.sample(np.linspace(0.0, motion.duration, 4000))[0]
    assert np.abs(q - away).max(axis=1).min() <= JOINT_ZONE
    np.testing.assert_allclose(motion.trajectory.position[-1], start, atol=1e-12)


def test_every_motion_keeps_its_own_speeds(
    robot: BaseRobotModel, chain: MotionChain, start: np.ndarray
) -> None:
    first, second, *_ = square(robot, start, 0.4)
    slow = 0.05
    orders = (
        order(0, LINE, first, blend_zone=ZONE),
        order(1, LINE, second, cartesian_speed=slow),
    )
    motion, ends = planned(chain, orders, start)
    t = np.linspace(0.0, motion.duration, 2000)
    q, q_dot, _ = motion.trajectory.sample(t)
    speed = np.array([np.linalg.norm((robot.jacobian(a) @ b)[:3]) for a, b in zip(q, q_dot, strict=True)])
    r = tool_positions(robot, q)
    inside = np.linalg.norm(r - first.r, axis=1) <= ZONE
    before, after = (t < ends[0]) & ~inside, (t > ends[0]) & ~inside
    assert speed[before].max() > 0.4
    assert speed[after].max() <= slow * 1.001  # a limit, to what the planner promises


@pytest.mark.parametrize('jerk_limited', [False, True])
@pytest.mark.parametrize('speeds', [(0.5, 0.2, 0.02), (0.02, 0.2, 0.02), (np.inf, 0.02, 0.02)])
def test_where_two_motions_meet_the_speeds_of_both_hold(
    robot: BaseRobotModel, start: np.ndarray, speeds: tuple[float, ...], *, jerk_limited: bool
) -> None:
    """Also where the ramps of the acceleration are long: in a plan that takes long."""
    chain = MotionChain(PathPlanning(robot))
    options = {'blend_zone': ZONE, 'joint_blend_zone': JOINT_ZONE, 'jerk_limited': jerk_limited}
    away = start + np.array([0.3, 0.1, -0.1, 0.0, 0.1, 0.2])
    orders = tuple(
        order(k, LINE, target, **options, cartesian_speed=speed)
        if np.isfinite(speed)
        else order(k, JOINT, away, **options)
        for k, (target, speed) in enumerate(zip(square(robot, start, 0.4), speeds, strict=False))
    )
    motion, ends = planned(chain, orders, start)
    for before, after, end in zip(speeds, speeds[1:], ends, strict=False):
        for limit, times in (
            (before, np.linspace(end - 0.03, end, 61)),
            (after, np.linspace(end, end + 0.03, 61)),
        ):
            q, q_dot, _ = motion.trajectory.sample(times)
            found = [np.linalg.norm((robot.jacobian(a) @ b)[:3]) for a, b in zip(q, q_dot, strict=True)]
            assert max(found) <= limit * (1.0 + EXCESS)
    assert motion.report.uses['speed'].ratio == pytest.approx(1.0, abs=1e-2)


def test_torque_limits_hold_where_the_last_planner_keeps_them(
    robot: BaseRobotModel, chain: MotionChain, start: np.ndarray
) -> None:
    corners = square(robot, start, 0.3)
    options = {'cartesian_planner': 'dynamic_programming', 'cartesian_speed': 5.0} | {
        'cartesian_acceleration': 50.0
    }
    orders = tuple(order(k, LINE, pose, blend_zone=ZONE, **options) for k, pose in enumerate(corners))
    motion, _ = planned(chain, orders, start)
    assert motion.report.uses['torque'].ratio <= 1.0 + 1e-3


def test_jerk_limits_hold_in_a_chain_where_one_motion_asks_for_them(
    robot: BaseRobotModel, chain: MotionChain, start: np.ndarray
) -> None:
    corners = square(robot, start)
    durations = []
    for limited in (False, True):
        orders = tuple(
            order(
                k,
                LINE,
                pose,
                blend_zone=ZONE,
                jerk_limited=limited and k == 1,
                acceleration_fraction=0.5,
            )
            for k, pose in enumerate(corners)
        )
        motion, _ = planned(chain, orders, start)
        report = verify(motion.trajectory, robot, torque=False)
        assert report.ok, report.describe()
        durations.append(motion.duration)
    # The jerk limit goes with the acceleration limit.
    assert report.uses['jerk'].ratio <= 0.5
    assert durations[1] > durations[0]


def test_a_chain_that_is_faster_with_stops_stops() -> None:
    # Jerk limits that are low for its accelerations: they cost more at a corner than a stop does.
    robot = load_robot_model('staubli_tx2_90')
    planning = PathPlanning(robot)
    start = robot.home + np.array([0.1, 0.2, -0.1, 0.1, 0.6, 0.1])
    corners = square(robot, start, 0.1)[:2]
    fast = {'cartesian_speed': 5.0, 'cartesian_acceleration': 50.0, 'jerk_limited': True}
    orders = tuple(order(k, LINE, pose, blend_zone=0.01, **fast) for k, pose in enumerate(corners))
    motion, ends = planned(MotionChain(planning), orders, start)
    first = planning.plan(LINE, start, corners[0], orders[0].settings).trajectory
    second = planning.plan(LINE, first.position[-1], corners[1], orders[1].settings).trajectory
    assert ends == pytest.approx((first.duration, first.duration + second.duration), abs=1e-9)
    q, q_dot, _ = motion.trajectory.sample(ends[0])
    np.testing.assert_allclose(q, first.position[-1], atol=1e-9)
    assert np.abs(q_dot).max() < 1e-6


def test_a_motion_that_goes_nowhere_is_reported(chain: MotionChain, start: np.ndarray) -> None:
    with pytest.raises(PlanningError, match='goes nowhere'):
        planned(chain, (order(0, JOINT, start, joint_blend_zone=0.1), order(1, JOINT, start + 0.1)), start)
