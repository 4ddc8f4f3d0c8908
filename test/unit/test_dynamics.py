"""FunctionDynamics and NumericalDynamics against Pinocchio on the description, seen from the world."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from robots_core import BaseRobotModel, Pose, available_robot_models, load_robot_model
from robots_core.blocks.multibody.base_motion import BaseMotion
from robots_core.blocks.multibody.dynamics import Dynamics
from robots_core.blocks.multibody.function_dynamics import FunctionDynamics
from robots_core.blocks.multibody.numerical_dynamics import NumericalDynamics
from robots_core.blocks.multibody.payload import Payload
from robots_core.errors import InvalidInputError
from robots_core.orientation import rotation_from_vector

BLOCKS = (FunctionDynamics, NumericalDynamics)
LOAD = Payload(
    12.0, np.array([0.1, -0.2, 0.3]), np.array([[1.0, 0.1, 0.0], [0.1, 1.5, 0.2], [0.0, 0.2, 2.0]])
)
TILTED = rotation_from_vector(np.array([0.4, -1.1, 0.7]))
# Some hundred products each way; relative to the largest torque.
RELATIVE = 1e-11


class World:
    """The described robot on a floating base, its payload a body of its own, under the world's gravity."""

    def __init__(self, robot: BaseRobotModel, payload: Payload = LOAD) -> None:
        self.model = pin.buildModelFromXML(robot.description, pin.JointModelFreeFlyer())
        frame = self.model.frames[self.model.getFrameId('tool0')]
        load = pin.Inertia(payload.mass, payload.center, payload.inertia)
        self.model.appendBodyToJoint(frame.parentJoint, load, frame.placement)
        self.data = self.model.createData()
        joints = [self.model.joints[self.model.getJointId(name)] for name in robot.axes_data.names]
        assert all(joint.nq == 1 for joint in joints)
        self.at = [joint.idx_v for joint in joints]

    def wrench_and_torques(
        self, base: BaseMotion, q: np.ndarray, q_dot: np.ndarray, q_ddot: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Of a base that moves with some speed too, which must make no difference."""
        configuration = pin.neutral(self.model)
        configuration[:3] = [3.0, -2.0, 1.0]
        configuration[3:7] = Pose(np.zeros(3), base.T).quaternion()
        v, a = np.zeros(self.model.nv), np.zeros(self.model.nv)
        speed = np.array([0.3, -0.5, 0.7])
        v[:3], v[3:6] = speed, base.angular_velocity
        # Pinocchio's acceleration is spatial: that of the point is larger by omega x v.
        a[:3] = base.acceleration - np.cross(base.angular_velocity, speed)
        a[3:6] = base.angular_acceleration
        at = np.array(self.at)
        configuration[at + 1], v[at], a[at] = q, q_dot, q_ddot  # the base has seven numbers for six speeds
        full = pin.rnea(self.model, self.data, configuration, v, a)
        return full[:6], full[at]


def motions(robot: BaseRobotModel, count: int = 5) -> np.ndarray:
    return np.random.default_rng(8).uniform(-2.0, 2.0, (count, 3, robot.num_axes))


def close(mine: np.ndarray, expected: np.ndarray, relative: float = RELATIVE) -> None:
    np.testing.assert_allclose(mine, expected, rtol=0.0, atol=relative * np.abs(expected).max())


# Robots whose axes turn without end have two numbers for a joint in Pinocchio's model of their description.
PLAIN = [name for name in available_robot_models() if not load_robot_model(name).axes_data.continuous.any()]


@pytest.mark.parametrize('block', BLOCKS)
@pytest.mark.parametrize('name', PLAIN)
def test_payload_and_base_are_those_of_the_world(name: str, block: type[Dynamics]):
    robot = load_robot_model(name)
    world = World(robot)
    for base in (
        BaseMotion(),
        BaseMotion.wall(),
        BaseMotion.ceiling(),
        BaseMotion(TILTED, np.array([1.0, 2.0, -3.0])),
    ):
        dynamics = block(robot, payload=LOAD, base=base, friction=False, rotors=False)
        for q, q_dot, q_ddot in motions(robot):
            tau, M, tau_aux = dynamics.rigid_dynamics(q, q_dot, q_ddot)
            _, expected = world.wrench_and_torques(base, q, q_dot, q_ddot)
            close(tau, expected)
            close(M @ q_ddot + tau_aux, expected)
            np.testing.assert_allclose(M, M.T, atol=1e-12 * np.abs(M).max())


@pytest.mark.parametrize('name', PLAIN)
def test_a_base_may_move_in_any_way(name: str):
    robot = load_robot_model(name)
    world = World(robot)
    base = BaseMotion(
        TILTED, np.array([1.0, 2.0, -3.0]), np.array([0.5, -0.8, 1.1]), np.array([2.0, 1.0, -1.5])
    )
    dynamics = NumericalDynamics(robot, payload=LOAD, friction=False, rotors=False)
    dynamics.base = base
    for q, q_dot, q_ddot in motions(robot):
        wrench, expected = world.wrench_and_torques(base, q, q_dot, q_ddot)
        close(dynamics.torques(q, q_dot, q_ddot), expected)
        close(dynamics.base_wrench(q, q_dot, q_ddot), wrench)
        tau = dynamics.torques(q, q_dot, q_ddot)
        close(dynamics.accelerations(q, q_dot, tau), q_ddot, 1e-8)


def test_a_robot_at_rest_weighs_what_it_weighs():
    robot = load_robot_model('kuka_kr210_r2700')
    dynamics = NumericalDynamics(robot, payload=LOAD, base=BaseMotion.ceiling())
    wrench = dynamics.base_wrench(robot.home, np.zeros(6), np.zeros(6))
    weight = 9.81 * (robot.rigid_dynamics_model.masses.sum() + LOAD.mass)
    # Hanging: the mount pulls along the base's -z, which is up.
    np.testing.assert_allclose(wrench[:3], [0.0, 0.0, -weight], atol=1e-9 * weight)


@pytest.mark.parametrize('block', BLOCKS)
def test_friction_and_rotors_are_those_of_the_axes(block: type[Dynamics]):
    robot = load_robot_model('manutec_r3')
    axes = robot.axes_data
    bare, full = block(robot, friction=False, rotors=False), block(robot)
    for q, q_dot, q_ddot in motions(robot):
        tau, M, tau_aux = full.rigid_dynamics(q, q_dot, q_ddot)
        bare_tau, bare_M, bare_aux = bare.rigid_dynamics(q, q_dot, q_ddot)
        close(M - bare_M, np.diag(axes.gear_ratio**2 * axes.rotor_inertia))
        friction = axes.coulomb_friction * np.sign(q_dot) + axes.viscous_friction * q_dot
        close(tau_aux - bare_aux, friction, 1e-10)
        close(tau, bare_tau + axes.gear_ratio**2 * axes.rotor_inertia * q_ddot + friction)
        close(full.torques(q, q_dot, q_ddot), tau)
        close(full.mass_matrix(q), M)
        close(full.bias_torques(q, q_dot), tau_aux)


@pytest.mark.parametrize('block', BLOCKS)
@pytest.mark.parametrize('name', available_robot_models())
def test_forward_dynamics_undo_inverse_dynamics(name: str, block: type[Dynamics]):
    robot = load_robot_model(name)
    dynamics = block(robot, payload=LOAD)
    for q, q_dot, q_ddot in motions(robot):
        found = dynamics.accelerations(q, q_dot, dynamics.torques(q, q_dot, q_ddot))
        # Mass matrices of arms have condition numbers of up to some 1e5.
        close(found, q_ddot, 1e-9)


@pytest.mark.parametrize('block', BLOCKS)
def test_an_axis_at_rest_stands_until_its_friction_is_overcome(block: type[Dynamics]):
    robot = load_robot_model('manutec_r3')
    dynamics = block(robot)
    still = np.zeros(6)
    hold = robot.axes_data.coulomb_friction
    weight = dynamics.bias_torques(robot.home, still)
    np.testing.assert_array_equal(dynamics.accelerations(robot.home, still, weight + 0.9 * hold), still)
    pushed = weight + 0.9 * hold
    pushed[3] = weight[3] + 2.0 * hold[3]
    q_ddot = dynamics.accelerations(robot.home, still, pushed)
    assert q_ddot[3] > 0.0
    # Newton for the axes that slip; friction within its bound for those that stand.
    rest = pushed - weight - dynamics.mass_matrix(robot.home) @ q_ddot
    assert (np.abs(rest) <= hold * (1.0 + 1e-9)).all()
    slips = q_ddot != 0.0
    np.testing.assert_allclose(rest[slips], hold[slips] * np.sign(q_ddot[slips]), rtol=1e-9)


@pytest.mark.parametrize('block', BLOCKS)
def test_the_wrench_at_the_tool_is_found_again(block: type[Dynamics]):
    robot = load_robot_model('bello_bot')
    dynamics = block(robot, payload=LOAD)
    wrench = np.array([30.0, -20.0, 50.0, 3.0, 2.0, -4.0])
    q, q_dot, q_ddot = motions(robot, 1)[0]
    tau = dynamics.torques(q, q_dot, q_ddot) - robot.jacobian(q).T @ wrench
    np.testing.assert_allclose(dynamics.external_wrench(q, q_dot, q_ddot, tau), wrench, atol=1e-9)


def test_gravity_is_the_robots_own():
    robot = load_robot_model('debris_arm?gravity=0,0,0')
    q, q_dot, q_ddot = motions(robot, 1)[0]
    for block in BLOCKS:
        dynamics = block(robot, payload=LOAD, base=BaseMotion.wall())
        np.testing.assert_allclose(dynamics.bias_torques(q, np.zeros(3)), 0.0, atol=1e-9)
        upright = block(robot, payload=LOAD).torques(q, q_dot, q_ddot)
        close(dynamics.torques(q, q_dot, q_ddot), upright)


def test_function_dynamics_keep_what_only_the_robot_computes(monkeypatch: pytest.MonkeyPatch):
    robot = load_robot_model('cello_bot')
    own = robot.rigid_dynamics

    def with_spring(q: np.ndarray, q_dot: np.ndarray, q_ddot: np.ndarray) -> tuple[Any, ...]:
        tau, M, tau_aux = own(q, q_dot, q_ddot)
        return tau + 7.0 * q, M, tau_aux + 7.0 * q

    monkeypatch.setattr(robot, 'rigid_dynamics', with_spring)
    q, q_dot, q_ddot = motions(robot, 1)[0]
    rigid = FunctionDynamics(robot, friction=False, rotors=False)
    close(rigid.torques(q, q_dot, q_ddot), own(q, q_dot, q_ddot)[0] + 7.0 * q)
    for refused in (lambda: NumericalDynamics(robot), lambda: FunctionDynamics(robot, payload=LOAD)):
        with pytest.raises(InvalidInputError, match="'cello_bot' are not those of the masses"):
            refused()


@pytest.mark.parametrize('friction', [True, False])
@pytest.mark.parametrize('block', BLOCKS)
def test_results_belong_to_the_caller(block: type[Dynamics], friction: bool):  # noqa: FBT001
    dynamics = block(load_robot_model('bello_bot'), payload=LOAD, friction=friction)
    first, second = np.random.default_rng(8).uniform(-1.0, 1.0, (2, 3, 7))

    def everything(q: np.ndarray, q_dot: np.ndarray, q_ddot: np.ndarray) -> list[np.ndarray]:
        return [
            *dynamics.rigid_dynamics(q, q_dot, q_ddot),
            dynamics.torques(q, q_dot, q_ddot),
            dynamics.mass_matrix(q),
            dynamics.bias_torques(q, q_dot),
            dynamics.accelerations(q, q_dot, q_ddot),
        ]

    kept = everything(*first)
    copies = [array.copy() for array in kept]
    for array in everything(*second):
        array[...] = np.nan
    for mine, copy, again in zip(kept, copies, everything(*first), strict=True):
        np.testing.assert_array_equal(mine, copy)
        np.testing.assert_array_equal(again, copy)


@pytest.mark.parametrize('index', [0, 1, 2])
@pytest.mark.parametrize('friction', [True, False])
@pytest.mark.parametrize('block', BLOCKS)
def test_what_is_no_motion_is_refused_by_name(block: type[Dynamics], friction: bool, index: int):  # noqa: FBT001
    dynamics = block(load_robot_model('bello_bot'), friction=friction)
    name = ('q', 'q_dot', 'q_ddot')[index]
    for axis in range(7):
        for value in (np.nan, np.inf, -np.inf):
            motion = np.full((3, 7), 0.3)
            motion[index, axis] = value
            for call in (dynamics.torques, dynamics.accelerations, dynamics.rigid_dynamics):
                with pytest.raises(InvalidInputError, match=rf'^{name}\[{axis}\] is'):
                    call(*motion)
    for bad in (np.zeros(6), np.zeros((7, 1)), np.zeros((1, 7)), np.zeros(7) + 1j, 'left', None):
        motion = [np.full(7, 0.3)] * 3
        motion[index] = bad
        for call in (dynamics.torques, dynamics.accelerations, dynamics.rigid_dynamics):
            with pytest.raises(InvalidInputError, match=rf'^{name} must'):
                call(*motion)


@pytest.mark.parametrize('block', BLOCKS)
def test_motions_of_any_layout_are_the_same(block: type[Dynamics]):
    dynamics = block(load_robot_model('bello_bot'), friction=False)
    motion = np.random.default_rng(9).uniform(-1.0, 1.0, (3, 7))
    for call in (dynamics.torques, dynamics.accelerations):
        expected = call(*motion)
        for same in (np.repeat(motion, 2, axis=1)[:, ::2], motion.tolist(), motion.astype('>f8')):
            np.testing.assert_array_equal(call(*same), expected)


def test_bad_input_is_named():
    robot = load_robot_model('bello_bot')
    turning = BaseMotion(angular_velocity=np.array([0.0, 0.0, 1.0]))
    with pytest.raises(InvalidInputError, match='use NumericalDynamics'):
        FunctionDynamics(robot, base=turning)
    dynamics = FunctionDynamics(robot)
    with pytest.raises(InvalidInputError, match='use NumericalDynamics'):
        dynamics.base = turning
    for block in BLOCKS:
        for bad in (np.zeros(6), np.full(7, np.nan)):
            with pytest.raises(InvalidInputError):
                block(robot).accelerations(bad, np.zeros(7), np.zeros(7))
            with pytest.raises(InvalidInputError):
                block(robot).torques(np.zeros(7), np.zeros(7), bad)
            with pytest.raises(InvalidInputError):
                block(robot).external_wrench(np.zeros(7), np.zeros(7), np.zeros(7), bad)
