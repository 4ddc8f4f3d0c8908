"""FreeFloatingDynamics: the same motion as FreeFloatingRobot, which is driven by torques."""

from __future__ import annotations

import numpy as np
import pytest

from robots_core import load_robot_model
from robots_core.blocks import BaseMotion, FreeFloatingDynamics, FreeFloatingRobot, NumericalDynamics, Payload
from robots_core.errors import InvalidInputError

ORBIT = load_robot_model('debris_arm?gravity=0,0,0')
LOAD = Payload(30.0, np.array([0.05, 0.0, 0.1]), 0.5 * np.eye(3))
TAU = np.array([15.0, -25.0, 10.0])
Q_DOT = np.array([0.2, -0.1, 0.3])


def momentum_free(q_dot: np.ndarray) -> FreeFloatingRobot:
    """A robot in orbit whose joints move while all of it has no momentum."""
    floating = FreeFloatingRobot(ORBIT, ORBIT.home, payload=LOAD)
    # With no torque on the base, joints that are brought to a speed from rest leave the momentum at zero.
    dynamics = FreeFloatingDynamics(ORBIT, payload=LOAD, friction=False, rotors=False)
    for _ in range(200):
        wanted = 100.0 * (q_dot - floating.velocity)
        floating.step(dynamics.torques(floating.position, floating.velocity, wanted), 5e-4)
    return floating


def test_torques_and_accelerations_are_those_of_the_floating_robot():
    floating = momentum_free(Q_DOT)
    dynamics = FreeFloatingDynamics(ORBIT, payload=LOAD, friction=False, rotors=False)
    q, q_dot, h = floating.position, floating.velocity, 1e-4
    assert np.abs(q_dot).min() > 0.05
    q_ddot = dynamics.accelerations(q, q_dot, TAU)
    np.testing.assert_allclose(dynamics.torques(q, q_dot, q_ddot), TAU, atol=1e-9)
    _, later = floating.step(TAU, h)
    # A difference quotient over 0.1 ms: its error is half of that times the rate of the acceleration.
    np.testing.assert_allclose((later - q_dot) / h, q_ddot, atol=1e-3 * np.abs(q_ddot).max())


def test_the_arms_push_is_what_the_base_body_gets():
    floating = momentum_free(Q_DOT)
    dynamics = FreeFloatingDynamics(ORBIT, payload=LOAD, friction=False, rotors=False)
    bodies, h = ORBIT.rigid_dynamics_model, 1e-4
    mass, center, inertia = bodies.masses[0], bodies.centers_of_mass[0], bodies.inertias[0]

    def momentum() -> np.ndarray:
        """Of the base body, about the base's origin at the first instant, world axes, (6,)."""
        pose, twist = floating.base_pose, floating.base_twist
        omega = pose.T @ twist[3:]
        arm = pose.T @ center
        push = mass * (pose.T @ twist[:3] + np.cross(omega, arm))
        turn = pose.T @ inertia @ pose.T.T @ omega + np.cross(pose.r + arm - origin.r, push)
        return np.concatenate([push, turn])

    origin = floating.base_pose
    q, q_dot, before = floating.position, floating.velocity, momentum()
    pushed = -dynamics.base_wrench(q, q_dot, dynamics.accelerations(q, q_dot, TAU))
    floating.step(TAU, h)
    rate = (momentum() - before) / h
    seen = np.concatenate([origin.T.T @ rate[:3], origin.T.T @ rate[3:]])
    np.testing.assert_allclose(seen, pushed, atol=1e-3 * np.abs(pushed).max())


def test_a_heavy_base_hardly_moves():
    """With a base far heavier than the arm, all is as on a base that stands."""
    heavy = load_robot_model('debris_arm?gravity=0,0,0')
    bodies = heavy.rigid_dynamics_model
    factor = 1e9
    bodies.masses.setflags(write=True)
    bodies.inertias.setflags(write=True)
    bodies.masses[0] *= factor
    bodies.inertias[0] *= factor
    floating, held = FreeFloatingDynamics(heavy), NumericalDynamics(heavy)
    q_ddot = np.array([0.5, -0.4, 0.8])
    tau = held.torques(heavy.home, Q_DOT, q_ddot)
    np.testing.assert_allclose(floating.torques(heavy.home, Q_DOT, q_ddot), tau, rtol=1e-6)
    pushed = np.array([5.0, 0.0, -3.0])
    wrenches = [d.external_wrench(heavy.home, Q_DOT, q_ddot, tau + pushed) for d in (floating, held)]
    np.testing.assert_allclose(*wrenches, rtol=1e-6, atol=1e-6)


def test_the_wrench_at_the_tool_moves_the_base_too():
    """A tool that is pushed with a wrench gets torques from it by the generalised Jacobian alone."""
    dynamics = FreeFloatingDynamics(ORBIT, payload=LOAD)
    q, still = ORBIT.home, np.zeros(3)
    J = dynamics._tool_jacobian(q)
    assert np.abs(J - ORBIT.jacobian(q)).max() > 0.1
    tau = dynamics.torques(q, still, still) - J.T @ np.array([1.0, 2.0, 3.0, 0.0, 0.0, 0.0])
    found = dynamics.external_wrench(q, still, still, tau)
    np.testing.assert_allclose(J.T @ found, J.T @ np.array([1.0, 2.0, 3.0, 0.0, 0.0, 0.0]), atol=1e-9)


def test_bad_input_is_named():
    with pytest.raises(InvalidInputError, match="base of robot 'manutec_r3' has no mass"):
        FreeFloatingDynamics(load_robot_model('manutec_r3'))
    with pytest.raises(InvalidInputError, match='moves by itself'):
        FreeFloatingDynamics(ORBIT, base=BaseMotion(angular_velocity=[0.1, 0.0, 0.0]))
    with pytest.raises(InvalidInputError, match='q_ddot'):
        FreeFloatingDynamics(ORBIT).base_wrench(ORBIT.home, Q_DOT, np.full(3, np.nan))
