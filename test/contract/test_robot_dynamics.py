"""Every robot: torques, mass matrix and masses agree with each other and with the description."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from robots_core import BaseRobotModel

from .reference import DescribedRobot, derivative

GRAVITY = np.array([0.0, 0.0, -9.81])
# Sums of some hundred products with cancellation: relative to the largest torque of the posture.
RELATIVE = 1e-11
# Central differences of an energy of up to 1e5 J, see reference.STEP: rounding eps E / h = 2e-6 N m.
ENERGY_TOLERANCE = 1e-5

SWING_END = 2.0  # s
# Gauss-Legendre of a power that swings at most some ten times: converged to rounding with this many nodes.
_nodes, _weights = np.polynomial.legendre.leggauss(100)
SWING_TIMES, SWING_WEIGHTS = 0.5 * SWING_END * (_nodes + 1.0), 0.5 * SWING_END * _weights
# Energies of up to 1e5 J that cancel to what is exchanged, each good to 1e-15.
SWING_TOLERANCE = 1e-11


def test_tau_is_mass_times_acceleration_plus_the_rest(robot: BaseRobotModel, postures: np.ndarray):
    n = robot.num_axes
    for q, q_dot, q_ddot in _motions(postures):
        tau, M, tau_aux = robot.rigid_dynamics(q, q_dot, q_ddot)
        assert tau.shape == tau_aux.shape == (n,)
        assert M.shape == (n, n)
        _assert_close(tau, M @ q_ddot + tau_aux)
        _assert_close(robot.rigid_dynamics(q, q_dot, np.zeros(n))[0], tau_aux)


def test_mass_matrix_is_symmetric_and_positive_definite(robot: BaseRobotModel, postures: np.ndarray):
    for q in postures:
        _, M, _ = robot.rigid_dynamics(q, np.zeros(robot.num_axes), np.zeros(robot.num_axes))
        np.testing.assert_array_equal(M, M.T)
        assert np.linalg.eigvalsh(M)[0] > 0.0, _lacking(robot)


def test_torques_are_those_of_the_description(robot: BaseRobotModel, postures: np.ndarray):
    described = DescribedRobot(robot)
    for q, q_dot, q_ddot in _motions(postures):
        expected = described.torques(q, q_dot, q_ddot)
        _assert_close(robot.rigid_dynamics(q, q_dot, q_ddot)[0], expected)
        _assert_close(robot.rigid_dynamics_model.torques(q, q_dot, q_ddot), expected)


def test_rigid_dynamics_and_its_model_agree(robot: BaseRobotModel, postures: np.ndarray):
    model = robot.rigid_dynamics_model
    for q, q_dot, q_ddot in _motions(postures):
        _, M, tau_aux = robot.rigid_dynamics(q, q_dot, q_ddot)
        _assert_close(model.mass_matrix(q), M)
        _assert_close(model.bias_torques(q, q_dot), tau_aux)


def test_gravity_torque_is_the_gradient_of_potential_energy(robot: BaseRobotModel, postures: np.ndarray):
    zero = np.zeros(robot.num_axes)
    for q in postures:
        _, _, tau_aux = robot.rigid_dynamics(q, zero, zero)
        gradient = [
            derivative(lambda h, q=q, unit=unit: _potential_energy(robot, q + h * unit))
            for unit in np.eye(robot.num_axes)
        ]
        np.testing.assert_allclose(tau_aux, gradient, atol=ENERGY_TOLERANCE)


def test_kinetic_energy_is_that_of_the_bodies(robot: BaseRobotModel, postures: np.ndarray):
    """q_dot^T M q_dot / 2 from masses, inertias and frames alone."""
    model = robot.rigid_dynamics_model
    for q, q_dot, _ in _motions(postures):
        energy = 0.0
        _, T = robot.kinematic_model.frame_axes(q)
        T_dot = derivative(lambda h, q=q, v=q_dot: robot.kinematic_model.frame_axes(q + h * v)[1])
        v = derivative(lambda h, q=q, v=q_dot: _centers_of_mass(robot, q + h * v))
        for body in range(1, robot.num_axes + 1):
            skew = T[body - 1].T @ T_dot[body - 1]  # of the angular velocity, in body axes
            omega = np.array([skew[2, 1], skew[0, 2], skew[1, 0]])
            energy += (
                0.5 * model.masses[body] * v[body] @ v[body] + 0.5 * omega @ model.inertias[body] @ omega
            )
        expected = 0.5 * q_dot @ model.mass_matrix(q) @ q_dot
        # Velocities from difference quotients are good to 1e-8, see reference.DIFFERENCE_TOLERANCE.
        np.testing.assert_allclose(energy, expected, rtol=1e-7)


def test_energy_is_balanced_over_a_random_swing(robot: BaseRobotModel):
    """What the drives put in is what the bodies have gained."""
    rng = np.random.default_rng(3)
    amplitude = rng.uniform(0.3, 1.0, robot.num_axes)
    frequency = rng.uniform(1.0, 3.0, robot.num_axes)
    phase = rng.uniform(0.0, 2.0 * np.pi, robot.num_axes)

    def motion(t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        angle = frequency * t + phase
        wave = amplitude * np.sin(angle)
        return robot.home + wave, amplitude * frequency * np.cos(angle), -(frequency**2) * wave

    def energy(t: float) -> float:
        q, q_dot, _ = motion(t)
        kinetic = 0.5 * q_dot @ robot.rigid_dynamics_model.mass_matrix(q) @ q_dot
        return float(kinetic) + _potential_energy(robot, q)

    powers = np.array([robot.rigid_dynamics(q, v, a)[0] @ v for q, v, a in map(motion, SWING_TIMES)])
    exchanged = SWING_WEIGHTS @ np.abs(powers)
    assert exchanged > 0.0, _lacking(robot)
    gained = energy(SWING_END) - energy(0.0)
    np.testing.assert_allclose(SWING_WEIGHTS @ powers, gained, rtol=0.0, atol=SWING_TOLERANCE * exchanged)


def test_bodies_are_physical(robot: BaseRobotModel):
    model = robot.rigid_dynamics_model
    n = robot.num_axes
    assert model.masses.shape == (n + 1,)
    assert model.centers_of_mass.shape == (n + 1, 3)
    assert model.inertias.shape == (n + 1, 3, 3)
    assert (model.masses >= 0.0).all()
    for body, inertia in enumerate(model.inertias[1:], 1):
        np.testing.assert_allclose(inertia, inertia.T, rtol=1e-12)
        principal = np.linalg.eigvalsh(inertia)
        assert principal[0] >= 0.0
        # The triangle inequality of principal moments; equality is a flat body, met up to rounding. Body 1 of
        # an arm turns about axis 1 alone: makers print placeholders for its other moments.
        assert body == 1 or principal[2] <= (principal[0] + principal[1]) * (1.0 + 1e-9)


def test_effort_holds_the_robot_at_home(robot: BaseRobotModel):
    zero = np.zeros(robot.num_axes)
    _, _, tau_aux = robot.rigid_dynamics(robot.home, zero, zero)
    assert (np.abs(tau_aux) < robot.axes_data.effort).all()


def _lacking(robot: BaseRobotModel) -> str:
    masses = robot.rigid_dynamics_model.masses[1:]
    bodies = ', '.join(name for name, mass in zip(robot.axes_data.names, masses, strict=True) if not mass)
    return (
        f'robot {robot.name!r} has no mass on these axes: {bodies or "none of them"}; its links need an '
        '<inertial> with mass and inertia, or its rigid_dynamics_model masses'
    )


def _motions(postures: np.ndarray) -> Iterable[tuple[np.ndarray, ...]]:
    return zip(postures, np.roll(postures, 1, axis=0), np.roll(postures, 2, axis=0), strict=True)


def _assert_close(mine: np.ndarray, expected: np.ndarray) -> None:
    np.testing.assert_allclose(mine, expected, rtol=0.0, atol=RELATIVE * np.abs(expected).max())


def _centers_of_mass(robot: BaseRobotModel, q: np.ndarray) -> np.ndarray:
    r, T = robot.kinematic_model.frame_axes(q)
    centers = robot.rigid_dynamics_model.centers_of_mass
    return np.vstack([centers[0], r + np.einsum('ijk,ik->ij', T, centers[1:])])


def _potential_energy(robot: BaseRobotModel, q: np.ndarray) -> float:
    return float(-robot.rigid_dynamics_model.masses @ _centers_of_mass(robot, q) @ GRAVITY)
