"""The compiled derivative of the Jacobian, next to every robot's own."""

import numpy as np
import pytest

from robots_core import Pose, available_robot_models, load_robot_model
from robots_core.kernels.serial_chain import SerialChain, jacobian_der, pose_and_jacobian


def jacobian(chain: SerialChain, q: np.ndarray) -> np.ndarray:
    J = np.empty((6, q.size))
    pose_and_jacobian(chain.arrays, q, np.empty(3), np.empty((3, 3)), J)
    return J


@pytest.mark.parametrize('name', available_robot_models())
def test_equals_the_robots_own(name: str) -> None:
    robot = load_robot_model(name)
    chain = SerialChain.of(robot)
    rng = np.random.default_rng(1)
    n = robot.num_axes
    J_der = np.empty((6, n))
    for q, q_dot in rng.uniform(-1.5, 1.5, (20, 2, n)):
        jacobian_der(jacobian(chain, q), q_dot, J_der)
        # Rounding of sums of products of this size.
        np.testing.assert_allclose(J_der, robot.jacobian_der(q, q_dot), atol=1e-11)


@pytest.mark.parametrize('name', ['bello_bot', 'kuka_kr210_r2700'])
def test_is_the_difference_of_jacobians_with_a_tool(name: str) -> None:
    robot = load_robot_model(name)
    chain = SerialChain.of(robot, Pose.from_angles([0.1, -0.2, 0.3], [0.4, 0.5, 0.6]))
    rng = np.random.default_rng(2)
    q, q_dot = rng.uniform(-1.5, 1.5, (2, robot.num_axes))
    step = 1e-5
    difference = (jacobian(chain, q + step * q_dot) - jacobian(chain, q - step * q_dot)) / (2.0 * step)
    J_der = np.empty((6, robot.num_axes))
    jacobian_der(jacobian(chain, q), q_dot, J_der)
    # Central differences: step squared, and rounding over the step.
    np.testing.assert_allclose(J_der, difference, atol=1e-8)
