"""DampedLeastSquares: options, unreachable poses, limits, determinism."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.blocks import DampedLeastSquares, Redundancy
from robots_core.errors import InvalidInputError, JointLimitError
from robots_core.kernels.serial_chain import error_between


@pytest.fixture(scope='module', params=['kuka_kr210_r2700', 'bello_bot'])
def robot(request: pytest.FixtureRequest) -> BaseRobotModel:
    return load_robot_model(request.param)


def test_a_solution_is_kept(robot: BaseRobotModel) -> None:
    q = robot.home + 0.05
    result = DampedLeastSquares(robot).solve(Pose(*robot.direct_kinematics(q)), q)
    assert result.converged
    np.testing.assert_array_equal(result.q, q)
    assert result.iterations == 0


def test_few_steps_from_near(robot: BaseRobotModel) -> None:
    q = robot.home + 0.2
    result = DampedLeastSquares(robot).solve(Pose(*robot.direct_kinematics(q)), q - 0.02)
    assert result.converged
    # Newton's method squares the error: 1e-2, 1e-4, 1e-8, 1e-16, and two steps until damping has faded.
    assert result.iterations <= 6


def test_unreachable_pose_gives_the_closest_joint_positions(robot: BaseRobotModel) -> None:
    pose = Pose(np.array([20.0, 0.0, 1.0]), np.eye(3))
    result = DampedLeastSquares(robot).solve(pose, robot.home)
    assert not result.converged
    robot.axes_data.check_position(result.q)
    position, orientation = Pose(*robot.direct_kinematics(result.q)).distance_to(pose)
    assert result.position_error == pytest.approx(position, abs=1e-9)
    assert result.orientation_error == pytest.approx(orientation, abs=1e-6)
    # No random preferred may come closer, in the sum of squares that is minimised.
    rng = np.random.default_rng(0)
    for q in rng.uniform(robot.axes_data.lower, robot.axes_data.upper, (300, robot.num_axes)):
        other = Pose(*robot.direct_kinematics(q)).distance_to(pose)
        assert np.hypot(*other) >= np.hypot(position, orientation) - 1e-9


def test_result_is_reproducible(robot: BaseRobotModel) -> None:
    rng = np.random.default_rng(5)
    q = rng.uniform(robot.axes_data.lower, robot.axes_data.upper)
    pose = Pose(*robot.direct_kinematics(q))
    first, second = (DampedLeastSquares(robot, seed=4).solve(pose, robot.home) for _ in range(2))
    np.testing.assert_array_equal(first.q, second.q)
    assert first.iterations == second.iterations
    with pytest.raises(ValueError, match='read-only'):
        first.q[0] = 0.0


def test_bad_input_is_refused(robot: BaseRobotModel) -> None:
    pose = Pose.identity()
    with pytest.raises(JointLimitError):
        DampedLeastSquares(robot).solve(pose, robot.axes_data.upper + 1.0)
    with pytest.raises(InvalidInputError, match='tolerance'):
        DampedLeastSquares(robot, tolerances=(0.0, 1e-6))
    with pytest.raises(InvalidInputError, match='max_iterations'):
        DampedLeastSquares(robot, max_iterations=0)
    with pytest.raises(InvalidInputError, match='restarts'):
        DampedLeastSquares(robot, restarts=-1)


@pytest.mark.parametrize('angle', [0.0, 1e-14, 1e-9, 1e-3, 1.0, 3.0, np.pi - 1e-9, np.pi])
def test_pose_error_is_the_rotation_vector(angle: float) -> None:
    axis = np.array([2.0, -3.0, 6.0]) / 7.0
    T = Rotation.from_rotvec([0.3, 0.2, -0.4]).as_matrix()
    target = Rotation.from_rotvec(angle * axis).as_matrix() @ T
    error = np.empty(6)
    error_between(np.zeros(3), T, np.array([1.0, 2.0, 3.0]), target, error)
    np.testing.assert_array_equal(error[:3], [1.0, 2.0, 3.0])
    # Rounding of a rotation matrix is 1e-16; half a turn has two rotation vectors.
    vector = error[3:] if error[3:] @ axis >= 0.0 else -error[3:]
    np.testing.assert_allclose(vector, angle * axis, atol=1e-8 if angle > 3.1 else 1e-15)


def test_many_poses_at_once_give_the_same_as_one_by_one(robot: BaseRobotModel) -> None:
    rng = np.random.default_rng(2)
    axes = robot.axes_data
    poses = [
        Pose(*robot.direct_kinematics(q)) for q in rng.uniform(axes.lower, axes.upper, (50, robot.num_axes))
    ]
    ik = DampedLeastSquares(robot, tolerances=(1e-6, 1e-6))
    batch = ik.solve_many([pose.r for pose in poses], [pose.T for pose in poses], robot.home)
    for k, pose in enumerate(poses):
        single = ik.solve(pose, robot.home)
        np.testing.assert_array_equal(batch.q[k], single.q)
        assert batch.converged[k] == single.converged
        assert batch.iterations[k] == single.iterations
    with pytest.raises(ValueError, match='read-only'):
        batch.q[0, 0] = 0.0
    assert ik.solve_many(np.empty((0, 3)), np.empty((0, 3, 3)), robot.home).q.shape == (0, robot.num_axes)


def test_bad_batches_are_refused(robot: BaseRobotModel) -> None:
    ik = DampedLeastSquares(robot)
    with pytest.raises(InvalidInputError, match=r'needed are \(m, 3\)'):
        ik.solve_many(np.zeros((2, 3)), np.zeros((3, 3, 3)), robot.home)
    with pytest.raises(InvalidInputError, match='pose 1 is not'):
        ik.solve_many(np.zeros((2, 3)), [np.eye(3), np.full((3, 3), np.nan)], robot.home)
    with pytest.raises(InvalidInputError, match='q_start has shape'):
        ik.solve_many(np.zeros((2, 3)), [np.eye(3), np.eye(3)], np.zeros((3, robot.num_axes)))


def test_a_tool_is_brought_to_the_pose(robot: BaseRobotModel) -> None:
    tool = Pose.from_angles([0.1, 0.0, 0.2], [0.0, 0.3, 0.1])
    pose = Pose(*robot.direct_kinematics(robot.home + 0.1)) @ tool
    result = DampedLeastSquares(robot, tool=tool).solve(pose, robot.home)
    assert result.converged
    reached = Pose(*robot.direct_kinematics(result.q)) @ tool
    assert max(reached.distance_to(pose)) < 1e-7  # the angle of two matrices


@pytest.mark.parametrize(
    'criterion',
    [Redundancy.near(np.full(7, 0.3)), Redundancy.away_from_limits(), Redundancy.manipulability()],
)
def test_redundancy_improves_its_criterion_and_keeps_the_pose(criterion: Redundancy) -> None:
    robot = load_robot_model('bello_bot')
    axes = robot.axes_data

    def badness(q: np.ndarray) -> float:
        if criterion.preferred.size:
            return float(((q - criterion.preferred) ** 2).sum())
        if criterion.kind == Redundancy.manipulability().kind:
            return -float(np.log(np.linalg.det(robot.jacobian(q) @ robot.jacobian(q).T)))
        return float((((q - 0.5 * (axes.lower + axes.upper)) / (axes.upper - axes.lower)) ** 2).sum())

    rng = np.random.default_rng(4)
    plain, chosen = DampedLeastSquares(robot), DampedLeastSquares(robot, redundancy=criterion)
    for _ in range(10):
        q = 0.5 * robot.home + 0.5 * rng.uniform(axes.lower, axes.upper)
        pose = Pose(*robot.direct_kinematics(q))
        without, result = plain.solve(pose, q), chosen.solve(pose, q)
        assert result.converged
        axes.check_position(result.q)
        assert badness(result.q) <= badness(without.q) + 1e-9
