"""verify: finds what is broken, where and when, and passes what is not."""

import numpy as np
import pytest

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.errors import InvalidInputError
from robots_planning import LinearCartesianLimited, LinearJoint, Trajectory, verify


@pytest.fixture(scope='module', params=['kuka_kr210_r2700', 'bello_bot'])
def robot(request: pytest.FixtureRequest) -> BaseRobotModel:
    return load_robot_model(request.param)


def smooth_move(robot: BaseRobotModel, axis: int, distance: float, duration: float) -> Trajectory:
    """One quintic from rest to rest, peak velocity 1.875 d / T, peak acceleration 10 d / (sqrt(3) T^2)."""
    position = np.stack([robot.home, robot.home])
    position[1, axis] += distance
    zero = np.zeros_like(position)
    return Trajectory(np.array([0.0, duration]), position, zero, zero)


def test_peaks_are_those_of_the_closed_form(robot: BaseRobotModel) -> None:
    report = verify(smooth_move(robot, 1, 0.1, 0.8), robot)
    velocity, acceleration = report.uses['velocity'], report.uses['acceleration']
    name = robot.axes_data.names[1]
    assert velocity.joint == acceleration.joint == name
    # Peaks of velocity are sampled at 1 kHz, those of acceleration are found exactly.
    assert velocity.value == pytest.approx(1.875 * 0.1 / 0.8, rel=1e-5)
    assert acceleration.value == pytest.approx(10.0 * 0.1 / (np.sqrt(3.0) * 0.8**2), rel=1e-9)
    assert velocity.time == pytest.approx(0.4, abs=1e-3)
    assert report.uses['jerk'].value == pytest.approx(60.0 * 0.1 / 0.8**3, rel=1e-9)


@pytest.mark.parametrize('quantity', ['velocity', 'acceleration'])
def test_a_limit_that_is_passed_is_named(robot: BaseRobotModel, quantity: str) -> None:
    axes, axis, distance = robot.axes_data, 2, 0.3
    durations = {
        'velocity': 1.875 * distance / axes.velocity[axis],
        'acceleration': np.sqrt(10.0 * distance / np.sqrt(3.0) / axes.acceleration[axis]),
    }
    kept = verify(smooth_move(robot, axis, distance, 1.001 * max(durations.values())), robot, torque=False)
    assert kept.ok, kept.describe()
    broken = verify(smooth_move(robot, axis, distance, 0.98 * durations[quantity]), robot, torque=False)
    assert not broken.ok
    assert broken.uses[quantity].joint == axes.names[axis]
    assert f'{axes.names[axis]} {quantity}' in broken.describe()


def test_position_outside_the_limits_is_named(robot: BaseRobotModel) -> None:
    axes = robot.axes_data
    beyond = axes.upper[0] + 0.01 - robot.home[0]
    report = verify(smooth_move(robot, 0, beyond, 60.0), robot, torque=False)
    assert report.outside == pytest.approx(0.01)
    assert axes.names[0] in report.describe()
    assert report.uses['position'].limit == axes.upper[0]
    inside = verify(smooth_move(robot, 0, beyond - 0.02, 60.0), robot, torque=False)
    assert inside.ok
    # The samples end on the target itself.
    assert inside.outside == pytest.approx(-0.01)


@pytest.mark.parametrize('end', ['start', 'end'])
def test_motion_at_an_end_is_found(robot: BaseRobotModel, end: str) -> None:
    move = smooth_move(robot, 0, 0.01, 1.0)
    velocity = np.zeros_like(move.position)
    velocity[0 if end == 'start' else -1, 0] = 1e-3
    report = verify(Trajectory(move.time, move.position, velocity, move.acceleration), robot, torque=False)
    assert f'does not {end} at rest' in report.describe()


def test_a_joint_line_is_no_tool_line(robot: BaseRobotModel) -> None:
    q = robot.home.copy()
    q[[0, 1, 4]] += [0.4, 0.1, 0.3]
    ends = (Pose(*robot.direct_kinematics(robot.home)), Pose(*robot.direct_kinematics(q)))
    report = verify(LinearJoint(robot).generate(robot.home, q), robot, line=ends, torque=False)
    assert report.line_deviation is not None
    assert report.line_deviation > 1e-3
    assert 'leaves its line' in report.describe()


def test_a_line_that_ends_elsewhere_is_found(robot: BaseRobotModel) -> None:
    start = Pose(*robot.direct_kinematics(robot.home))
    target = Pose(start.r - [0.0, 0.0, 0.1], start.T)
    trajectory = LinearCartesianLimited(robot).generate(robot.home, target)
    assert verify(trajectory, robot, line=(start, target), torque=False).ok
    further = Pose(target.r - [0.0, 0.0, 0.002], target.T)
    report = verify(trajectory, robot, line=(start, further), torque=False)
    # The ends of both lines differ by 2 mm; the trajectory's own deviation is far below the tolerance.
    assert report.line_deviation == pytest.approx(0.002, abs=1e-6)


def test_standing_torque_is_gravity(robot: BaseRobotModel) -> None:
    report = verify(smooth_move(robot, 0, 0.0, 0.1), robot)
    gravity = np.abs(robot.rigid_dynamics_model.bias_torques(robot.home, np.zeros(robot.num_axes)))
    np.testing.assert_allclose(report.axis_use['torque'], gravity / robot.axes_data.effort, atol=1e-12)
    assert 'torque' not in verify(smooth_move(robot, 0, 0.0, 0.1), robot, torque=False).uses


def test_another_number_of_axes_is_refused(robot: BaseRobotModel) -> None:
    values = np.zeros((2, 3))
    with pytest.raises(InvalidInputError, match='3 axes'):
        verify(Trajectory(np.array([0.0, 1.0]), values, values, values), robot)
