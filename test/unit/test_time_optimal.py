"""TimeOptimalTiming against an independent linear program, at every instant, and its refusals."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.sparse import csr_array, vstack
from scipy.spatial.transform import Rotation

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.errors import PlanningError
from robots_planning import verify
from robots_planning.path_kinematics.path_inverse_kinematics import PathInverseKinematics
from robots_planning.paths.cartesian_line import CartesianLine
from robots_planning.paths.joint_path import JointPath
from robots_planning.timing.switched_time_law import SwitchedTimeLaw
from robots_planning.timing.time_optimal import TimeOptimalTiming, local_excess
from robots_planning.timing.tool_limits import LimitedRates, PathLimits

ROBOTS = ('kuka_kr210_r2700', 'ur5e', 'manutec_r3', 'bello_bot')
FINE = 1e-4  # s


@pytest.fixture(scope='module', params=ROBOTS)
def robot(request: pytest.FixtureRequest) -> BaseRobotModel:
    return load_robot_model(request.param)


def line_path(robot: BaseRobotModel, seed: int, length: float = 0.3) -> JointPath:
    """The joint path of a random line that the robot can follow."""
    rng, axes = np.random.default_rng(seed), robot.axes_data
    while True:
        q = np.clip(robot.home + 0.5 * rng.normal(size=robot.num_axes), axes.lower, axes.upper)
        start = Pose(*robot.direct_kinematics(q))
        direction = rng.normal(size=3)
        turn = Rotation.from_rotvec(0.3 * rng.normal(size=3)).as_matrix()
        end = Pose(start.r + length * direction / np.linalg.norm(direction), turn @ start.T)
        try:
            return PathInverseKinematics(robot).follow(CartesianLine(start, end), q)
        except PlanningError:
            continue


def full_timing(robot: BaseRobotModel, *, torque: float | None = 1.0, **limits: float) -> TimeOptimalTiming:
    axes = robot.axes_data
    return TimeOptimalTiming(
        robot,
        limits.get('velocity', 1.0) * axes.velocity,
        limits.get('acceleration', 1.0) * axes.acceleration,
        None if torque is None else torque * axes.effort,
    )


def turned_round(path: JointPath) -> JointPath:
    return JointPath(1.0 - path.s[::-1], path.q[::-1], -path.q_s[::-1], path.q_ss[::-1])


def shortest_by_linear_program(robot: BaseRobotModel, path: JointPath, count: int) -> float:
    """Duration of the largest s_dot^2 with s_ddot constant per interval and limits kept at both its ends.

    The set of feasible speeds is a lattice, so that the largest sum is the largest everywhere. Limits at both
    ends of steps of 1 / count make it slower than the optimum, by an error of first order.
    """
    s = np.linspace(0.0, 1.0, count + 1)
    q, q_s, q_ss = path.evaluate(s)
    model, axes = robot.rigid_dynamics_model, robot.axes_data
    gravity = np.array([model.torques(x, 0.0 * x, 0.0 * x) for x in q])
    inertia = np.array([model.torques(x, 0.0 * x, v) for x, v in zip(q, q_s, strict=True)]) - gravity
    inertial = np.array([model.torques(*state) for state in zip(q, q_s, q_ss, strict=True)]) - gravity
    a = np.concatenate([q_s / axes.acceleration, inertia / axes.effort], axis=1)
    b = np.concatenate([q_ss / axes.acceleration, inertial / axes.effort], axis=1)
    c = np.concatenate([0.0 * q, gravity / axes.effort], axis=1)
    blocks, bounds = [], []
    interval = np.arange(count)
    for end in (0, 1):
        for k in range(a.shape[1]):
            gain = 0.5 * count * a[end : count + end, k]
            own = b[end : count + end, k]
            columns = np.concatenate([interval, interval + 1])
            values = np.concatenate([-gain + own * (1 - end), gain + own * end])
            block = csr_array((values, (np.tile(interval, 2), columns)), shape=(count, count + 1))
            offset = c[end : count + end, k]
            blocks += [block, -block]
            bounds += [1.0 - offset, 1.0 + offset]
    with np.errstate(divide='ignore'):
        highest = ((axes.velocity / np.abs(q_s)).min(axis=1)) ** 2
    highest[[0, -1]] = 0.0
    result = linprog(
        -np.ones(count + 1),
        A_ub=vstack(blocks),
        b_ub=np.concatenate(bounds),
        bounds=np.column_stack([np.zeros(count + 1), highest]),
        method='highs',
    )
    assert result.success, result.message
    speed = np.sqrt(np.maximum(result.x, 0.0))
    return float((2.0 / count / (speed[1:] + speed[:-1])).sum())


@pytest.mark.parametrize('seed', [1, 2])
def test_as_fast_as_a_linear_program(robot: BaseRobotModel, seed: int) -> None:
    path = line_path(robot, seed)
    duration = full_timing(robot).timed(path).trajectory.duration
    coarse, fine = (shortest_by_linear_program(robot, path, count) for count in (150, 300))
    # The linear program's error halves with its step; ramps and reserve of ours cost at most 1e-3.
    optimum = 2.0 * fine - coarse
    assert duration <= optimum * (1.0 + 1e-3) + 0.2 * (coarse - fine)
    assert duration >= optimum - 0.5 * (coarse - fine) - 1e-3 * optimum


@pytest.mark.parametrize('seed', range(4))
def test_every_limit_at_every_instant(robot: BaseRobotModel, seed: int) -> None:
    trajectory = full_timing(robot).timed(line_path(robot, 10 + seed)).trajectory
    axes, model = robot.axes_data, robot.rigid_dynamics_model
    t = np.arange(0.0, trajectory.duration, FINE)
    q, q_dot, q_ddot = trajectory.sample(t)
    tau = np.array([model.torques(*state) for state in zip(q, q_dot, q_ddot, strict=True)])
    # 1e-3 is what is promised.
    assert (np.abs(q_dot) / axes.velocity).max() < 1.0 + 1e-3
    assert (np.abs(q_ddot) / axes.acceleration).max() < 1.0 + 1e-3
    assert (np.abs(tau) / axes.effort).max() < 1.0 + 1e-3
    report = verify(trajectory, robot)
    assert report.ok, report.describe()


def test_larger_limits_are_never_slower(robot: BaseRobotModel) -> None:
    path = line_path(robot, 3)
    full = full_timing(robot).timed(path).trajectory.duration
    for smaller in ({'velocity': 0.6}, {'acceleration': 0.6}, {'torque': 0.6}):
        slower = full_timing(robot, **smaller).timed(path).trajectory.duration
        # What rounds of lowering limits cost is not the same for both.
        assert slower >= full * (1.0 - 5e-4)


def test_the_same_backwards_without_gravity(robot: BaseRobotModel) -> None:
    timing = full_timing(robot, torque=None)
    path = line_path(robot, 4)
    there, back = timing.timed(path).trajectory, timing.timed(turned_round(path)).trajectory
    # Where limits are lowered differs.
    assert back.duration == pytest.approx(there.duration, rel=5e-4)


def test_one_axis_moves_in_the_time_of_a_trapezoid() -> None:
    robot = load_robot_model('ur5e')
    q = np.tile(robot.home, (2, 1))
    q[1, 0] += 2.0
    zero = np.zeros((2, 6))
    path = JointPath(np.array([0.0, 1.0]), q, np.tile(q[1] - q[0], (2, 1)), zero)
    trajectory = full_timing(robot, torque=None).timed(path).trajectory
    v, a = robot.axes_data.velocity[0], robot.axes_data.acceleration[0]
    trapezoid = 2.0 / v + v / a if 2.0 * a >= v * v else 2.0 * np.sqrt(2.0 / a)
    # Ramps and reserve.
    assert trapezoid < trajectory.duration < trapezoid * (1.0 + 1e-3)


def test_tool_limits(robot: BaseRobotModel) -> None:
    path = line_path(robot, 5)

    def tool(s: np.ndarray) -> LimitedRates:
        still = np.zeros((len(s), 1))
        return LimitedRates(still + 0.3, still, still, np.array([0.05]), np.array([np.inf]))

    trajectory = full_timing(robot).timed(path, PathLimits(tool)).trajectory
    assert trajectory.duration > 0.3 / 0.05
    start, end = (Pose(*robot.direct_kinematics(q)) for q in trajectory.position[[0, -1]])
    assert np.linalg.norm(end.r - start.r) == pytest.approx(0.3, abs=1e-6)


def test_a_robot_that_cannot_hold_itself_names_axis_and_place(robot: BaseRobotModel) -> None:
    path = line_path(robot, 6)
    heavy = full_timing(robot, torque=1e-3)
    with pytest.raises(PlanningError, match=r'cannot hold the robot at .* gravity asks for') as caught:
        heavy.timed(path)
    details = caught.value.details
    assert details['joint'] in robot.axes_data.names
    assert abs(float(details['value'])) > float(details['bound'])
    assert 0.0 <= float(details['fraction']) <= 1.0


@pytest.mark.parametrize(('passed', 'points'), [(0, 20), (1, 1), (20, 0)])
def test_limits_are_lowered_at_every_point_from_a_passed_one_to_the_next_check(
    passed: int, points: int
) -> None:
    """Behind a singularity many points of the grid lie between two checks."""
    s = np.concatenate([np.geomspace(1e-8, 1e-3, 30), np.linspace(2e-3, 1.0, 60)])
    s = np.concatenate([[0.0], s])
    speed_squared = s * (1.0 - s)
    law = SwitchedTimeLaw(s, speed_squared, np.zeros(len(s) - 1), 2e-3)
    times = np.linspace(0.0, law.duration, 100, endpoint=False)
    use = np.full(len(times), 0.9)
    use[passed] = 1.1
    lowered = local_excess(law, times, use)
    inside = (law.grid_times >= times[passed]) & (law.grid_times <= times[passed + 1])
    assert inside.sum() > points
    assert (lowered[inside] >= 1.1).all()
    # And nowhere else but next to them.
    near = np.convolve(inside, np.ones(5), mode='same') > 0.0
    assert (lowered[~near] == 1.0).all()
