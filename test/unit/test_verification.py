"""verify: finds what is broken, where and when, and passes what is not."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.errors import InvalidInputError
from robots_planning import LinearCartesianLimited, LinearJoint, Trajectory, verify
from robots_planning.paths.path_deviation import path_deviation
from robots_planning.paths.pose_spline import PoseSpline


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
    assert f'does not {end}' in report.describe()


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


def test_a_motion_of_more_than_an_hour_is_refused(robot: BaseRobotModel) -> None:
    still = np.zeros((2, robot.num_axes))
    slow = Trajectory(np.array([0.0, 2e9]), np.array([robot.home, robot.home + 0.1]), still, still)
    with pytest.raises(InvalidInputError, match=r'the motion takes 2e\+09 s; allowed are 3600 s'):
        verify(slow, robot)


def points_of(trajectory: Trajectory) -> list[np.ndarray]:
    """Writable copies of time, position, velocity and acceleration."""
    return [
        np.array(values)
        for values in (trajectory.time, trajectory.position, trajectory.velocity, trajectory.acceleration)
    ]


class Mutation(NamedTuple):
    """Something that breaks a sound trajectory, and what must be reported of it."""

    told: str
    quantity: int  # of points_of
    change: Callable[[BaseRobotModel, np.ndarray], None]


def scaled(row: int, factor: float) -> Callable[[BaseRobotModel, np.ndarray], None]:
    def change(robot: BaseRobotModel, values: np.ndarray) -> None:
        values[row, 1] += factor * robot.axes_data.velocity[1]

    return change


@pytest.mark.parametrize(
    'mutation',
    [
        Mutation('velocity', 1, lambda _, q: q.__imul__(4.0)),
        Mutation('acceleration', 0, lambda _, time: time.__imul__(0.9)),
        Mutation('acceleration', 1, scaled(4, 0.01)),
        Mutation('acceleration', 2, scaled(4, 0.3)),
        Mutation('acceleration', 3, lambda robot, a: a[4].__iadd__(1.5 * robot.axes_data.acceleration)),
        Mutation('does not start', 2, scaled(0, 1e-4)),
        Mutation('does not start', 3, scaled(0, 1e-4)),
        Mutation('does not end', 2, scaled(-1, 1e-4)),
        Mutation('does not end', 3, scaled(-1, 1e-4)),
    ],
)
def test_every_way_to_break_a_sound_trajectory_is_caught(robot: BaseRobotModel, mutation: Mutation) -> None:
    target = robot.home + 0.4 * np.where(robot.home < 0.0, 1.0, -1.0)
    sound = LinearJoint(robot).generate(robot.home, target)
    assert verify(sound, robot, torque=False).ok
    points = points_of(sound)
    mutation.change(robot, points[mutation.quantity])
    assert mutation.told in verify(Trajectory(*points), robot, torque=False).describe()


@pytest.mark.parametrize(
    ('power', 'told'), [(0, 'position jumps'), (1, 'velocity jumps'), (2, 'acceleration jumps')]
)
def test_a_jump_between_intervals_is_caught(robot: BaseRobotModel, power: int, told: str) -> None:
    sound = LinearJoint(robot).generate(robot.home, robot.home + 0.05)
    assert max(verify(sound, robot, torque=False).jumps) < 1e-9
    broken = Trajectory(*points_of(sound))
    coefficients = np.array(sound.coefficients)
    coefficients[1, power, 0] += 1e-3
    broken.__dict__['coefficients'] = coefficients
    report = verify(broken, robot, torque=False)
    assert told in report.describe()
    assert report.jump_time in sound.time[[1, 2]]


def test_an_overshoot_between_samples_is_caught(robot: BaseRobotModel) -> None:
    """A position limit that is passed by a micrometre at a turning point, for less than a millisecond."""
    axes, q = robot.axes_data, robot.home
    top = axes.upper[0] + 1e-8
    a, h = axes.acceleration[0], 0.0205
    position = np.stack([q, q, q])
    position[:, 0] = [top - 0.5 * a * h**2, top, top - 0.5 * a * h**2]
    velocity, acceleration = np.zeros_like(position), np.zeros_like(position)
    velocity[:, 0], acceleration[:, 0] = [a * h, 0.0, -a * h], -a
    # The middle point is left out: the parabola goes through it all the same.
    broken = Trajectory(np.array([0.0, 2.0 * h]), position[::2], velocity[::2], acceleration[::2])
    assert verify(broken, robot, torque=False).outside == pytest.approx(1e-8, rel=1e-3)


def test_torque_above_its_limit_is_named(robot: BaseRobotModel) -> None:
    axis = robot.num_axes - 1
    report = verify(smooth_move(robot, axis, 0.5, 0.004), robot)
    assert report.axis_use['torque'][axis] > 1.0
    assert f'{report.uses["torque"].joint} torque' in report.describe()


def test_motion_at_the_start_may_be_the_robots_own(robot: BaseRobotModel) -> None:
    q_dot = 0.2 * robot.axes_data.velocity
    trajectory = LinearJoint(robot).generate_moving((robot.home, q_dot, 0.0 * q_dot), robot.home)
    assert not verify(trajectory, robot, torque=False).ok
    report = verify(trajectory, robot, torque=False, start_motion=(q_dot, np.zeros_like(q_dot)))
    assert report.ok, report.describe()


class Arc:
    """A quarter of a circle of 0.1 m about x, that the tool turns with."""

    def __init__(self, start: Pose) -> None:
        self.start = start

    def sample(self, s: np.ndarray) -> SimpleNamespace:
        angle = np.asarray(s) * 0.5 * np.pi
        turn = Rotation.from_rotvec(np.outer(angle, [1.0, 0.0, 0.0])).as_matrix()
        arm = np.array([0.0, 0.1, 0.0])
        return SimpleNamespace(r=self.start.r + turn @ arm - arm, T=turn @ self.start.T)


def test_a_path_is_compared_in_place_and_orientation(robot: BaseRobotModel) -> None:
    start = Pose(*robot.direct_kinematics(robot.home))
    arc, s = Arc(start), np.linspace(0.0, 1.0, 57)
    on = arc.sample(s)
    # The chords between 2001 points on a circle of 0.1 m; turning from point to point.
    assert max(path_deviation(on.r, on.T, arc)) < 1e-7
    away, r = np.zeros_like(on.r), on.r.copy()
    away[20] = 1e-3 * (on.r[20] - start.r + [0.0, 0.1, 0.0]) / 0.1
    assert path_deviation(r + away, on.T, arc)[0] == pytest.approx(1e-3, rel=1e-3)
    turned = on.T.copy()
    turned[20] = Rotation.from_rotvec([0.0, 1e-3, 0.0]).as_matrix() @ turned[20]
    assert path_deviation(r, turned, arc)[1] == pytest.approx(1e-3, rel=1e-2)
    short = arc.sample(0.9 * s)
    assert path_deviation(short.r, short.T, arc)[0] > 1e-2


def test_a_path_that_crosses_itself_is_known_on_each_of_its_branches() -> None:
    # Out, around, and back over the start to the other side; long, so that points on it are far apart.
    corners = np.array([[0, 0, 0], [3, 0, 0], [3, 3, 0], [0, 3, 0], [0, 0, 0], [0.01, -2, 0], [0, 0, 0.0]])
    path = PoseSpline([Pose(r, np.eye(3)) for r in corners])
    rng = np.random.default_rng(3)
    s = np.sort(np.concatenate([[0.0, 1.0], rng.uniform(0.0, 1.0, 500), path.parameters]).clip(0.0, 1.0))
    on = path.sample(s)
    assert max(path_deviation(on.r, on.T, path)) < 1e-6
    beside = on.r + np.array([0.0, 0.0, 2e-5])
    assert path_deviation(beside, on.T, path)[0] == pytest.approx(2e-5, rel=0.05)


def test_a_tool_on_a_line_of_its_own(robot: BaseRobotModel) -> None:
    tool = Pose.from_angles([0.1, 0.0, 0.2], [0.3, 0.1, 0.0])
    start = Pose(*robot.direct_kinematics(robot.home))
    target = Pose(start.r - [0.0, 0.0, 0.1], start.T)
    trajectory = LinearCartesianLimited(robot).generate(robot.home, target)
    line = (start @ tool, target @ tool)
    assert verify(trajectory, robot, line=line, tool=tool, torque=False).ok
    assert not verify(trajectory, robot, line=line, torque=False).ok
