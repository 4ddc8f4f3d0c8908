"""FreeFloatingRobot: momentum and energy, counted body by body."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robots_core import load_robot_model
from robots_core.blocks.multibody.free_floating import FreeFloatingRobot
from robots_core.blocks.multibody.payload import Payload
from robots_core.errors import InvalidInputError

ORBIT = 'debris_arm?gravity=0,0,0'
TWIST = [0.01, 0.02, 0.0, 0.02, -0.01, 0.03]


def counted(floating: FreeFloatingRobot) -> tuple[np.ndarray, float]:
    """Momentum about the world's origin (6,) and kinetic energy, from masses and frames alone."""
    robot, base, twist = floating.robot, floating.base_pose, floating.base_twist
    bodies = robot.rigid_dynamics_model
    r, T = robot.kinematic_model.frame_axes(floating.position)
    v, omega = base.T @ twist[:3], base.T @ twist[3:]
    last = base.r
    momentum, energy = np.zeros(6), 0.0
    for body in range(robot.num_axes + 1):
        R, place = base.T, base.r
        if body > 0:
            R, place = base.T @ T[body - 1], base.r + base.T @ r[body - 1]
            v, last = v + np.cross(omega, place - last), place
            omega = omega + R @ axis(robot.name, body - 1) * floating.velocity[body - 1]
        arm = R @ bodies.centers_of_mass[body]
        speed = v + np.cross(omega, arm)
        tensor = R @ bodies.inertias[body] @ R.T
        push = bodies.masses[body] * speed
        momentum[:3] += push
        momentum[3:] += np.cross(place + arm, push) + tensor @ omega
        energy += 0.5 * push @ speed + 0.5 * omega @ tensor @ omega
    return momentum, float(energy)


def axis(name: str, index: int) -> np.ndarray:
    """Of the debris arm's URDF: the first about z, the others about y."""
    assert name == 'debris_arm'
    return np.array([0.0, 0.0, 1.0] if index == 0 else [0.0, 1.0, 0.0])


def swing(t: float, floating: FreeFloatingRobot) -> np.ndarray:
    """Torques that move the arm to and fro."""
    wanted = np.array([0.8 * np.sin(0.7 * t), 0.6 + 0.5 * np.sin(0.5 * t), 1.2 + 0.6 * np.cos(0.9 * t)])
    return np.array([60.0, 90.0, 40.0]) * (wanted - floating.position) - 60.0 * floating.velocity


def test_momentum_is_constant_over_a_minute():
    robot = load_robot_model(ORBIT)
    floating = FreeFloatingRobot(robot, robot.home, q_dot=[0.1, -0.05, 0.1], twist=TWIST)
    start, _ = counted(floating)
    moved = np.zeros(3)
    for k in range(600):
        floating.step(swing(0.1 * k, floating), 0.1)
        moved = np.maximum(moved, np.abs(floating.position - robot.home))
        momentum, _ = counted(floating)
        for part in (slice(0, 3), slice(3, 6)):
            change = np.linalg.norm(momentum[part] - start[part])
            assert change <= 1e-9 * np.linalg.norm(start[part])
    assert (moved > 0.3).all()


def test_the_base_turns_against_the_arm():
    """From rest, nothing but the arm moves it, and it comes back with it."""
    robot = load_robot_model(ORBIT)
    floating = FreeFloatingRobot(robot, robot.home)
    turned = 0.0
    for k in range(200):
        floating.step([20.0 * np.sign(np.sin(2.0 * np.pi * (k + 0.5) / 200)), 0.0, 0.0], 0.02)
        turned = max(turned, Rotation.from_matrix(floating.base_pose.T).magnitude())
        # Arm and base exchange up to 40 N m s.
        assert np.abs(counted(floating)[0]).max() < 1e-9 * 40.0
    assert turned > 0.05


def test_the_torques_work_is_the_energy():
    robot = load_robot_model(ORBIT)
    floating = FreeFloatingRobot(robot, robot.home, twist=TWIST)
    _, start = counted(floating)
    assert floating.kinetic_energy == pytest.approx(start)
    work = 0.0
    for k in range(200):
        tau, before = swing(0.02 * k, floating), floating.position
        floating.step(tau, 0.02)
        work += tau @ (floating.position - before)
    _, end = counted(floating)
    assert abs(work) > 0.1
    assert end - start == pytest.approx(work, abs=1e-8)  # the method's own error at steps of 5 ms


def test_in_gravity_everything_falls():
    robot = load_robot_model('debris_arm')
    floating = FreeFloatingRobot(robot, robot.home, payload=Payload(5.0))
    floating.step(np.zeros(3), 1.0)
    np.testing.assert_allclose(floating.base_pose.r, [0.0, 0.0, -0.5 * 9.81], atol=1e-9)
    np.testing.assert_allclose(floating.position, robot.home, atol=1e-9)


def test_bad_input_is_named():
    with pytest.raises(InvalidInputError, match="base of robot 'manutec_r3' has no mass"):
        FreeFloatingRobot(load_robot_model('manutec_r3'), np.zeros(6))
    robot = load_robot_model(ORBIT)
    floating = FreeFloatingRobot(robot, robot.home)
    with pytest.raises(InvalidInputError, match='tau'):
        floating.step([0.0, np.inf, 0.0], 0.1)
    with pytest.raises(InvalidInputError, match='period'):
        floating.step(np.zeros(3), 0.0)
    with pytest.raises(InvalidInputError, match='twist'):
        FreeFloatingRobot(robot, robot.home, twist=np.zeros(3))
