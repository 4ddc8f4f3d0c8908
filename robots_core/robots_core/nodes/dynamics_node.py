"""dynamics_node: joint motion in, torques, mass matrix and the wrench at the tool out."""

from __future__ import annotations

from functools import partial
from typing import Any, Final

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import Vector3, WrenchStamped
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray
from trajectory_msgs.msg import JointTrajectory, MultiDOFJointTrajectory

from robots_core.base_frames import BASE_FRAME
from robots_core.blocks.multibody.acceleration_estimate import AccelerationEstimate
from robots_core.blocks.multibody.base_motion import BaseMotion
from robots_core.blocks.multibody.free_floating_dynamics import FreeFloatingDynamics
from robots_core.blocks.multibody.numerical_dynamics import NumericalDynamics
from robots_core.blocks.multibody.payload import CarriedPayload, Payload
from robots_core.blocks.multibody.torque_status import torque_status
from robots_core.errors import InvalidInputError
from robots_core.nodes.shared_parameters import carry_payload, payload_from_parameters
from robots_core.pose import Pose
from robots_core.ros.joint_trajectories import single_point
from robots_core.ros.messages import (
    BUILD,
    joint_motion,
    seconds,
)
from robots_core.ros.qos import make_publisher, subscribe
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.running.run import run
from robots_core.ros.streams.polled_subscription import PolledSubscription
from robots_core.status import Level
from robots_core.validation import Array, finite_vector, one_of

MAX_RATE = 1000.0  # Hz
SOURCES = ('joint_states', 'joint_reference')
UPRIGHT = [0.0, 0.0, 0.0, 1.0]
WORLD_FRAME = 'world'


class DynamicsNode(RobotNode):
    """Publishes the torques of the newest motion on `joint_torques`, `bias_torques` and `mass_matrix`.

    The motion is that of `joint_states` (accelerations from its velocities, by difference quotients and a
    low-pass filter) or of `joint_reference` (accelerations as given), by parameter `source`. Where
    joint_states has efforts, the torques of the drives, `tcp_wrench` is what the surroundings push the tool
    with. The node's health is WARN while a torque is past its limit.

    The base stands as parameter `base_orientation` says, until `base_motion` gives its motion; with
    `free_floating` nothing holds it. `base_wrench` is what the robot pushes its mount with, or the arm of a
    free-floating robot its base body.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__('dynamics_node', **options)
        self._source: str = self.parameter(
            'source', 'joint_states', f'{" or ".join(SOURCES)}', read=one_of('source', SOURCES)
        )
        rate = self.parameter('rate', 50.0, 'highest publishing rate, Hz', bounds=(0.1, MAX_RATE))
        filter_time = self.parameter(
            'filter_time',
            0.02,
            'time constant of the accelerations estimated from velocities, s',
            bounds=(0.0, 10.0),
        )
        self._estimate = AccelerationEstimate(filter_time)
        orientation = self.parameter(
            'base_orientation',
            UPRIGHT,
            'of the base in the world, quaternion x y z w',
            read=lambda quaternion: Pose.from_quaternion(np.zeros(3), quaternion).T,
        )
        self._floats: bool = self.parameter(
            'free_floating', False, 'nothing holds the base, as of a satellite: it moves as the arm pushes it'
        )
        self._base = BaseMotion(orientation)
        self._load(payload_from_parameters(self))
        carried = CarriedPayload(self._load)
        subscribe(self, DiagnosticStatus, 'motion_settings', partial(carry_payload, carried))
        if not self._floats:
            subscribe(self, MultiDOFJointTrajectory, 'base_motion', self._on_base_motion)
        self._names = list(self.robot.axes_data.names)
        self._motor_torques = make_publisher(self, JointState, 'joint_torques')
        self._bias_torques = make_publisher(self, JointState, 'bias_torques')
        self._mass_matrix = make_publisher(self, Float64MultiArray, 'mass_matrix')
        self._tool_wrench = make_publisher(self, WrenchStamped, 'tcp_wrench')
        self._base_wrench = make_publisher(self, WrenchStamped, 'base_wrench')
        kind = JointState if self._source == 'joint_states' else JointTrajectory
        self._motions = PolledSubscription(self, kind, self._source)
        self.create_timer(1.0 / rate, self._publish)
        self.on_change('filter_time', partial(setattr, self._estimate, 'filter_time'))
        self.on_change('payload', self._load)
        self.on_change('base_orientation', lambda turn: self._move_base(BaseMotion(turn)))
        self.ready()

    def _load(self, payload: Payload) -> None:
        self._dynamics: NumericalDynamics | FreeFloatingDynamics = (
            FreeFloatingDynamics(self.robot, payload=payload)
            if self._floats
            else NumericalDynamics(self.robot, payload=payload, base=self._base)
        )

    def _move_base(self, base: BaseMotion) -> None:
        self._base = base
        if not self._floats:
            self._dynamics.base = base

    def _on_base_motion(self, message: MultiDOFJointTrajectory) -> None:
        self._move_base(base_motion_from_message(message))

    def _publish(self) -> None:
        newest = None
        with self.refusing(self._source):
            for message, _ in self._motions.take_all():
                newest = (message, *self._motion(message))
            if newest is not None:
                self._publish_for(*newest)

    def _motion(self, message: Any) -> tuple[Array, Array, Array, Array | None]:
        """Positions, velocities, accelerations and, if there are any, efforts of a message, (n,) each."""
        if self._source == 'joint_states':
            q, q_dot, tau = joint_motion(message, self._names)
            q = finite_vector(q, q.size, 'positions')
            q_dot = np.zeros_like(q) if q_dot is None else finite_vector(q_dot, q.size, 'velocities')
            tau = None if tau is None else finite_vector(tau, q.size, 'efforts')
            return q, q_dot, self._estimate.take(seconds(message.header.stamp), q_dot), tau
        q, q_dot, q_ddot = single_point(message, self._names, self._source)
        return q, q_dot, q_ddot, None

    def _publish_for(
        self, message: Any, q: Array, q_dot: Array, q_ddot: Array, measured: Array | None
    ) -> None:
        tau, M, tau_aux = self._dynamics.rigid_dynamics(q, q_dot, q_ddot)
        stamp = message.header.stamp
        for publisher, torques in ((self._motor_torques, tau), (self._bias_torques, tau_aux)):
            publisher.publish(BUILD.joint_state(stamp, self._names, tau=torques))
        self._mass_matrix.publish(BUILD.matrix(M, 'torque', 'acceleration'))
        pushed = -self._dynamics.base_wrench(q, q_dot, q_ddot)
        self._base_wrench.publish(BUILD.wrench_stamped(stamp, pushed, BASE_FRAME))
        if measured is not None:
            wrench = self._dynamics.external_wrench(q, q_dot, q_ddot, measured)
            self._tool_wrench.publish(BUILD.wrench_stamped(stamp, wrench, BASE_FRAME))
        self._judge(tau if measured is None else measured)

    def _judge(self, tau: Array) -> None:
        status = torque_status(self.robot.axes_data, tau)
        if status.level is Level.OK:
            self.ready(status.text, **status.values)
        else:
            self.report_health(DiagnosticStatus.WARN, status.text, **status.values)


def base_motion_from_message(message: MultiDOFJointTrajectory) -> BaseMotion:
    """How the base moves: one joint, one point.

    The transform is that of the base in frame `world` (or none); its place has no effect. Velocity and
    acceleration are in base axes, the acceleration is without gravity; either may be left out at rest. What
    is linear in the velocity has no effect.

    Raises:
        InvalidInputError: another count, frame, or values that are not finite or no orientation.
    """
    if message.header.frame_id not in {'', WORLD_FRAME}:
        raise InvalidInputError(
            f'the base moves in frame {message.header.frame_id!r}; it must be {WORLD_FRAME!r}'
        )
    if len(message.points) != 1 or len(message.points[0].transforms) != 1:
        raise InvalidInputError('the motion of a base is one point with one transform')
    point = message.points[0]
    for name in ('velocities', 'accelerations'):
        if len(getattr(point, name)) > 1:
            raise InvalidInputError(f'{len(getattr(point, name))} {name} came; a base has one or none')
    o = point.transforms[0].rotation
    values = {}
    if point.velocities:
        values['angular_velocity'] = _vector(point.velocities[0].angular, 'angular velocity')
    if point.accelerations:
        values['acceleration'] = _vector(point.accelerations[0].linear, 'acceleration')
        values['angular_acceleration'] = _vector(point.accelerations[0].angular, 'angular acceleration')
    return BaseMotion(Pose.from_quaternion([0.0, 0.0, 0.0], [o.x, o.y, o.z, o.w]).T, **values)


def _vector(vector: Vector3, name: str) -> Array:
    return finite_vector([vector.x, vector.y, vector.z], 3, name)


main: Final = partial(run, DynamicsNode)
