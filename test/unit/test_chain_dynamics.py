"""ChainDynamics: the same dynamics as the robot it was made of."""

import numpy as np
import pytest

from robots_core import available_robot_models, load_robot_model
from robots_core.blocks import ConstrainedInverseKinematics
from robots_core.kernels.chain_dynamics import (
    ChainDynamics,
    bodies_of,
    fill_dynamics,
    fill_torques,
)
from robots_core.pose import Pose


@pytest.mark.parametrize('name', available_robot_models())
def test_mass_matrix_and_bias_are_the_robots(name: str) -> None:
    robot = load_robot_model(name)
    dynamics = ChainDynamics.of(robot)
    assert dynamics is not None
    rng = np.random.default_rng(6)
    for _ in range(20):
        q, q_dot = rng.uniform(-2.0, 2.0, (2, robot.num_axes))
        M, bias = dynamics.mass_matrix_and_bias(q, q_dot)
        _, expected_M, expected_bias = robot.rigid_dynamics(q, q_dot, np.zeros(robot.num_axes))
        # Both sides round to 1e-15 of the largest torque.
        np.testing.assert_allclose(M, expected_M, rtol=1e-9, atol=1e-12 * np.abs(expected_M).max())
        np.testing.assert_allclose(bias, expected_bias, atol=1e-12 * (1.0 + np.abs(expected_bias).max()))


@pytest.mark.parametrize('name', available_robot_models())
def test_weight_and_torques_are_the_robots(name: str) -> None:
    robot = load_robot_model(name)
    n = robot.num_axes
    dynamics = ChainDynamics.of(robot)
    assert dynamics is not None
    q, q_dot, q_ddot = np.random.default_rng(7).uniform(-2.0, 2.0, (3, n))
    M, bias, weight, tau = np.empty((n, n)), np.empty(n), np.empty(n), np.empty(n)
    fill_dynamics(dynamics.arrays, q, q_dot, bodies_of(n), M, bias, weight)
    fill_torques(dynamics.arrays, q, q_dot, q_ddot, bodies_of(n), tau)
    at_rest, moving = robot.rigid_dynamics(q, 0.0 * q, 0.0 * q)[2], robot.rigid_dynamics(q, q_dot, q_ddot)[0]
    for found, expected in ((weight, at_rest), (tau, moving)):
        # Both sides round to 1e-15 of the largest torque.
        np.testing.assert_allclose(found, expected, atol=1e-12 * (1.0 + np.abs(expected).max()))


def test_a_robot_with_more_than_its_bodies_keeps_its_own_dynamics(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = load_robot_model('bello_bot')
    own = robot.rigid_dynamics

    def with_rotors(q: np.ndarray, q_dot: np.ndarray, q_ddot: np.ndarray) -> tuple[np.ndarray, ...]:
        _, M, tau_aux = own(q, q_dot, q_ddot)
        M = M + 0.5 * np.eye(q.size)
        return M @ q_ddot + tau_aux, M, tau_aux

    monkeypatch.setattr(robot, 'rigid_dynamics', with_rotors)
    assert ChainDynamics.of(robot) is None
    ik = ConstrainedInverseKinematics(robot, 0.004)
    r, T = robot.direct_kinematics(robot.home)
    step = ik.step(Pose(r + 0.1, T), robot.home, np.zeros(robot.num_axes))
    torque, _, _ = with_rotors(robot.home, np.zeros(robot.num_axes), step.q_ddot)
    np.testing.assert_allclose(step.torque, torque, rtol=1e-9)
