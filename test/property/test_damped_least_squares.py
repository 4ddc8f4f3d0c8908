"""Laws of DampedLeastSquares: round trip over the whole workspace, always inside the limits."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.blocks import DampedLeastSquares

# Six axes with and without a spherical wrist, seven, five of which one slides, three.
ROBOTS = ('kuka_kr210_r2700', 'kinova_j2n6s300', 'bello_bot', 'cello_bot', 'debris_arm')
_LOADED = {name: load_robot_model(name) for name in ROBOTS}


def positions(robot: BaseRobotModel, parts: list[float]) -> np.ndarray:
    """Joint positions at parts 0..1 of their ranges; 0.5 of a symmetric range is a singular wrist."""
    axes = robot.axes_data
    low, high = axes.one_turn
    return low + np.array(parts[: robot.num_axes]) * (high - low)


NEAR = 0.01  # rad (m)
parts = st.lists(st.one_of(st.floats(0.0, 1.0), st.sampled_from([0.0, 0.5, 1.0])), min_size=7, max_size=7)


@pytest.mark.parametrize('name', ROBOTS)
@settings(max_examples=60)  # one example may need all restarts
@given(target=parts, start=parts)
def test_round_trip(name: str, target: list[float], start: list[float]) -> None:
    robot = _LOADED[name]
    pose = Pose(*robot.direct_kinematics(positions(robot, target)))
    result = DampedLeastSquares(robot, tolerances=(1e-6, 1e-6), restarts=200).solve(
        pose, positions(robot, start)
    )
    robot.axes_data.check_position(result.q)
    assert result.converged
    position, orientation = Pose(*robot.direct_kinematics(result.q)).distance_to(pose)
    # The reported errors, computed here by another formula that rounds to 1e-8 rad.
    assert position == pytest.approx(result.position_error, abs=1e-12)
    assert orientation == pytest.approx(result.orientation_error, abs=1e-7)
    assert position <= 1e-6


@pytest.mark.parametrize('name', ROBOTS)
@settings(max_examples=40)  # an unreachable pose needs all restarts
@given(r=st.tuples(*[st.floats(-4.0, 4.0)] * 3), angles=st.tuples(*[st.floats(-3.0, 3.0)] * 3), start=parts)
def test_any_pose_gives_joint_positions_inside_the_limits(
    name: str, r: tuple[float, ...], angles: tuple[float, ...], start: list[float]
) -> None:
    robot = _LOADED[name]
    pose = Pose.from_angles(r, angles)
    result = DampedLeastSquares(robot, restarts=4).solve(pose, positions(robot, start))
    assert (result.q >= robot.axes_data.lower).all()
    assert (result.q <= robot.axes_data.upper).all()
    reached = Pose(*robot.direct_kinematics(result.q)).distance_to(pose)
    assert result.converged == (result.position_error <= 1e-10 and result.orientation_error <= 1e-10)
    assert reached[0] == pytest.approx(result.position_error, abs=1e-12)


@pytest.mark.parametrize('name', ROBOTS)
@settings(max_examples=60)
@given(target=parts, away=st.lists(st.floats(-1.0, 1.0), min_size=7, max_size=7))
def test_a_pose_near_by_is_reached_near_by(name: str, target: list[float], away: list[float]) -> None:
    robot = _LOADED[name]
    q = positions(robot, target)
    axes = robot.axes_data
    start = np.clip(q + NEAR * np.array(away[: robot.num_axes]), axes.lower, axes.upper)
    smallest = np.linalg.svd(robot.jacobian(q))[1][-1]
    result = DampedLeastSquares(robot).solve(Pose(*robot.direct_kinematics(q)), start)
    assert result.converged
    if smallest > 0.1:  # Newton's method converges to the solution near the start
        assert np.abs(result.q - q).max() <= 10.0 * NEAR
