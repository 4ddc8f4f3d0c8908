"""PendantLink: the operator's page as topics and services of the cell."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

import numpy as np
from geometry_msgs.msg import TwistStamped
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64
from std_srvs.srv import SetBool

from robots_controller.cell.ports import Configured
from robots_controller.client.program_client import set_parameters
from robots_controller.io.io_image import Channel
from robots_controller.nodes.ports.commanded_motions import CANCEL, commanded_motions
from robots_controller.nodes.ports.program.planner_client import PlannerClient
from robots_controller.nodes.ports.program_link import ProgramLink
from robots_controller.pendant.jog.jog_command import JogFrame
from robots_controller.pendant.jog.pendant_move import PendantMove
from robots_controller.pendant.motion_recording import MeasuredMotion
from robots_core.errors import InvalidInputError
from robots_core.ros.messages import BUILD, joint_motion, seconds
from robots_core.ros.qos import make_publisher
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.streams.polled_subscription import PolledSubscription
from robots_core.validation import Array
from robots_planning.motion_settings import PENDANT, PENDANT_SETTINGS
from robots_planning.nodes.controller_reference import ControllerReference

PATIENCE: Final = 10.0  # s
STOPS: Final = ('lua_program_node/stop', 'controller_node/stop')
TAKE: Final = 'controller_node/commander/pendant'
WATCH_PERIOD: Final = 0.1  # s


class PendantPlanner(PlannerClient):
    """A planner with settings for motions of the pendant alone; those of programs are not touched."""

    def differs(self, settings: Mapping[str, object]) -> bool:
        """See `PlannerPort`."""
        return super().differs(_of_pendant(settings))

    def configure(self, settings: Mapping[str, object], done: Configured, *, moving: bool) -> None:
        """See `PlannerPort`."""
        super().configure(_of_pendant(settings), done, moving=moving)


def _of_pendant(settings: Mapping[str, object]) -> dict[str, object]:
    return {f'{PENDANT}{name}': settings[name] for name in PENDANT_SETTINGS}


class PendantLink(ProgramLink):
    """See `PendantPort` and, for its motions, `MovePort`; safe from any thread but the node's own."""

    def __init__(self, node: RobotNode) -> None:
        super().__init__(node, PATIENCE)
        self._node = node
        self._names = list(node.robot.axes_data.names)
        self._twists = make_publisher(node, TwistStamped, 'teach_twist')
        self._joints = make_publisher(node, JointState, 'teach_joints')
        self._holds = make_publisher(node, Bool, 'hold_to_run')
        self._overrides = make_publisher(node, Float64, 'override')
        self._services.prepare((*STOPS, CANCEL))
        self._services.prepare([TAKE], SetBool)
        move = PendantMove(self, node.now)
        self.begin_move, self.end_move = move.begin, move.end
        planner = PendantPlanner(node, node.robot.axes_data.names)
        motions = commanded_motions(
            self._services, planner, lambda _id, command, error: move.ended(command, error)
        )
        self.send, self.cancel = motions.send, motions.cancel

        def watch() -> None:
            motions.watch()
            move.check()

        node.create_timer(WATCH_PERIOD, watch)
        self._ghosts = make_publisher(node, JointState, 'ghost')
        self._reference = ControllerReference(node)
        self._feedback = PolledSubscription(node, JointState, 'joint_states')

    def take(self, answered: Callable[[str], None]) -> None:
        """See `MovePort`."""
        request = SetBool.Request(data=True)
        self._services.send(
            TAKE, SetBool, request, lambda answer: answered('' if answer.success else answer.message)
        )

    def give_back(self) -> None:
        """See `MovePort`."""
        self._services.send(TAKE, SetBool, SetBool.Request(data=False))

    def jog_axes(self, velocity: Array) -> None:
        """See `JogPort`."""
        stamp = self._node.get_clock().now().to_msg()
        self._joints.publish(BUILD.joint_state(stamp, self._names, q_dot=velocity))

    def jog_tool(self, twist: Array, frame: JogFrame) -> None:
        """See `JogPort`."""
        stamp = self._node.get_clock().now().to_msg()
        self._twists.publish(BUILD.twist_stamped(stamp, np.asarray(twist), frame))

    def hold_run(self, *, held: bool) -> None:
        """See `JogPort`."""
        self._holds.publish(Bool(data=held))

    def reference(self) -> Array | None:
        """See `JogPort`."""
        newest = self._reference.newest()
        return None if newest is None else newest[0]

    def feedback(self) -> MeasuredMotion | None:
        """See `PendantPort`."""
        message = self._feedback.take()
        if message is None:
            return None
        try:
            q, _, tau = joint_motion(message, self._names)
        except InvalidInputError:
            return None
        return None if tau is None else MeasuredMotion(seconds(message.header.stamp), q, tau)

    def show_ghost(self, q: Array | None) -> None:
        """See `PendantPort`; without positions the ghost is gone."""
        self._ghosts.publish(JointState() if q is None else BUILD.joint_state(0, self._names, q))

    def set_override(self, value: float) -> None:
        """See `PendantPort`."""
        self._overrides.publish(Float64(data=float(value)))

    def stop(self) -> None:
        """See `PendantPort`; both nodes are asked, whatever else does not answer."""
        for service in STOPS:
            self._services.send(service)

    def set_parameters(self, node: str, **values: object) -> None:
        """See `PendantPort`."""
        set_parameters(self._services, node, **values)

    def force(self, channel: Channel, value: float | None) -> None:
        """See `PendantPort`."""
        if value is None:
            self._io.release(channel.name)
        else:
            self._io.force(channel.name, bool(value) if channel.kind == 'digital' else float(value))
