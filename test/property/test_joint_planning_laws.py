# ruff: noqa: PLR0917  # hypothesis gives every drawn value a name
"""Laws of the joint planners: any start, any instant, time-optimality against Ruckig, symmetry, monotony."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from ruckig import InputParameter, Result, Ruckig, Synchronization
from ruckig import Trajectory as RuckigTrajectory

from robots_core import BaseRobotModel, load_robot_model
from robots_core.errors import RobotsError
from robots_planning import LinearJoint, LinearJointAxes, Trajectory
from robots_planning.trajectory_generators.braking import check_start_motion
from robots_planning.trajectory_generators.joint_space import JointSpaceGenerator

ROBOTS = ('kuka_kr210_r2700', 'bello_bot', 'kinova_j2n6s300')
PLANNERS: tuple[type[JointSpaceGenerator], ...] = (LinearJoint, LinearJointAxes)
_LOADED = {name: load_robot_model(name) for name in ROBOTS}
CASES = pytest.mark.parametrize(
    ('name', 'planner'), [(name, planner) for name in ROBOTS for planner in PLANNERS]
)

part = st.one_of(st.floats(0.0, 1.0), st.sampled_from([0.0, 0.5, 0.5001, 1.0]))
parts = st.lists(part, min_size=7, max_size=7)
signed = st.one_of(st.floats(-1.0, 1.0), st.sampled_from([0.0, 1.0, -1.0, 1e-3, -1e-6, 1e-9]))
motions = st.lists(signed, min_size=7, max_size=7)


def positions(robot: BaseRobotModel, values: list[float]) -> np.ndarray:
    """Joint positions at parts 0..1 of their ranges; axes without a range have one turn."""
    axes = robot.axes_data
    low, high = axes.one_turn
    return low + np.array(values[: robot.num_axes]) * (high - low)


def uses(trajectory: Trajectory, robot: BaseRobotModel) -> tuple[float, float, float, float]:
    """Velocity, acceleration and jerk as parts of their limits, and how far positions pass theirs."""
    axes = robot.axes_data
    q, q_dot, _ = trajectory.sample(np.linspace(0.0, trajectory.duration, 2001))
    _, acceleration, jerk = trajectory.acceleration_extremes()
    return (
        float((np.abs(q_dot) / axes.velocity).max()),
        float((acceleration / axes.acceleration).max()),
        float((jerk / axes.jerk).max()),
        float(np.maximum(q - axes.upper, axes.lower - q).max()),
    )


def assert_limits(trajectory: Trajectory, robot: BaseRobotModel) -> None:
    velocity, acceleration, jerk, outside = uses(trajectory, robot)
    # Plans stay 1e-4 inside; an axis that brakes at its position limit has up to 1e-3 more, and jerk 0.1.
    assert velocity <= 1.0 + 1e-3
    assert acceleration <= 1.0 + 1e-3
    assert jerk <= 1.1
    assert outside <= 1.1e-9  # the tolerance of the axis limits, and rounding
    assert not trajectory.velocity[-1].any()
    assert not trajectory.acceleration[-1].any()


@CASES
@settings(max_examples=60)  # the first example loads compiled code
@given(start=parts, q_dot=motions, q_ddot=motions, target=parts, fraction=st.sampled_from([1.0, 0.3]))
def test_from_any_motion_that_can_be_braked(
    name: str,
    planner: type[JointSpaceGenerator],
    start: list[float],
    q_dot: list[float],
    q_ddot: list[float],
    target: list[float],
    fraction: float,
) -> None:
    robot = _LOADED[name]
    axes, n = robot.axes_data, robot.num_axes
    q, goal = positions(robot, start), positions(robot, target)
    # A whole start may be moved away from the position limits, so that not all examples are refused.
    v, a = np.array(q_dot[:n]) * axes.velocity, np.array(q_ddot[:n]) * axes.acceleration
    generator = planner(robot, speed_fraction=fraction, acceleration_fraction=fraction)
    try:
        check_start_motion(axes, q, v, a)
    except RobotsError as error:
        with pytest.raises(type(error)):
            generator.generate_moving((q, v, a), goal)
        v, a = 0.1 * v, 0.1 * a
        q = 0.5 * (q + positions(robot, [0.5] * 7))
        try:
            check_start_motion(axes, q, v, a)
        except RobotsError:
            assume(False)
    trajectory = generator.generate_moving((q, v, a), goal)
    np.testing.assert_array_equal(trajectory.position[0], q)
    if v.any() or a.any():
        np.testing.assert_array_equal(trajectory.velocity[0], v)
        np.testing.assert_array_equal(trajectory.acceleration[0], a)
    turns = np.where(axes.continuous, (trajectory.position[-1] - goal) / (2.0 * np.pi), 0.0)
    np.testing.assert_allclose(trajectory.position[-1], goal + 2.0 * np.pi * np.round(turns), atol=1e-12)
    assert_limits(trajectory, robot)


@CASES
@settings(max_examples=40)  # the first example loads compiled code
@given(
    start=parts,
    targets=st.tuples(parts, parts, parts),
    when=st.tuples(st.floats(0.0, 1.0), st.floats(0.0, 1.0)),
)
def test_targets_that_change_at_any_instant(
    name: str,
    planner: type[JointSpaceGenerator],
    start: list[float],
    targets: tuple[list[float], ...],
    when: tuple[float, ...],
) -> None:
    """Also towards and away from limits, where the robot brakes with nearly all it has."""
    robot = _LOADED[name]
    generator = planner(robot)
    trajectory = generator.generate(positions(robot, start), positions(robot, targets[0]))
    for share, target in zip(when, targets[1:], strict=True):
        q, q_dot, q_ddot = trajectory.sample(share * trajectory.duration)
        q = np.clip(q, robot.axes_data.lower, robot.axes_data.upper)
        trajectory = generator.generate_moving((q, q_dot, q_ddot), positions(robot, target))
        np.testing.assert_array_equal(trajectory.velocity[0], q_dot)
        np.testing.assert_array_equal(trajectory.acceleration[0], q_ddot)
        assert_limits(trajectory, robot)


def ruckig_durations(robot: BaseRobotModel, state: np.ndarray, goal: np.ndarray) -> np.ndarray:
    """Each axis' own shortest duration with the full limits."""
    axes = robot.axes_data
    command, found = InputParameter(robot.num_axes), RuckigTrajectory(robot.num_axes)
    command.synchronization = Synchronization.No
    command.current_position, command.current_velocity, command.current_acceleration = state.tolist()
    command.target_position = goal.tolist()
    command.max_velocity, command.max_acceleration = axes.velocity.tolist(), axes.acceleration.tolist()
    command.max_jerk = axes.jerk.tolist()
    assert Ruckig(robot.num_axes).calculate(command, found) in (Result.Working, Result.Finished)
    return np.array(found.independent_min_durations)


def arrivals(trajectory: Trajectory) -> np.ndarray:
    """When each axis comes to rest for good."""
    off = (
        (trajectory.position != trajectory.position[-1])
        | (trajectory.velocity != 0.0)
        | (trajectory.acceleration != 0.0)
    )
    last = [int(np.flatnonzero(column)[-1]) + 1 if column.any() else 0 for column in off.T]
    return trajectory.time[last]


@pytest.mark.parametrize('name', ['kuka_kr210_r2700', 'bello_bot'])
@settings(max_examples=60)  # the first example loads compiled code
@given(start=parts, target=parts, scale=st.sampled_from([1.0, 0.1, 1e-3]))
def test_every_axis_is_as_early_as_by_ruckig(
    name: str, start: list[float], target: list[float], scale: float
) -> None:
    robot = _LOADED[name]
    q = positions(robot, start)
    goal = q + scale * (positions(robot, target) - q)
    assume(np.abs(goal - q).max() > 1e-6)
    generator = LinearJointAxes(robot)
    expected = ruckig_durations(robot, np.array([q, 0.0 * q, 0.0 * q]), goal)
    found = arrivals(generator.generate(q, goal))
    # Moving a switch by `shortest` can cost an axis a part of its jerk, and a third of that part of its time;
    # a move shorter than nine such pieces takes them.
    assert (found >= expected - 2e-9).all()
    assert (found <= 1.01 * expected + 9.0e-9 * generator.shortest).all()


@pytest.mark.parametrize('name', ['kuka_kr210_r2700', 'bello_bot'])
@settings(max_examples=60)  # the first example loads compiled code
@given(middle=parts, q_dot=motions, q_ddot=motions, target=parts)
def test_from_motion_every_axis_is_nearly_as_early(
    name: str, middle: list[float], q_dot: list[float], q_ddot: list[float], target: list[float]
) -> None:
    robot = _LOADED[name]
    n, axes = robot.num_axes, robot.axes_data
    q = 0.5 * (positions(robot, middle) + positions(robot, [0.5] * 7))
    state = np.array(
        [q, 0.3 * np.array(q_dot[:n]) * axes.velocity, 0.3 * np.array(q_ddot[:n]) * axes.acceleration]
    )
    try:
        check_start_motion(axes, *state)
    except RobotsError:
        assume(False)
    goal = positions(robot, target)
    generator = LinearJointAxes(robot)
    expected = ruckig_durations(robot, state, goal)
    trajectory = generator.generate_moving((q, state[1], state[2]), goal)
    # Moving a switch by `shortest` can cost an axis a few per cent of its jerk, and that some of its time;
    # what takes less than a few dozens of such pieces takes longer.
    assert (arrivals(trajectory) <= 1.06 * expected + 64e-9 * generator.shortest).all()


@CASES
@settings(max_examples=40)  # the first example loads compiled code
@given(start=parts, target=parts, less=st.floats(0.05, 1.0))
def test_reversal_and_larger_limits(
    name: str, planner: type[JointSpaceGenerator], start: list[float], target: list[float], less: float
) -> None:
    robot = _LOADED[name]
    q, goal = positions(robot, start), positions(robot, target)
    generator = planner(robot)
    there = generator.generate(q, goal)
    # The shortest motion of a continuous axis is back to where it came from.
    back = generator.generate(there.position[-1], q)
    assert back.duration == pytest.approx(there.duration, rel=1e-9, abs=2e-9)
    tick = 1e-9 * (1 if planner is LinearJoint else 4 * generator.shortest)
    # Windows on ticks differ by some of them, those of one line by the shortest piece.
    allowed = tick + 1e-9 * generator.shortest
    for options in ({'speed_fraction': less}, {'acceleration_fraction': less}):
        assert planner(robot, **options).generate(q, goal).duration >= there.duration - allowed
    assert_limits(there, robot)
    t = np.linspace(0.0, there.duration, 101)
    forward, backward = there.sample(t), back.sample(there.duration - t)
    if planner is LinearJoint and not robot.axes_data.continuous.any():
        np.testing.assert_allclose(forward[0], backward[0], atol=1e-8)  # a nanosecond of motion
