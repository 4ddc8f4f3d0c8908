"""TumblingBody and FloatingBase, against closed forms, Pinocchio and the same robot driven by torques."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from scipy.special import ellipj

from robots_core import Pose, load_robot_model
from robots_core.blocks.drives.rigid_body_drive import RigidBodyDrive
from robots_core.blocks.floating_base.floating_base import FloatingBase
from robots_core.blocks.floating_base.tumbling_body import TumblingBody
from robots_core.blocks.multibody.free_floating import FreeFloatingRobot
from robots_core.blocks.multibody.payload import Payload
from robots_core.errors import InvalidInputError

ROBOT = load_robot_model('debris_arm?gravity=0,0,0')
TWIST = [0.01, 0.02, 0.0, 0.02, -0.01, 0.03]
PERIOD = 0.004  # s


def test_a_body_tumbles_as_the_elliptic_functions_say():
    """Euler's equations about the body's axes (Landau and Lifshitz, Mechanics, paragraph 37)."""
    i1, i2, i3 = inertia = np.array([30.0, 60.0, 75.0])
    start = np.array([0.3, 0.0, 0.9])
    body = TumblingBody(Payload(200.0, inertia=np.diag(inertia)), Pose.identity(), angular_velocity=start)
    energy, square = inertia @ start**2, np.sum((inertia * start) ** 2)  # twice E, and M^2
    assert square > energy * i2
    rate = np.sqrt((i3 - i2) * (square - energy * i1) / (i1 * i2 * i3))
    m = (i2 - i1) * (energy * i3 - square) / ((i3 - i2) * (square - energy * i1))
    for k in range(1, 61):
        body.step(0.1)
        sn, cn, dn, _ = ellipj(0.1 * k * rate, m)
        w1 = np.sqrt((energy * i3 - square) / (i1 * (i3 - i1))) * cn
        w2 = np.sqrt((energy * i3 - square) / (i2 * (i3 - i2))) * sn
        w3 = np.sqrt((square - energy * i1) / (i3 * (i3 - i1))) * dn
        np.testing.assert_allclose(body.pose.T.T @ body.angular_velocity, [w1, w2, w3], atol=1e-9)


@settings(max_examples=10)
@given(st.lists(st.floats(-0.5, 0.5), min_size=6, max_size=6), st.floats(0.0, 0.5))
def test_momentum_and_energy_of_a_body_are_constant(motion: list[float], away: float):
    load = Payload(200.0, np.array([away, 0.1, -0.2]), np.diag([30.0, 60.0, 75.0]))
    body = TumblingBody(
        load, Pose(np.array([1.0, 2.0, 3.0]), np.eye(3)), velocity=motion[:3], angular_velocity=motion[3:]
    )
    momentum, center = body.momentum, body.center_of_mass
    omega = body.angular_velocity
    energy = omega @ load.inertia @ omega
    body.step(1.0)
    np.testing.assert_allclose(body.momentum, momentum, atol=1e-10)
    np.testing.assert_allclose(body.center_of_mass, center + np.array(motion[:3]), atol=1e-12)
    omega = body.pose.T.T @ body.angular_velocity
    assert omega @ load.inertia @ omega == pytest.approx(energy, abs=1e-9)


def swing(t: float) -> tuple[np.ndarray, np.ndarray]:
    """A motion of the joints, from rest."""
    wave = np.array([0.7, 0.5, 0.9])
    size = np.array([0.8, 0.5, 0.6])
    return ROBOT.home + size * (1.0 - np.cos(wave * t)), size * wave * np.sin(wave * t)


def test_it_moves_as_the_robot_that_torques_drive():
    """Forward dynamics on Pinocchio's free-flyer, whose joint motion is handed on."""
    load = Payload(5.0, np.array([0.0, 0.0, 0.2]), np.diag([0.2, 0.3, 0.1]))
    driven = FreeFloatingRobot(ROBOT, ROBOT.home, twist=TWIST, payload=load)
    base = FloatingBase(ROBOT, ROBOT.home, twist=TWIST, payload=load)
    for k in range(250):
        q, q_dot = swing(PERIOD * k)
        tau = np.array([60.0, 90.0, 40.0]) * (q - driven.position) + 60.0 * (q_dot - driven.velocity)
        base.step(*driven.step(tau, PERIOD), PERIOD)
        if k > 0:
            np.testing.assert_allclose(
                base.torque, tau, atol=0.05
            )  # of the acceleration half a period before
    for found, expected in zip(base.pose.distance_to(driven.base_pose), (0.0, 0.0), strict=True):
        assert found == pytest.approx(expected, abs=1e-9)
    np.testing.assert_allclose(base.twist, driven.base_twist, atol=1e-10)


def test_momentum_stays_whatever_joints_and_wheels_do():
    base = FloatingBase(ROBOT, ROBOT.home, twist=TWIST)
    start = base.momentum
    for k in range(150):
        base.step(*swing(0.02 * (k + 1)), 0.02, 3.0 * np.sin([0.1 * k, 0.13 * k, 0.16 * k]))
    np.testing.assert_allclose(base.momentum, start, atol=1e-10)
    assert np.linalg.norm(base.wheel_momentum) > 0.1
    base.stop_joints()
    np.testing.assert_allclose(base.momentum, start, atol=1e-10)


def test_wheels_turn_the_base_as_euler_says():
    """With the joints at rest it is one rigid body with wheels: I w' = -u - w x (I w + h)."""
    base = FloatingBase(ROBOT, ROBOT.home, twist=[0.0, 0.0, 0.0, 0.1, -0.2, 0.15])
    inertia, torque = base.inertia, np.array([0.5, -0.3, 0.2])
    omega, h = np.array([0.1, -0.2, 0.15]), np.zeros(3)
    steps, dt = 300, 0.01

    def rate(w: np.ndarray, t: float) -> np.ndarray:
        return np.linalg.solve(inertia, -torque - np.cross(w, inertia @ w + h + t * torque))

    for k in range(steps):
        t = k * dt
        k1 = rate(omega, t)
        k2 = rate(omega + 0.5 * dt * k1, t + 0.5 * dt)
        k3 = rate(omega + 0.5 * dt * k2, t + 0.5 * dt)
        k4 = rate(omega + dt * k3, t + dt)
        omega = omega + dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    base.step(ROBOT.home, np.zeros(3), steps * dt, torque)
    np.testing.assert_allclose(base.twist[3:], omega, atol=1e-9)
    np.testing.assert_allclose(base.wheel_momentum, steps * dt * torque)


def test_what_it_takes_brings_its_momentum_along():
    """Against the impact law: M dv = -J^T f with joints that keep their speed, and f on the body."""
    base = FloatingBase(ROBOT, ROBOT.home, twist=TWIST)
    base.step(*swing(PERIOD), PERIOD)
    q, q_dot = swing(2 * PERIOD)
    base.step(q, q_dot, PERIOD)
    tool, before = base.tool
    held = Pose(np.array([0.1, 0.2, 0.9]), Rotation.from_rotvec([0.3, 0.2, 0.1]).as_matrix())
    body = Payload(220.0, np.array([0.1, 0.0, 0.0]), np.diag([30.0, 60.0, 75.0]))
    target = TumblingBody(
        body, tool @ held, velocity=[0.02, -0.01, 0.03], angular_velocity=[0.04, 0.02, 0.01]
    )
    loose, caught = base.momentum, target.momentum
    place, twist = base.pose, base.twist
    base.take(body.seen_from(held), caught)
    np.testing.assert_allclose(base.momentum, loose + caught, atol=1e-10)
    np.testing.assert_allclose(base.tool[0].r, tool.r, atol=1e-14)
    # Impulse (6,) about the tool's point, from the change of the target's motion alone.
    moved, after = base.tool
    point = target.center_of_mass
    linear = body.mass * (after[:3] + np.cross(after[3:], point - moved.r)) - caught[:3]
    turn = target.pose.T @ body.inertia @ target.pose.T.T
    spin = turn @ (after[3:] - target.angular_velocity)
    impulse = np.concatenate([linear, spin + np.cross(point - moved.r, linear)])
    # The base with its locked arm gets the opposite, as the spatial inertia of Pinocchio's composite says.
    free = FreeFloatingRobot(ROBOT, q)
    data = free.model.createData()
    M = pin.crba(free.model, data, np.concatenate([np.zeros(6), [1.0], q]))[:6, :6]
    arm = place.T.T @ (tool.r - place.r)
    push = np.concatenate([place.T.T @ impulse[:3], place.T.T @ impulse[3:]])
    push[3:] += np.cross(arm, push[:3])
    np.testing.assert_allclose(M @ (base.twist - twist), -push, atol=1e-9)
    assert np.linalg.norm(after - before) > 1e-3


def test_bad_input_is_named():
    with pytest.raises(InvalidInputError, match=r'gravity \[0.0, 0.0, -9.81\] .* debris_arm\?gravity=0,0,0'):
        FloatingBase(load_robot_model('debris_arm'), ROBOT.home)
    with pytest.raises(InvalidInputError, match='has no mass or no inertia'):
        FloatingBase(load_robot_model('manutec_r3?gravity=0,0,0'), np.zeros(6))
    base = FloatingBase(ROBOT, ROBOT.home)
    with pytest.raises(InvalidInputError, match='q_dot'):
        base.step(ROBOT.home, [0.0, np.nan, 0.0], PERIOD)
    with pytest.raises(InvalidInputError, match='period'):
        base.step(ROBOT.home, np.zeros(3), 0.0)
    with pytest.raises(InvalidInputError, match='wheel_torque'):
        base.step(ROBOT.home, np.zeros(3), PERIOD, np.zeros(2))
    with pytest.raises(InvalidInputError, match='three moments of inertia above 0'):
        TumblingBody(Payload(10.0), Pose.identity())


@pytest.mark.parametrize('rotors', [None, [0.0, 0.0, 0.0], [5.0, 5.0, 2.5]])
def test_an_impact_reaches_the_joints(rotors: list[float] | None):
    """The impulse between two bodies that a rigid grasp joins, by matrices of Pinocchio's free-flyer."""
    base = FloatingBase(ROBOT, ROBOT.home, twist=TWIST)
    base.step(*swing(PERIOD), PERIOD)
    q, q_dot = swing(2 * PERIOD)
    base.step(q, q_dot, PERIOD)
    place, (tool, _) = base.pose, base.tool
    held = Pose(np.array([0.1, 0.2, 0.9]), Rotation.from_rotvec([0.3, 0.2, 0.1]).as_matrix())
    body = Payload(220.0, np.array([0.1, 0.0, 0.0]), np.diag([30.0, 60.0, 75.0]))
    motion = {'velocity': [0.02, -0.01, 0.03], 'angular_velocity': [0.04, 0.02, 0.01]}
    target = TumblingBody(body, tool @ held, **motion)
    model = FreeFloatingRobot(ROBOT, q).model
    data = model.createData()
    configuration = np.concatenate([place.r, place.quaternion(), q])
    M = pin.crba(model, data, configuration) + np.diag([*np.zeros(6), *(rotors or np.zeros(3))])
    J = pin.computeFrameJacobian(
        model, data, configuration, model.getFrameId('tool0'), pin.LOCAL_WORLD_ALIGNED
    )
    arm = pin.skew(target.center_of_mass - tool.r)  # of the target, seen from the tool, world axes
    turned = target.pose.T @ body.inertia @ target.pose.T.T
    m = body.mass
    inertia = np.block([[m * np.eye(3), -m * arm], [m * arm, turned - m * arm @ arm]])
    there = np.concatenate([target.velocity_at(tool.r), target.angular_velocity])
    v = np.concatenate([base.twist, q_dot])
    free = slice(None) if rotors is not None else slice(0, 6)  # coordinates that the impulse may change
    moved = np.zeros((9, 6))
    moved[free] = np.linalg.solve(M[free, free], J[:, free].T)  # by an impulse on the tool
    impulse = np.linalg.solve(J @ moved + np.linalg.inv(inertia), there - J @ v)
    after = v + moved @ impulse
    payload, brought, start = body.seen_from(held), target.momentum, base.momentum
    held_up = base.impulse(payload, brought)
    base.take(payload, brought, impact_inertia=rotors)
    np.testing.assert_allclose(base.twist, after[:6], atol=1e-12)
    np.testing.assert_allclose(base.joint_velocity, after[6:], atol=1e-12)
    np.testing.assert_allclose(base.momentum, start + brought, atol=1e-10)
    if rotors is None:
        np.testing.assert_allclose(held_up, (M @ (after - v) - J.T @ impulse)[6:], atol=1e-11)
        assert np.abs(held_up).max() > 1.0
    else:
        assert np.abs(after[6:] - q_dot).max() > 1e-3


def test_rigid_body_drives_move_it_as_their_torques_move_pinocchio_s_free_flyer():
    base = FloatingBase(ROBOT, ROBOT.home, twist=TWIST)
    period, start = 1e-3, base.momentum
    drive = RigidBodyDrive(ROBOT, ROBOT.home, period=period, base=base, longest_step=period)
    driven = FreeFloatingRobot(ROBOT, ROBOT.home, twist=TWIST)
    for k in range(1, 401):
        q, q_dot = drive.step(*swing(k * period))
        base.step(q, q_dot, period)
        driven.step(drive.joint_torque, period)
    assert np.abs(q - ROBOT.home).max() > 0.02
    np.testing.assert_allclose(driven.position, q, atol=1e-5)
    np.testing.assert_allclose(driven.velocity, q_dot, atol=1e-4)
    np.testing.assert_allclose(driven.base_twist, base.twist, atol=1e-5)
    np.testing.assert_allclose(base.momentum, start, atol=1e-9)
