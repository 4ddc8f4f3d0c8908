"""LinearCartesianDynamicProgramming: singular starts, redundancy, tool, refusals with reasons."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.blocks import AnalyticalInverseKinematic
from robots_core.errors import InvalidInputError, JointLimitError, PlanningError, UnreachablePoseError
from robots_core.robot_model.analytic.configuration import Configuration
from robots_core.robot_model.wrapped_robot import WrappedRobot
from robots_planning import LinearCartesianDynamicProgramming, LinearCartesianLimited, Trajectory, verify
from robots_planning.path_kinematics.configuration_graph import ConfigurationGraph
from robots_planning.path_kinematics.path_inverse_kinematics import PathInverseKinematics
from robots_planning.paths import path_grid
from robots_planning.paths.cartesian_line import CartesianLine

KUKA = 'kuka_kr210_r2700'
FINE = 1e-4  # s


@pytest.fixture(scope='module')
def kuka() -> BaseRobotModel:
    return load_robot_model(KUKA)


def moved(robot: BaseRobotModel, q: np.ndarray, r: list[float], turn: list[float]) -> tuple[Pose, Pose]:
    """The pose at `q`, and the same moved by `r` (m) and turned by `turn` (rad)."""
    start = Pose(*robot.direct_kinematics(q))
    return start, Pose(start.r + r, Rotation.from_rotvec(turn).as_matrix() @ start.T)


def check(trajectory: Trajectory, robot: BaseRobotModel, start: Pose, target: Pose) -> None:
    report = verify(trajectory, robot, line=(start, target))
    assert report.ok, report.describe()
    axes, model = robot.axes_data, robot.rigid_dynamics_model
    t = np.arange(0.0, trajectory.duration, FINE)
    q, q_dot, q_ddot = trajectory.sample(t)
    tau = np.array([model.torques(*state) for state in zip(q, q_dot, q_ddot, strict=True)])
    # 1e-3 is what is promised.
    assert (np.abs(q_dot) / axes.velocity).max() < 1.0 + 1e-3
    assert (np.abs(q_ddot) / axes.acceleration).max() < 1.0 + 1e-3
    assert (np.abs(tau) / axes.effort).max() < 1.0 + 1e-3


@pytest.mark.parametrize('name', [KUKA, 'ur10e', 'franka_fr3'])
def test_faster_than_limited_lines_with_the_same_limits(name: str) -> None:
    robot = load_robot_model(name)
    q = robot.home.copy()
    q[4 if robot.num_axes == 6 else 5] += 0.5
    start, target = moved(robot, q, [0.1, 0.15, -0.1], [0.1, 0.2, 0.0])
    limits = {
        'cartesian_speed': 0.4,
        'cartesian_acceleration': 1.5,
        'rotation_speed': 1.0,
        'rotation_acceleration': 5.0,
    }

    class Strong(WrappedRobot):
        axes_data = replace(robot.axes_data, effort=1e6 * robot.axes_data.effort)

    fast = LinearCartesianDynamicProgramming(Strong(robot), **limits).generate(q, target)
    assert fast.duration < LinearCartesianLimited(robot, **limits).generate(q, target).duration
    check(LinearCartesianDynamicProgramming(robot, **limits).generate(q, target), robot, start, target)


@pytest.mark.parametrize('offset', [[0.0, 0.3, 0.0], [0.0, -0.2, 0.1], [0.1, 0.2, -0.3], [0.2, 0.0, 0.1]])
def test_lines_out_of_a_straight_wrist(kuka: BaseRobotModel, offset: list[float]) -> None:
    """Home is singular: the wrist turns first, where it has to, and the tool stands still meanwhile."""
    start, target = moved(kuka, kuka.home, offset, [0.0, 0.0, 0.0])
    trajectory = LinearCartesianDynamicProgramming(kuka).generate(kuka.home, target)
    check(trajectory, kuka, start, target)
    np.testing.assert_array_equal(trajectory.position[0], kuka.home)


@pytest.mark.parametrize(
    ('q', 'offset', 'turn'),
    [
        (
            [1.202825257, -0.239125395, 2.622632346, -2.383449437, 0.709579641, 1.13948213],
            [-0.372378154, 0.018447656, -0.333157912],
            [-0.018438726, 0.028836912, 0.702311197],
        ),
        (
            [-0.971429829, -1.040803691, 3.141592654, -1.140528482, 0.001904594, 0.325252376],
            [0.364865422, -0.336996271, -0.057504237],
            [0.083655524, 0.264872898, 0.1247957],
        ),
    ],
)
def test_parallel_axes_turn_straight_only_quite_close_to_a_singularity(
    q: list[float], offset: list[float], turn: list[float]
) -> None:
    """Four axes of this wrist are parallel there, so that the tool stands still on curved joint paths."""
    robot = load_robot_model('ur5e')
    start, target = moved(robot, np.array(q), offset, turn)
    check(LinearCartesianDynamicProgramming(robot).generate(np.array(q), target), robot, start, target)


@pytest.mark.parametrize('offset', [[0.0, 0.3, 0.0], [0.1, 0.2, -0.3], [0.2, 0.0, 0.1]])
@pytest.mark.parametrize('turn', [[0.0, 0.0, 0.0], [0.3, -0.2, 0.1]])
def test_a_finer_grid_is_not_much_faster(
    kuka: BaseRobotModel, offset: list[float], turn: list[float], monkeypatch: pytest.MonkeyPatch
) -> None:
    q = np.add(kuka.home, [0.0, 0.1, 0.0, 0.0, 1e-4, 0.0])
    gains_little_on_a_finer_grid(kuka, q, moved(kuka, q, offset, turn)[1], monkeypatch)


def test_the_grid_is_made_finer_where_the_first_profile_passes_a_limit(
    kuka: BaseRobotModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A line that passes a singularity so closely that lower limits there would cost 0.2 %."""
    q = np.array([-1.185855457, -2.080711825, 2.547464989, -1.749947063, 0.010472918, 0.348469824])
    offset, turn = [-0.243989098, -0.045643179, 0.434034584], [0.526872038, 0.058411905, 0.037307685]
    gains_little_on_a_finer_grid(kuka, q, moved(kuka, q, offset, turn)[1], monkeypatch)


def gains_little_on_a_finer_grid(
    robot: BaseRobotModel, q: np.ndarray, target: Pose, monkeypatch: pytest.MonkeyPatch
) -> None:
    planner = LinearCartesianDynamicProgramming(robot)
    duration = planner.generate(q, target).duration
    for name in ('POINTS', 'TURN_POINTS'):
        monkeypatch.setattr(path_grid, name, 5 * getattr(path_grid, name))
    # 1e-3 is what is promised.
    assert duration < planner.generate(q, target).duration * (1.0 + 1e-3)


@pytest.mark.parametrize('distance', [1e-2, 1e-4, 1e-6])
def test_past_a_singularity_it_slows_down_and_keeps_the_limits(kuka: BaseRobotModel, distance: float) -> None:
    q = np.radians([0.0, -90.0, 90.0, 0.0, 20.0, 0.0])
    q[3] = distance
    start, target = moved(kuka, q, [0.0, 0.0, 0.0], [0.0, -0.8, 0.0])
    planner = LinearCartesianDynamicProgramming(kuka)
    near = planner.generate(q, target)
    check(near, kuka, start, target)
    far = planner.generate(q, moved(kuka, q, [0.0] * 3, [0.0, 0.8, 0.0])[1])
    assert near.duration > 1.2 * far.duration
    assert np.ptp(near.position[:, 3]) > 2.0


@pytest.mark.parametrize('name', [KUKA, 'ur5e'])
def test_jerk_limits_on_request(name: str) -> None:
    robot = load_robot_model(name)
    q = robot.home.copy()
    q[4] += 0.5
    start, target = moved(robot, q, [0.1, 0.15, -0.1], [0.1, 0.2, 0.0])
    fastest = LinearCartesianDynamicProgramming(robot).generate(q, target)
    smooth = LinearCartesianDynamicProgramming(robot, jerk_limited=True).generate(q, target)
    check(smooth, robot, start, target)
    assert verify(smooth, robot).uses['jerk'].ratio <= 1.0
    # A jump from one acceleration limit to the other lasts 2 a / j, at both ends half of it.
    axes = robot.axes_data
    assert 0.0 < smooth.duration - fastest.duration < 3.0 * float((axes.acceleration / axes.jerk).max())


def test_self_motion_keeps_a_seventh_axis_inside_its_limits() -> None:
    """Lines on which the least joint motion runs into a limit that self-motion avoids."""
    robot = load_robot_model('franka_fr3')
    axes, kinematics = robot.axes_data, PathInverseKinematics(robot)
    planner, rng, rescued = LinearCartesianDynamicProgramming(robot), np.random.default_rng(1), 0
    for _ in range(60):
        q = np.clip(robot.home + 0.5 * rng.normal(size=7), axes.lower + 0.03, axes.upper - 0.03)
        offset = rng.normal(size=3)
        start, target = moved(robot, q, list(0.3 * offset / np.linalg.norm(offset)), [0.0, 0.0, 0.0])
        try:
            kinematics.follow(CartesianLine(start, target), q)
        except PlanningError as error:
            if 'bound' not in error.details:
                continue
            try:
                trajectory = planner.generate(q, target)
            except PlanningError:
                continue
            check(trajectory, robot, start, target)
            rescued += 1
            if rescued == 2:
                return
    pytest.fail(f'only {rescued} of 60 lines')


def test_a_tool_moves_straight(kuka: BaseRobotModel) -> None:
    tool = Pose.from_angles([0.1, 0.0, 0.3], [0.0, 0.6, 0.0])
    q = np.radians([10.0, -90.0, 80.0, 0.0, 40.0, 0.0])
    start = Pose(*kuka.direct_kinematics(q)) @ tool
    target = Pose(start.r + np.array([0.1, 0.2, -0.1]), start.T)
    trajectory = LinearCartesianDynamicProgramming(kuka, tool=tool).generate(q, target)
    for position in trajectory.sample(np.linspace(0.0, trajectory.duration, 50))[0]:
        r = (Pose(*kuka.direct_kinematics(position)) @ tool).r - start.r
        along = target.r - start.r
        across = r - along * (r @ along) / (along @ along)
        # What trajectories may leave their line by.
        assert np.linalg.norm(across) < 1e-5


def test_a_line_that_only_another_configuration_can_do_names_it(kuka: BaseRobotModel) -> None:
    """A6 near its bound: another wrist reaches the same poses with A6 half a turn away."""
    q = np.radians([0.0, -90.0, 45.0, 0.0, 45.0, 0.0])
    q[5] = kuka.axes_data.upper[5] - 0.1
    _, target = moved(kuka, q, [0.0, 0.0, 0.0], list(0.4 * kuka.jacobian(q)[3:, 5]))
    planner = LinearCartesianDynamicProgramming(kuka)
    with pytest.raises(PlanningError, match=r'A6 would pass .* can be done from configuration') as caught:
        planner.generate(q, target)
    configuration = Configuration.parse(str(caught.value.details['configuration']))
    analytic = AnalyticalInverseKinematic(kuka)
    pose = Pose(*kuka.direct_kinematics(q))
    durations = []
    for q_start in analytic.solve_all(pose, turns=True):
        if analytic.configuration(q_start) == configuration:
            try:
                durations.append(planner.generate(q_start, target).duration)
            except PlanningError:
                continue
    assert durations


def test_a_line_that_nothing_can_do_says_so(kuka: BaseRobotModel) -> None:
    """Through the robot's own column."""
    q = np.radians([70.0, -90.0, 100.0, 0.0, 30.0, 0.0])
    start = Pose(*kuka.direct_kinematics(q))
    target = Pose(start.r * [1.0, -1.0, 1.0], start.T)
    with pytest.raises(PlanningError, match='no other configuration') as caught:
        LinearCartesianDynamicProgramming(kuka).generate(q, target)
    assert 0.0 < float(caught.value.details['fraction']) < 1.0


def test_routes_are_continuous(kuka: BaseRobotModel) -> None:
    start, target = moved(kuka, kuka.home, [0.0, 0.3, 0.0], [0.0, 0.0, 0.0])
    graph = ConfigurationGraph(PathInverseKinematics(kuka))
    for route in graph.routes(CartesianLine(start, target), kuka.home):
        np.testing.assert_array_equal(route[0].joints.q[0], kuka.home)
        for before, after in pairwise(route):
            np.testing.assert_array_equal(before.joints.q[-1], after.joints.q[0])
        assert [piece.begin == piece.end for piece in route] == [True, False]


@pytest.mark.parametrize('offset', [[0.0, 0.3, 0.0], [0.1, 0.2, -0.3]])
def test_the_fastest_route_is_taken(kuka: BaseRobotModel, offset: list[float]) -> None:
    start, target = moved(kuka, kuka.home, offset, [0.0, 0.0, 0.0])
    line, planner = CartesianLine(start, target), LinearCartesianDynamicProgramming(kuka)
    routes = planner.configuration_graph.routes(line, kuka.home)
    # Turned by the wrist's other half, and by whole turns.
    assert len(routes) > 2
    durations = [
        sum(planner.along(piece.joints, piece.tool(line)).duration for piece in route) for route in routes
    ]
    # Times of messages are whole nanoseconds.
    assert planner.generate(kuka.home, target).duration == pytest.approx(min(durations), abs=1e-8)


def test_whole_turns_of_axes_are_routes_as_long_as_limits_allow(kuka: BaseRobotModel) -> None:
    start, target = moved(kuka, kuka.home, [0.0, 0.3, 0.0], [0.0, 0.0, 0.0])
    routes = ConfigurationGraph(PathInverseKinematics(kuka)).routes(CartesianLine(start, target), kuka.home)
    ends = np.array([route[-1].joints.q[-1] for route in routes])
    turns = (ends[:, None] - ends[None]) / (2.0 * np.pi)
    whole = np.abs(turns - np.round(turns)).max(axis=2) < 1e-9
    assert (whole & (np.abs(turns).max(axis=2) > 0.5)).any()
    for route in routes:
        for piece in route:
            q, _, _ = piece.joints.evaluate(np.linspace(0.0, 1.0, 200))
            assert (q >= kuka.axes_data.lower - 1e-8).all()
            assert (q <= kuka.axes_data.upper + 1e-8).all()


def test_bad_input_is_refused(kuka: BaseRobotModel) -> None:
    planner = LinearCartesianDynamicProgramming(kuka)
    with pytest.raises(UnreachablePoseError, match='cannot reach'):
        planner.generate(kuka.home, Pose(np.array([9.0, 0.0, 1.0]), np.eye(3)))
    with pytest.raises(InvalidInputError, match='needs a Pose'):
        planner.generate(kuka.home, kuka.home)
    with pytest.raises(JointLimitError):
        planner.generate(kuka.axes_data.upper + 0.1, Pose.identity())
    with pytest.raises(InvalidInputError, match='cartesian_speed'):
        LinearCartesianDynamicProgramming(kuka, cartesian_speed=0.0)


def test_no_way_is_no_motion(kuka: BaseRobotModel) -> None:
    pose = Pose(*kuka.direct_kinematics(kuka.home))
    trajectory = LinearCartesianDynamicProgramming(kuka).generate(kuka.home, pose)
    np.testing.assert_array_equal(trajectory.position, [kuka.home, kuka.home])
