"""Laws of the rigid-body drives: friction only takes energy, and torques keep their limits."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from robots_core import BaseRobotModel, load_robot_model
from robots_core.blocks.drives.rigid_body_drive import RigidBodyDrive
from robots_core.blocks.multibody.numerical_dynamics import NumericalDynamics

NAMES = ('bello_bot', 'cello_bot', 'manutec_r3', 'ur5e')
PERIOD = 0.01


@cache
def weightless(name: str) -> BaseRobotModel:
    return load_robot_model(f'{name}?gravity=0,0,0')


def swinging(robot: BaseRobotModel, seed: int, *, friction: bool) -> RigidBodyDrive:
    """A robot without control that has been brought to some speed by its drives' reference."""
    rng = np.random.default_rng(seed)
    n = robot.num_axes
    data = robot.drive_data
    # An infinite integrator and no position control: the torque is the gain times the error of speed.
    pushed = replace(data, position_gain=np.zeros(n), integral_time=np.full(n, np.inf))
    drive = RigidBodyDrive(robot, robot.home, period=PERIOD, drives=pushed)
    speed = 0.3 * robot.axes_data.velocity * rng.uniform(-1.0, 1.0, n)
    q = np.array(robot.home)
    for _ in range(20):
        q = q + PERIOD * speed
        drive.step(q, speed)
    free = replace(
        pushed,
        velocity_gain=np.zeros(n),
        current_frequency=np.full(n, np.inf),
        coulomb_friction=rng.uniform(0.0, 0.2, n) * data.torque_limit * friction,
        viscous_friction=data.viscous_friction * friction,
        damping=data.damping * friction,
    )
    loose = RigidBodyDrive(robot, drive.position, period=PERIOD, drives=free)
    loose.position, loose.velocity, loose._state[:] = drive.position, drive.velocity, drive._state
    loose._state[5:] = 0.0  # torques and the acceleration that was
    return loose


def energy(robot: BaseRobotModel, drive: RigidBodyDrive) -> float:
    """Kinetic, with the rotors', and of the gears' springs."""
    elastic = np.isfinite(drive.drives.stiffness)
    M = NumericalDynamics(robot, friction=False, rotors=False).mass_matrix(drive.position)
    motor_speed = drive._state[3]
    wind = drive.motor_position - drive.position
    springs = 0.5 * np.where(elastic, drive.drives.stiffness, 0.0) @ wind**2
    rotors = 0.5 * drive.drives.inertia @ motor_speed**2
    return float(0.5 * drive.velocity @ M @ drive.velocity + rotors + springs)


@settings(max_examples=15)
@given(st.sampled_from(NAMES), st.integers(0, 2**32 - 1))
def test_friction_only_takes_energy(name: str, seed: int):
    robot = weightless(name)
    drive = swinging(robot, seed, friction=True)
    before = energy(robot, drive)
    start = before
    for _ in range(50):
        drive.step(drive.position)
        now = energy(robot, drive)
        # The torques of motion are taken at a predicted midpoint: their error is of third order in 0.25 ms.
        assert now <= before + 1e-5 * start
        before = now
    assert before < start


@settings(max_examples=15)
@given(st.sampled_from(NAMES), st.integers(0, 2**32 - 1))
def test_without_friction_energy_stays(name: str, seed: int):
    robot = weightless(name)
    drive = swinging(robot, seed, friction=False)
    start = energy(robot, drive)
    for _ in range(50):
        drive.step(drive.position)
    # Second order: some (0.25 ms x a few rad/s)^2 over 2000 steps.
    np.testing.assert_allclose(energy(robot, drive), start, rtol=1e-4)


@settings(max_examples=15)
@given(st.sampled_from(NAMES), st.integers(0, 2**32 - 1), st.booleans())
def test_torques_stay_inside_their_limits_and_states_finite(name: str, seed: int, known: bool):  # noqa: FBT001
    """References that jump anywhere; the current control overshoots what is wanted, so it is ideal here."""
    robot = load_robot_model(name)
    axes, rng = robot.axes_data, np.random.default_rng(seed)
    n = robot.num_axes
    drives = replace(robot.drive_data, current_frequency=np.full(n, np.inf))
    drive = RigidBodyDrive(robot, robot.home, period=0.004, drives=drives, feed_forward=known)
    for _ in range(5):
        q_ref = rng.uniform(np.maximum(axes.lower, -3.0), np.minimum(axes.upper, 3.0))
        for _ in range(20):
            q, _ = drive.step(q_ref, rng.uniform(-1.0, 1.0, n) * axes.velocity)
            assert np.isfinite(q).all()
            assert (np.abs(drive.torque) <= drives.torque_limit * (1.0 + 1e-9)).all()
