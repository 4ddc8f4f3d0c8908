"""LinearJoint: duration against the closed form, ends, targets, refusals."""

import numpy as np
import pytest

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.errors import InvalidInputError, JointLimitError, UnreachablePoseError
from robots_planning import LinearJoint, verify


@pytest.fixture(scope='module', params=['kuka_kr210_r2700', 'bello_bot'])
def robot(request: pytest.FixtureRequest) -> BaseRobotModel:
    return load_robot_model(request.param)


def seven_segments(distance: float, velocity: float, acceleration: float, jerk: float) -> float:
    """Shortest time from rest to rest with limited jerk, closed form (Biagiotti and Melchiorri 2008, 3.4)."""
    if velocity * jerk >= acceleration**2:
        ramp, lift = acceleration / jerk, velocity / acceleration + acceleration / jerk
    else:
        ramp = np.sqrt(velocity / jerk)
        lift = 2.0 * ramp
    if distance >= velocity * lift:
        return float(distance / velocity + lift)
    if distance >= 2.0 * acceleration**3 / jerk**2:
        ramp = acceleration / jerk
        root = np.sqrt(ramp**2 + 4.0 * distance / acceleration)
        return float(ramp + root)
    return float(4.0 * np.cbrt(distance / (2.0 * jerk)))


@pytest.mark.parametrize('distance', [1e-4, 1e-2, 0.1, 0.5, 1.2])
def test_duration_of_one_axis_is_the_closed_form(robot: BaseRobotModel, distance: float) -> None:
    axes = robot.axes_data
    for axis in range(robot.num_axes):
        start, target = robot.home.copy(), robot.home.copy()
        direction = 1.0 if target[axis] + distance <= axes.upper[axis] else -1.0
        target[axis] += direction * distance
        if target[axis] < axes.lower[axis]:
            start[axis] = axes.lower[axis]
            target[axis] = start[axis] + distance
        expected = seven_segments(distance, axes.velocity[axis], axes.acceleration[axis], axes.jerk[axis])
        trajectory = LinearJoint(robot).generate(start, target)
        # Plans stay 1e-4 inside the limits, which lengthens them by at most that.
        assert expected <= trajectory.duration <= expected * (1.0 + 1.5e-4) + 1e-9


def test_all_axes_move_on_one_line_and_one_limit_is_used_fully(robot: BaseRobotModel) -> None:
    axes = robot.axes_data
    target = robot.home + 0.2 * np.where(robot.home < 0.5 * (axes.lower + axes.upper), 1.0, -1.0)
    trajectory = LinearJoint(robot).generate(robot.home, target)
    part = (trajectory.sample(np.linspace(0.0, trajectory.duration, 500))[0] - robot.home) / (
        target - robot.home
    )
    # Rounding of the division by 0.2 rad.
    np.testing.assert_allclose(part, np.broadcast_to(part[:, :1], part.shape), atol=1e-13)
    report = verify(trajectory, robot, torque=False)
    assert report.ok, report.describe()
    used = max(use.ratio for name, use in report.uses.items() if name != 'position')
    assert used == pytest.approx(1.0, abs=2e-4)


def test_pose_is_reached(robot: BaseRobotModel) -> None:
    q = robot.home + 0.1
    pose = Pose(*robot.direct_kinematics(robot.axes_data.check_position(q)))
    trajectory = LinearJoint(robot).generate(robot.home, pose)
    position, orientation = Pose(*robot.direct_kinematics(trajectory.position[-1])).distance_to(pose)
    # The inverse kinematics' own tolerance, with rounding of an independent orientation error.
    assert position < 1e-9
    assert orientation < 1e-7


@pytest.mark.parametrize('distance', [0.0, 1e-12, 2e-9, 1e-7])
def test_moves_of_almost_no_length_are_valid(robot: BaseRobotModel, distance: float) -> None:
    trajectory = LinearJoint(robot).generate(robot.home, robot.home + distance)
    assert len(trajectory.time) >= 2
    np.testing.assert_array_equal(trajectory.position[-1], robot.home + distance)
    assert verify(trajectory, robot, torque=False).ok


def test_a_target_on_the_limits_is_reached(robot: BaseRobotModel) -> None:
    axes = robot.axes_data
    trajectory = LinearJoint(robot).generate(axes.lower, axes.upper)
    np.testing.assert_array_equal(trajectory.position[-1], axes.upper)
    assert verify(trajectory, robot, torque=False).ok


def test_fractions_slow_down(robot: BaseRobotModel) -> None:
    target = robot.home.copy()
    target[0] += 1.5
    slow = verify(LinearJoint(robot, speed_fraction=0.25).generate(robot.home, target), robot, torque=False)
    assert slow.uses['velocity'].ratio == pytest.approx(0.25, rel=2e-4)
    gentle = verify(
        LinearJoint(robot, acceleration_fraction=0.1).generate(robot.home, target), robot, torque=False
    )
    assert gentle.uses['acceleration'].ratio <= 0.1


def test_bad_input_is_refused_by_name(robot: BaseRobotModel) -> None:
    planner = LinearJoint(robot)
    beyond = robot.home.copy()
    beyond[1] = robot.axes_data.upper[1] + 0.1
    with pytest.raises(JointLimitError, match=robot.axes_data.names[1]):
        planner.generate(robot.home, beyond)
    with pytest.raises(JointLimitError, match=robot.axes_data.names[1]):
        planner.generate(beyond, robot.home)
    with pytest.raises(InvalidInputError, match='nan'):
        planner.generate(robot.home, np.full(robot.num_axes, np.nan))
    with pytest.raises(InvalidInputError, match='shape'):
        planner.generate(robot.home, [0.0, 1.0])
    with pytest.raises(UnreachablePoseError, match='cannot reach') as caught:
        planner.generate(robot.home, Pose(np.array([9.0, 0.0, 1.0]), np.eye(3)))
    assert float(caught.value.details['position_error']) > 1.0


@pytest.mark.parametrize('fraction', [0.0, -0.1, 1.1, np.nan, np.inf])
def test_a_fraction_outside_its_range_is_refused(robot: BaseRobotModel, fraction: float) -> None:
    with pytest.raises(InvalidInputError, match='speed_fraction'):
        LinearJoint(robot, speed_fraction=fraction)
    with pytest.raises(InvalidInputError, match='acceleration_fraction'):
        LinearJoint(robot, acceleration_fraction=fraction)
