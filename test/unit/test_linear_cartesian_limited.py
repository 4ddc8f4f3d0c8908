"""LinearCartesianLimited: the welding moves, bounds on duration, singularities, refusals."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.errors import InvalidInputError, JointLimitError, PlanningError, UnreachablePoseError
from robots_planning import LinearCartesianLimited, verify
from robots_planning.trajectory_generators import cartesian_generator
from robots_planning.trajectory_generators.cartesian_generator import LONGEST_SMOOTHING as WINDOW

KUKA = 'kuka_kr210_r2700'


@pytest.fixture(scope='module')
def kuka() -> BaseRobotModel:
    return load_robot_model(KUKA)


@pytest.fixture(scope='module', params=[KUKA, 'bello_bot'])
def robot(request: pytest.FixtureRequest) -> BaseRobotModel:
    return load_robot_model(request.param)


def bent(robot: BaseRobotModel) -> np.ndarray:
    """Joint positions near home, far from every singularity."""
    q = robot.home.copy()
    q[4 if robot.num_axes == 6 else 5] += 0.6
    return q


def moved(robot: BaseRobotModel, q: np.ndarray, r: list[float], turn: list[float]) -> tuple[Pose, Pose]:
    """The pose at `q`, and the same moved by `r` (m) and turned by `turn` (rad)."""
    start = Pose(*robot.direct_kinematics(q))
    return start, Pose(start.r + r, Rotation.from_rotvec(turn).as_matrix() @ start.T)


def trapezoid(distance: float, speed: float, acceleration: float) -> float:
    """Shortest time from rest to rest with limited speed and acceleration."""
    if distance * acceleration >= speed**2:
        return distance / speed + speed / acceleration
    return float(2.0 * np.sqrt(distance / acceleration))


def test_the_welding_moves_of_the_paper(kuka: BaseRobotModel) -> None:
    q = np.radians([0.0, -90.0, 45.0, 0.0, 45.0, 0.0])
    angles = np.radians([-42.03, 117.47, -35.89])
    for r in ([0.37, -1.78, 1.21], [0.37, -1.78, 1.18], [0.375, -1.78, 1.21]):
        target = Pose.from_angles(r, angles)
        trajectory = LinearCartesianLimited(kuka).generate(q, target)
        report = verify(trajectory, kuka, line=(Pose(*kuka.direct_kinematics(q)), target))
        assert report.ok, report.describe()
        q = trajectory.position[-1]


def test_tool_limits_alone_give_a_trapezoid(robot: BaseRobotModel) -> None:
    q = bent(robot)
    start, target = moved(robot, q, [0.0, 0.0, -0.05], [0.0, 0.0, 0.0])
    planner = LinearCartesianLimited(robot, cartesian_speed=0.02, cartesian_acceleration=0.1)
    trajectory = planner.generate(q, target)
    bound = trapezoid(0.05, 0.02, 0.1)
    # The smoothing window, and the 0.2 % margin under the limits.
    assert bound <= trajectory.duration <= 1.005 * bound + WINDOW
    r = np.array([robot.direct_kinematics(p)[0] for p in trajectory.sample(np.linspace(0, 3, 3001))[0]])
    speed = np.linalg.norm(np.diff(r, axis=0), axis=1) / 1e-3
    # Differences of positions that lie within 2e-7 m of the line at every sample.
    assert speed.max() <= 0.02 * (1.0 + 1e-4)
    assert verify(trajectory, robot, line=(start, target)).ok


def test_rotation_limits_alone_give_a_trapezoid(robot: BaseRobotModel) -> None:
    q = bent(robot)
    start, target = moved(robot, q, [0.0, 0.0, 0.0], [0.0, 0.1, 0.0])
    trajectory = LinearCartesianLimited(robot, rotation_speed=0.05, rotation_acceleration=0.2).generate(
        q, target
    )
    bound = trapezoid(0.1, 0.05, 0.2)
    assert bound <= trajectory.duration <= 1.005 * bound + WINDOW
    assert verify(trajectory, robot, line=(start, target)).ok


def test_smoothing_loses_little_against_the_unsmoothed_optimum(
    robot: BaseRobotModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    q = bent(robot)
    _, target = moved(robot, q, [-0.1, 0.1, -0.25], [0.2, 0.0, 0.3])
    fast = {'cartesian_speed': 50.0, 'cartesian_acceleration': 500.0}
    turning = {'rotation_speed': 50.0, 'rotation_acceleration': 500.0}
    smooth = LinearCartesianLimited(robot, **fast, **turning).generate(q, target)
    monkeypatch.setattr(cartesian_generator, 'LONGEST_SMOOTHING', 0.004)
    sharp = LinearCartesianLimited(robot, **fast, **turning).generate(q, target)
    assert smooth.duration <= 1.05 * sharp.duration + WINDOW


@pytest.mark.parametrize(
    ('r', 'turn'),
    [
        ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
        ([1e-9, 0.0, 0.0], [0.0, 0.0, 0.0]),
        ([1e-7, 0.0, 0.0], [0.0, 0.0, 0.0]),
        ([1e-5, 0.0, -1e-5], [0.0, 1e-6, 0.0]),
        ([0.0, 0.0, 0.0], [1e-4, 0.0, 0.0]),
        ([0.0, 0.0, -0.2], [0.0, 0.0, 0.0]),
        ([0.0, 0.0, 0.0], [0.3, 0.2, -0.2]),
        ([-0.1, 0.1, -0.1], [0.3, 0.2, 0.1]),
    ],
)
def test_short_pure_and_mixed_lines_keep_everything(
    robot: BaseRobotModel, r: list[float], turn: list[float]
) -> None:
    q = bent(robot)
    start, target = moved(robot, q, r, turn)
    trajectory = LinearCartesianLimited(robot).generate(q, target)
    report = verify(trajectory, robot, line=(start, target))
    assert report.ok, report.describe()
    np.testing.assert_array_equal(trajectory.position[0], q)


def test_a_line_through_a_singularity_along_which_it_can_move(kuka: BaseRobotModel) -> None:
    q = np.radians([0.0, -90.0, 90.0, 0.0, 20.0, 0.0])
    start, target = moved(kuka, q, [0.0, 0.0, 0.0], [0.0, -0.8, 0.0])
    trajectory = LinearCartesianLimited(kuka).generate(q, target)
    assert trajectory.position[-1, 4] < 0.0 < trajectory.position[0, 4]
    assert verify(trajectory, kuka, line=(start, target)).ok


@pytest.mark.parametrize('distance', [1e-2, 1e-3, 1e-4])
def test_past_a_singularity_it_slows_down(kuka: BaseRobotModel, distance: float) -> None:
    q = np.radians([0.0, -90.0, 90.0, 0.0, 20.0, 0.0])
    q[3] = distance
    start, target = moved(kuka, q, [0.0, 0.0, 0.0], [0.0, -0.8, 0.0])
    far = LinearCartesianLimited(kuka).generate(q, moved(kuka, q, [0.0] * 3, [0.0, 0.8, 0.0])[1])
    near = LinearCartesianLimited(kuka).generate(q, target)
    assert near.duration > 1.2 * far.duration
    # The wrist turns over: axes 4 and 6 make half a turn against each other within a short piece of line.
    assert np.ptp(near.position[:, 3]) > 2.0
    report = verify(near, kuka, line=(start, target))
    assert report.ok, report.describe()


def test_a_line_out_of_a_singularity_is_refused_with_its_place(kuka: BaseRobotModel) -> None:
    _, target = moved(kuka, kuka.home, [0.0, 0.3, 0.0], [0.0, 0.0, 0.0])
    with pytest.raises(PlanningError, match=r'singularity at 0\.0 %') as caught:
        LinearCartesianLimited(kuka).generate(kuka.home, target)
    assert caught.value.details['fraction'] == 0.0
    assert caught.value.details['joint'] in kuka.axes_data.names


def test_a_line_that_leaves_the_axis_limits_names_axis_and_place(kuka: BaseRobotModel) -> None:
    axes = kuka.axes_data
    q = np.radians([0.0, -90.0, 45.0, 0.0, 45.0, 0.0])
    q[5] = axes.upper[5] - 0.1
    _, target = moved(kuka, q, [0.0, 0.0, 0.0], list(0.4 * kuka.jacobian(q)[3:, 5]))
    with pytest.raises(PlanningError, match='A6 would pass') as caught:
        LinearCartesianLimited(kuka).generate(q, target)
    details = caught.value.details
    # The tool turns about the axis of A6: only A6 moves, its bound is met after 0.1 of 0.4 rad.
    assert details['fraction'] == pytest.approx(0.25, abs=1e-6)
    assert details['bound'] == axes.upper[5]
    assert float(details['value']) > axes.upper[5]


def test_a_line_through_the_void_names_the_place(kuka: BaseRobotModel) -> None:
    """Both ends can be reached, the middle is inside the robot's own column."""
    q = np.radians([70.0, -90.0, 100.0, 0.0, 30.0, 0.0])
    start = Pose(*kuka.direct_kinematics(q))
    target = Pose(start.r * [1.0, -1.0, 1.0], start.T)
    with pytest.raises(PlanningError, match=r'at \d+\.\d % of its') as caught:
        LinearCartesianLimited(kuka).generate(q, target)
    assert 0.0 <= float(caught.value.details['fraction']) < 1.0


def test_bad_input_is_refused(robot: BaseRobotModel) -> None:
    planner = LinearCartesianLimited(robot)
    with pytest.raises(UnreachablePoseError, match='cannot reach'):
        planner.generate(bent(robot), Pose(np.array([9.0, 0.0, 1.0]), np.eye(3)))
    with pytest.raises(InvalidInputError, match='needs a Pose'):
        planner.generate(bent(robot), robot.home)
    with pytest.raises(JointLimitError):
        planner.generate(robot.axes_data.upper + 0.1, Pose.identity())


@pytest.mark.parametrize(
    'option', ['cartesian_speed', 'cartesian_acceleration', 'rotation_speed', 'rotation_acceleration']
)
@pytest.mark.parametrize('value', [0.0, -1.0, np.nan, np.inf])
def test_options_must_be_positive(kuka: BaseRobotModel, option: str, value: float) -> None:
    with pytest.raises(InvalidInputError, match=option):
        LinearCartesianLimited(kuka, **{option: value})
