"""SerialChain: the same kinematics as the robot it was made of."""

import numpy as np
import pytest

from robots_core import Pose, available_robot_models, load_robot_model
from robots_core.errors import InvalidInputError
from robots_core.kernels.serial_chain import SerialChain, error_between, pose_and_jacobian

TOOL = Pose.from_angles([0.1, -0.2, 0.3], [0.4, 0.5, -0.6])


@pytest.mark.parametrize('name', available_robot_models())
def test_pose_and_jacobian_are_the_robots(name: str) -> None:
    robot = load_robot_model(name)
    chain = SerialChain.of(robot)
    r, T, J = np.empty(3), np.empty((3, 3)), np.empty((6, robot.num_axes))
    for q in np.random.default_rng(1).uniform(-2.0, 2.0, (20, robot.num_axes)):
        pose_and_jacobian(chain.arrays, q, r, T, J)
        expected = robot.direct_kinematics(q)
        # A few products of matrices, each rounding to 1e-16 per metre.
        np.testing.assert_allclose(r, expected[0], atol=1e-13)
        np.testing.assert_allclose(T, expected[1], atol=1e-13)
        np.testing.assert_allclose(J, robot.jacobian(q), atol=1e-12)


def test_a_tool_moves_the_point() -> None:
    robot = load_robot_model('bello_bot')
    chain = SerialChain.of(robot, TOOL)
    expected = Pose(*robot.direct_kinematics(robot.home)) @ TOOL
    assert max(chain.forward(robot.home).distance_to(expected)) < 1e-7  # the angle of two matrices


def test_a_robot_with_coupled_axes_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = load_robot_model('bello_bot')
    forward = robot.direct_kinematics
    monkeypatch.setattr(robot, 'direct_kinematics', lambda q: forward(q + np.roll(q, 1)))
    with pytest.raises(InvalidInputError, match='not a chain of axes'):
        SerialChain.of(robot)


@pytest.mark.parametrize('angle', [0.0, 1e-14, 1e-9, 1e-3, 1.0, 3.0, np.pi - 1e-9, np.pi])
@pytest.mark.parametrize('axis', [[2.0, -3.0, 6.0], [-6.0, 2.0, 3.0], [3.0, 6.0, -2.0]])
def test_error_is_the_rotation_vector(angle: float, axis: list[float]) -> None:
    from scipy.spatial.transform import Rotation  # noqa: PLC0415

    unit = np.array(axis) / 7.0
    T = Rotation.from_rotvec([0.3, 0.2, -0.4]).as_matrix()
    target = Rotation.from_rotvec(angle * unit).as_matrix() @ T
    error = np.empty(6)
    error_between(np.zeros(3), T, np.array([1.0, 2.0, 3.0]), target, error)
    np.testing.assert_array_equal(error[:3], [1.0, 2.0, 3.0])
    # Half a turn has two rotation vectors.
    vector = error[3:] if error[3:] @ unit >= 0.0 else -error[3:]
    np.testing.assert_allclose(vector, angle * unit, atol=1e-14)
