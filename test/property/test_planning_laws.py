"""Laws of the planners: limits at every instant, straightness, ends, symmetry, monotony."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.errors import PlanningError, UnreachablePoseError
from robots_planning import LinearCartesianLimited, LinearJoint, Trajectory, verify

ROBOTS = ('kuka_kr210_r2700', 'bello_bot')
_LOADED = {name: load_robot_model(name) for name in ROBOTS}
# 10 kHz, ten times what the controller may do.
FINE = 1e-4
# Smallest singular value of the Jacobian; the tolerance of poses over it is how well axes are known.
NEARLY_SINGULAR = 1e-3
SAME_POSITIONS = 1e-4  # rad; self-motion of a redundant robot is integrated to about 1e-5

part = st.one_of(st.floats(0.0, 1.0), st.sampled_from([0.0, 0.5, 0.5001, 1.0]))
parts = st.lists(part, min_size=7, max_size=7)
direction = st.tuples(*[st.floats(-1.0, 1.0)] * 3)
# Zero-length and nearly zero-length moves on purpose.
length = st.one_of(st.sampled_from([0.0, 1e-9, 1e-6, 1e-3]), st.floats(0.0, 0.6))


def positions(robot: BaseRobotModel, parts: list[float]) -> np.ndarray:
    """Joint positions at parts 0..1 of their ranges; 0.5 of a symmetric range is a singular wrist."""
    axes = robot.axes_data
    return axes.lower + np.array(parts[: robot.num_axes]) * (axes.upper - axes.lower)


def check_every_instant(trajectory: Trajectory, robot: BaseRobotModel) -> None:
    """Limits and rest, without `verify`: another check with plain differences."""
    axes = robot.axes_data
    t = np.arange(-2, int(trajectory.duration / FINE) + 4) * FINE
    q, q_dot, q_ddot = trajectory.sample(t)
    assert (q >= axes.lower - 1e-9).all()
    assert (q <= axes.upper + 1e-9).all()
    assert (np.abs(q_dot) <= axes.velocity).all()
    assert (np.abs(q_ddot) <= axes.acceleration).all()
    # Differences are averages of the derivatives; rounding of a position over the step, once and twice.
    assert (np.abs(np.diff(q, axis=0)) / FINE <= axes.velocity + 1e-10).all()
    assert (np.abs(np.diff(q, 2, axis=0)) / FINE**2 <= axes.acceleration + 1e-6).all()
    assert not trajectory.velocity[[0, -1]].any()
    assert not trajectory.acceleration[[0, -1]].any()


@pytest.mark.parametrize('name', ROBOTS)
@settings(max_examples=60)  # long moves are sampled at 10 kHz
@given(start=parts, target=parts)
def test_linear_joint(name: str, start: list[float], target: list[float]) -> None:
    robot = _LOADED[name]
    q_start, q_target = positions(robot, start), positions(robot, target)
    trajectory = LinearJoint(robot).generate(q_start, q_target)
    np.testing.assert_array_equal(trajectory.position[0], q_start)
    np.testing.assert_array_equal(trajectory.position[-1], q_target)
    check_every_instant(trajectory, robot)
    report = verify(trajectory, robot, torque=False)
    assert report.ok, report.describe()
    # Jerk switches are trajectory points; times are rounded to nanoseconds there.
    assert report.uses['jerk'].ratio <= 1.0
    back = LinearJoint(robot).generate(q_target, q_start)
    assert back.duration == pytest.approx(trajectory.duration, rel=1e-9, abs=2e-9)


@pytest.mark.parametrize('name', ROBOTS)
@settings(max_examples=40)  # first use of a robot is slow
@given(start=parts, target=parts, less=st.floats(0.05, 1.0))
def test_linear_joint_is_never_slower_with_larger_limits(
    name: str, start: list[float], target: list[float], less: float
) -> None:
    robot = _LOADED[name]
    ends = positions(robot, start), positions(robot, target)
    full = LinearJoint(robot).generate(*ends).duration
    # Durations are rounded to nanoseconds.
    assert LinearJoint(robot, speed_fraction=less).generate(*ends).duration >= full - 2e-9
    assert LinearJoint(robot, acceleration_fraction=less).generate(*ends).duration >= full - 2e-9


@pytest.mark.parametrize('name', ROBOTS)
@settings(max_examples=60)  # lines that fail look for the reason
@given(start=parts, directions=st.tuples(direction, direction), metres=length, radians=length)
def test_linear_cartesian_limited(
    name: str, start: list[float], directions: tuple[tuple[float, ...], ...], metres: float, radians: float
) -> None:
    robot = _LOADED[name]
    q = positions(robot, start)
    pose = Pose(*robot.direct_kinematics(q))
    turn = Rotation.from_rotvec(radians * np.array(directions[1])).as_matrix()
    target = Pose(pose.r + metres * np.array(directions[0]), turn @ pose.T)
    try:
        trajectory = LinearCartesianLimited(robot).generate(q, target)
    except (PlanningError, UnreachablePoseError) as error:
        if isinstance(error, PlanningError):
            assert 0.0 <= float(error.details['fraction']) <= 1.0  # noqa: PT017  # a refusal is no failure
        return
    check_every_instant(trajectory, robot)
    report = verify(trajectory, robot, line=(pose, target), torque=False)
    assert report.ok, report.describe()


@pytest.mark.parametrize('name', ROBOTS)
@settings(max_examples=30)  # three plans each
@given(
    start=st.lists(st.floats(-0.5, 0.5), min_size=7, max_size=7),
    towards=direction,
    metres=st.floats(0.01, 0.3),
    less=st.floats(0.2, 0.9),
)
def test_lines_backwards_and_with_smaller_limits(
    name: str, start: list[float], towards: tuple[float, ...], metres: float, less: float
) -> None:
    robot = _LOADED[name]
    q = np.clip(robot.home + start[: robot.num_axes], robot.axes_data.lower, robot.axes_data.upper)
    pose = Pose(*robot.direct_kinematics(q))
    target = Pose(pose.r + metres * np.array(towards), pose.T)
    try:
        forward = LinearCartesianLimited(robot).generate(q, target)
        back = LinearCartesianLimited(robot).generate(forward.position[-1], pose)
    except (PlanningError, UnreachablePoseError):
        assume(False)  # the other law's business
    # Close to a singularity the pose leaves axes undetermined within its tolerance, and the motion back may
    # take other joint positions; everywhere else it is the same joint path.
    if np.linalg.svd(robot.jacobian(q), compute_uv=False)[-1] > NEARLY_SINGULAR:
        assert np.abs(back.position[-1] - q).max() < SAME_POSITIONS
        # The grid of the path differs from both sides, and so does where smoothing costs time.
        assert back.duration == pytest.approx(forward.duration, rel=0.02)
    slower = LinearCartesianLimited(robot, speed_fraction=less, acceleration_fraction=less)
    assert slower.generate(q, target).duration >= forward.duration * (1.0 - 0.01)
