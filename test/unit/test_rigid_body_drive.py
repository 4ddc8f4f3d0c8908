"""RigidBodyDrive: the machine of Modelica's example FullRobot, and machines that are hard to step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from full_robot import (
    ACCELERATION,
    DURATION,
    END,
    LOAD,
    SPEED,
    SWING_TIME,
    reference,
    simulate,
)
from scipy.integrate import solve_ivp

from robots_core import available_robot_models, load_robot_model
from robots_core.blocks.drives.rigid_body_drive import RigidBodyDrive
from robots_core.blocks.multibody.numerical_dynamics import NumericalDynamics
from robots_core.blocks.multibody.payload import Payload
from robots_core.blocks.multibody.tool_wrench import joint_torques
from robots_core.errors import InvalidInputError
from robots_core.robot_model.drive_data import DriveData
from robots_models.manutec_r3.model import ManutecR3
from robots_planning import LinearJoint

# github.com/modelica/MAP-LIB_ReferenceResults, FullRobot.csv: the time at which the example ends, half a
# second after its motion, and the currents with which its motors hold it at the start, A.
PUBLISHED_STOP = 1.8560450019
PUBLISHED_HOLDING = [0.0, -1.8880913, -3.6788347, -0.6004244, -0.7242793, 0.0]
# And the highest currents on the way, A, larger than the motors' 9 A, which the example does not enforce.
PUBLISHED_PEAK = [15.7968, 13.4130, 17.5251, 8.2288, 7.9719, 9.5320]
# Joint angles, rad, and currents, A, in the middle of the motion and where the example ends.
PUBLISHED = {
    0.61: (
        [-0.115083170, -0.351238896, 0.596266285, 0.349805286, -0.211557161, 0.349968767],
        [-0.144363436, -0.100879943, -0.889880114, -1.571054299, 0.000431398, -1.795862645],
    ),
    PUBLISHED_STOP: (
        [1.046822409, -1.223647247, -0.610908070, 0.784784108, 1.920234599, 0.785339123],
        [-0.340716510, 2.648168408, 2.115810311, 1.411835582, -1.424632077, -1.278482034],
    ),
}


def unlimited(drives: DriveData) -> DriveData:
    return replace(drives, torque_limit=np.full_like(drives.torque_limit, np.inf))


def test_the_motion_takes_as_long_as_published():
    # Printed with eleven digits; the example stops in the integration step after its condition is met.
    assert pytest.approx(PUBLISHED_STOP, abs=1e-8) == DURATION + SWING_TIME


def test_linear_joint_with_the_example_s_limits_takes_as_long():
    robot = load_robot_model('manutec_r3?joint_limits=full_robot_limits.yaml')
    axes = robot.axes_data
    np.testing.assert_array_equal(axes.velocity, SPEED)
    np.testing.assert_array_equal(axes.acceleration, ACCELERATION)
    trajectory = LinearJoint(robot).generate(robot.home, END)
    # Four ramps of acceleration at 1e6 rad/s^3, each drawn out to the shortest step of a trajectory, 5e-5 s.
    assert trajectory.duration + SWING_TIME == pytest.approx(PUBLISHED_STOP, abs=4 * 5e-5)
    np.testing.assert_array_equal(trajectory.position[-1], END)


def test_angles_and_currents_are_those_published():
    robot = ManutecR3()
    drive = RigidBodyDrive(
        robot, robot.home, period=0.25e-3, payload=LOAD, drives=unlimited(robot.drive_data)
    )
    per_ampere = robot.axes_data.gear_ratio * np.array(robot.DATA.torque_constant)
    np.testing.assert_allclose(drive.torque / per_ampere, PUBLISHED_HOLDING, atol=1e-6)
    time, q, tau = simulate(drive, 0.25e-3, PUBLISHED_STOP + 0.25e-3)
    # The library's solver kept a relative tolerance of 1e-6 of its states; the step of 0.25 ms misses the
    # peaks' instants by up to half of it while currents change by some 100 A/s.
    np.testing.assert_allclose(np.abs(tau / per_ampere).max(axis=0), PUBLISHED_PEAK, atol=0.03)
    for instant, (angles, currents) in PUBLISHED.items():
        for axis in range(6):
            # The error of the step of 0.25 ms, an order above the library's tolerance.
            assert np.interp(instant, time, q[:, axis]) == pytest.approx(angles[axis], abs=5e-6)
            ours = np.interp(instant, time, tau[:, axis]) / per_ampere[axis]
            assert ours == pytest.approx(currents[axis], abs=5e-3)


def test_the_step_converges_with_second_order_where_nothing_switches():
    robot = ManutecR3()

    def after(step: float) -> np.ndarray:
        drive = RigidBodyDrive(
            robot,
            robot.home,
            period=1e-3,
            drives=replace(unlimited(robot.drive_data), coulomb_friction=np.zeros(6)),
            longest_step=step,
        )
        return simulate(drive, 1e-3, 0.08)[1][-1]

    coarse, middle, fine = after(2e-4), after(1e-4), after(5e-5)
    ratio = np.abs(coarse - middle).max() / np.abs(middle - fine).max()
    assert 3.5 < ratio < 4.5  # 4 is second order


def integrated(
    robot: ManutecR3, drives: DriveData, load: Payload, end: float, times: np.ndarray
) -> np.ndarray:
    """Positions (m, n) of the same machine by scipy's BDF on the equations as written down by hand.

    The bodies are Pinocchio's, the friction is a steep ramp instead of a step.
    """
    n = robot.num_axes
    bodies = NumericalDynamics(robot, payload=load, friction=False, rotors=False)
    elastic = np.isfinite(drives.stiffness)
    stiffness = np.where(elastic, drives.stiffness, 0.0)
    w, D = drives.current_frequency, drives.current_damping

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        q, v, motor, motor_v, integral, tau, rate = y.reshape(7, n)
        motor, motor_v = np.where(elastic, motor, q), np.where(elastic, motor_v, v)
        q_ref, v_ref = reference(t)
        error = v_ref + drives.position_gain * (q_ref - motor) - motor_v
        wanted = drives.velocity_gain * (error + integral)
        friction = drives.coulomb_friction * np.tanh(motor_v / RAMP) + drives.viscous_friction * motor_v
        spring = stiffness * (motor - q) + drives.damping * (motor_v - v)
        M = bodies.mass_matrix(q) + np.diag(np.where(elastic, 0.0, drives.inertia))
        push = np.where(elastic, spring, tau - friction)
        a = np.linalg.solve(M, push - bodies.bias_torques(q, v))
        motor_a = np.where(elastic, (tau - friction - spring) / drives.inertia, a)
        return np.concatenate(
            [
                v,
                a,
                motor_v,
                motor_a,
                error / drives.integral_time,
                rate - 2.0 * D * w * tau - drives.back_emf * motor_v,
                w**2 * (wanted - tau),
            ]
        )

    weight = bodies.bias_torques(robot.home, np.zeros(n))
    motor = robot.home + np.where(elastic, weight / drives.stiffness, 0.0)
    integral = weight / drives.velocity_gain + drives.position_gain * (motor - robot.home)
    start = [robot.home, 0 * motor, motor, 0 * motor, integral, weight, 2.0 * D * w * weight]
    found = solve_ivp(
        rates, (0.0, end), np.concatenate(start), 'BDF', t_eval=times, rtol=1e-6, atol=1e-8, max_step=0.01
    )
    assert found.success
    return found.y[:n].T


RAMP = 1e-4  # rad/s


def test_the_motion_is_that_of_an_independent_integration():
    robot = ManutecR3()
    drives = unlimited(robot.drive_data)
    # The peak of stiction is a matter of standing axes; the steep ramp has none.
    drives = replace(drives, stiction=np.ones(6))
    end, period = 1.85, 0.25e-3
    drive = RigidBodyDrive(robot, robot.home, period=period, payload=LOAD, drives=drives)
    _, q, _ = simulate(drive, period, end)
    times = np.arange(0, q.shape[0], 20) * period
    # Creep along the ramp while held: half of RAMP at the worst; the step itself is good to 3e-6 rad.
    np.testing.assert_allclose(
        q[::20], integrated(robot, drives, LOAD, end, times), atol=0.5 * RAMP * end + 3e-6
    )


@pytest.mark.parametrize('name', available_robot_models())
def test_every_robot_stands_and_comes_to_its_target(name: str):
    robot = load_robot_model(name)
    drive = RigidBodyDrive(robot, robot.home, period=0.004)
    for _ in range(50):
        drive.step(robot.home)
    # The motors are controlled; behind an elastic gear the joint hangs by its twist.
    twist = np.abs(drive.joint_torque) / drive.drives.stiffness
    assert (np.abs(drive.position - robot.home) <= twist + 1e-6).all()
    target = robot.home + 0.02 * np.where(robot.home > 0.0, -1.0, 1.0)
    for s in np.linspace(0.0, 1.0, 100):
        drive.step(robot.home + (3 - 2 * s) * s**2 * (target - robot.home))
    for _ in range(500):
        drive.step(target)
    # What Coulomb friction holds of the position error falls with the integrator; the slowest robot, the
    # Manutec with its 5/s, has 2 s for it.
    np.testing.assert_allclose(drive.position, target, atol=2e-3)


def swing(drive: RigidBodyDrive, target: np.ndarray) -> float:
    """Move from rest to rest, smoothly; returns the largest error on the way."""
    start, period, worst = drive.position, 0.004, 0.0
    axes, way = drive.robot.axes_data, np.abs(target - drive.position)
    # A polynomial of fifth order, at half of each limit.
    time = max(
        2.0 * 1.875 * (way / axes.velocity).max(), np.sqrt(2.0 * 5.78 * (way / axes.acceleration).max())
    )
    steps = round(time / period)
    for s in np.arange(1, steps + 1) / steps:
        q = start + (10 - 15 * s + 6 * s**2) * s**3 * (target - start)
        q_dot = 30.0 * s**2 * (1.0 - s) ** 2 * (target - start) / time
        drive.step(q, q_dot)
        worst = max(worst, float(np.abs(drive.position - q).max()))
    return worst


@pytest.mark.parametrize('name', available_robot_models())
def test_controllers_with_the_model_settle_on_the_target(name: str):
    robot = load_robot_model(name)
    load = Payload(2.0, np.array([0.0, 0.0, 0.1]))
    drive = RigidBodyDrive(robot, robot.home, period=0.004, payload=load, feed_forward=True)
    for _ in range(50):
        drive.step(robot.home)
    np.testing.assert_allclose(drive.position, robot.home, atol=1e-9)
    axes = robot.axes_data
    for sign in (-1.0, 1.0, -0.3):
        target = np.clip(robot.home + 0.2 * sign, axes.lower, axes.upper)
        swing(drive, target)
        for _ in range(750):
            drive.step(target)
        # What a controller asks for before it says "reached", in the time that it allows: 1e-5 rad, 3 s.
        np.testing.assert_allclose(drive.position, target, atol=1e-5)


def test_feed_forward_takes_over_what_the_cascade_leaves():
    robot = ManutecR3()
    target = robot.home + 0.3
    errors = []
    for known in (False, True):
        drive = RigidBodyDrive(robot, robot.home, period=0.004, feed_forward=known)
        errors.append(swing(drive, target))
    assert errors[1] < 0.1 * errors[0]


def test_motors_keep_their_torque_limit_and_recover():
    robot = load_robot_model('kuka_kr210_r2700')
    drive = RigidBodyDrive(robot, robot.home, period=0.004)
    limit = robot.axes_data.effort
    step = robot.home + np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    worst = np.zeros(6)
    for _ in range(1000):
        drive.step(step, np.zeros(6))
        worst = np.maximum(worst, np.abs(drive.torque))
    assert (worst <= limit * (1.0 + 1e-12)).all()
    assert worst[0] == pytest.approx(limit[0])
    np.testing.assert_allclose(drive.position, step, atol=1e-4)


def test_an_axis_in_friction_stands_still_exactly():
    """Without any control, the brakes of friction alone hold the arm where they are strong enough."""
    robot = load_robot_model('kuka_kr210_r2700')
    weight = np.abs(robot.rigid_dynamics(robot.home, np.zeros(6), np.zeros(6))[2])
    loose = replace(robot.drive_data, velocity_gain=np.zeros(6), coulomb_friction=1.01 * weight + 1.0)
    drive = RigidBodyDrive(robot, robot.home, period=0.01, drives=loose)
    for _ in range(100):
        drive.step(robot.home)
    np.testing.assert_array_equal(drive.position, robot.home)
    np.testing.assert_array_equal(drive.velocity, np.zeros(6))
    slipping = replace(loose, coulomb_friction=0.5 * weight)
    drive = RigidBodyDrive(robot, robot.home, period=0.01, drives=slipping)
    for _ in range(20):
        drive.step(robot.home)
    assert np.abs(drive.velocity).max() > 0.01


def test_stiction_holds_more_than_sliding_friction():
    robot = load_robot_model('bello_bot?gravity=0,0,0')
    n = robot.num_axes
    data = replace(
        robot.drive_data,
        velocity_gain=np.ones(n),
        position_gain=np.zeros(n),
        integral_time=np.full(n, np.inf),
    )
    held = replace(data, coulomb_friction=np.full(n, 1.0), stiction=np.full(n, 2.0))
    one = np.eye(n)[0]
    for torque, moves in ((1.9, False), (2.1, True)):
        drive = RigidBodyDrive(robot, robot.home, period=0.01, drives=held)
        # With this control the torque is the reference's speed less the axis'.
        q_ref, v_ref = robot.home.copy(), 0.0
        for v in np.append(np.linspace(0.0, torque, 100), np.full(20, torque)):
            q_ref = q_ref + 0.5 * 0.01 * (v_ref + v) * one
            v_ref = v
            drive.step(q_ref, v * one)
        assert bool(np.abs(drive.velocity).max() > 0.0) is moves
    # 2.1 N m less 1 N m of sliding friction and 1 N m s/rad times the speed it comes to.
    assert 0.0 < drive.velocity[0] < 1.1


def test_absurd_gains_do_not_break_the_step():
    robot = load_robot_model('ur10e')
    wild = replace(
        robot.drive_data,
        velocity_gain=1e9 * np.ones(6),
        position_gain=1e5 * np.ones(6),
        stiffness=1e12 * np.ones(6),
        inertia=1e-3 * np.ones(6),
        coulomb_friction=1e3 * np.ones(6),
    )
    drive = RigidBodyDrive(robot, robot.home, period=0.004, drives=unlimited(wild))
    for _ in range(250):
        drive.step(robot.home + 0.01)
    np.testing.assert_allclose(drive.position, robot.home + 0.01, atol=1e-3)


def test_bad_input_is_named():
    robot = load_robot_model('bello_bot')
    with pytest.raises(InvalidInputError, match='period'):
        RigidBodyDrive(robot, robot.home, period=0.0)
    with pytest.raises(InvalidInputError, match=r'longest_step = 0\.01 s must be at most 0\.001 s'):
        RigidBodyDrive(robot, robot.home, period=0.01, longest_step=0.01)
    with pytest.raises(InvalidInputError, match='drives are for 6 axes, the robot has 7'):
        RigidBodyDrive(robot, robot.home, period=0.01, drives=ManutecR3().drive_data)
    drive = RigidBodyDrive(robot, robot.home, period=0.01)
    with pytest.raises(InvalidInputError, match='q_ref'):
        drive.step(np.full(7, np.nan))


@pytest.mark.parametrize('feed_forward', [True, False])
def test_what_is_picked_up_is_held(*, feed_forward: bool) -> None:
    robot = load_robot_model('kuka_kr210_r2700')
    q = np.array(robot.home)
    drive = RigidBodyDrive(robot, q, period=0.004, feed_forward=feed_forward)
    box = Payload(80.0, np.array([0.0, 0.0, 0.3]))
    for payload in (box, Payload(0.0)):
        drive.load(payload)
        for _ in range(1000):
            drive.step(q)
        held = NumericalDynamics(robot, payload=payload, rotors=False).bias_torques(q, np.zeros(6))
        # Friction holds the rest: no more than that is missing.
        friction = robot.drive_data.coulomb_friction + 1e-3 * np.abs(held)
        assert (np.abs(drive.joint_torque - held) <= 1e-3 * np.abs(held) + 1e-3).all()
        assert (np.abs(drive.torque - held) <= friction + 1e-3).all()


def test_drives_hold_against_a_wrench_on_the_tool():
    """In balance the motors give the weight less J^T f, with the Jacobian of Pinocchio."""
    robot = load_robot_model('kuka_kr210_r3100')
    q, still = np.array(robot.home), np.zeros(6)
    drive = RigidBodyDrive(robot, q, period=0.004, feed_forward=True)
    wrench = np.array([120.0, -80.0, 250.0, 15.0, 20.0, -10.0])  # in tool0
    for _ in range(1500):
        drive.push(joint_torques(robot, drive.position, wrench))
        drive.step(q, still)
    model = pin.buildModelFromXML(robot.description)
    data, tool = model.createData(), model.getFrameId('tool0')
    pressed = pin.computeFrameJacobian(model, data, q, tool, pin.LOCAL).T @ wrench
    assert np.abs(pressed).max() > 100.0
    weight = pin.computeGeneralizedGravity(model, data, q)
    np.testing.assert_allclose(drive.torque, weight - pressed, atol=1e-3 * np.abs(pressed).max())
    np.testing.assert_allclose(drive.position, q, atol=1e-6)
    with pytest.raises(InvalidInputError, match='wrench'):
        joint_torques(robot, q, np.full(6, np.nan))
    with pytest.raises(InvalidInputError, match='torque must have shape'):
        drive.push(np.zeros(5))
