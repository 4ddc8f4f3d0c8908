"""JogStream: the messages of `Jogging` in planning_node."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import TwistStamped
from sensor_msgs.msg import JointState

from robots_core.cell_interface.operating_modes import Commander
from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.lockstep.timed_work import Loop
from robots_core.ros.messages import NANOSECONDS, joint_values, nanoseconds
from robots_core.ros.peers.commander_watch import CommanderWatch
from robots_core.ros.qos import subscribe
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.streams.serialized_streams import ReferenceStream
from robots_core.validation import Array
from robots_planning.guidance.jog_axes import jog_axes
from robots_planning.guidance.jogging import Jogging
from robots_planning.guidance.teach_box import JOG_RATE
from robots_planning.nodes.controller_reference import ControllerReference


class JogStream:
    """Takes `teach_twist` and `teach_joints`, and streams one-point `joint_trajectory` meanwhile.

    Args:
        node: Owner.
        reference: Of the controller.
        standing: Where it stands, (n,); raises a PlanningError if it does not.
        busy: A motion is planned or runs: no jogging.
        commanders: Says whether a person may jog.
    """

    def __init__(
        self,
        node: RobotNode,
        reference: ControllerReference,
        *,
        standing: Callable[[], Array],
        busy: Callable[[], bool],
        commanders: CommanderWatch,
    ) -> None:
        self._node, self._commanders = node, commanders
        speed = node.parameter(
            'teach_speed', 0.1, 'part of the velocity limits to jog with', bounds=(0.001, 1.0)
        )
        tool_speed = node.parameter(
            'teach_tool_speed', 0.25, 'highest speed of a jogged tool, m/s', bounds=(0.001, 2.0)
        )
        timeout = node.parameter(
            'teach_timeout', 0.1, 'a jog command older than this is stale, s', bounds=(0.02, 1.0)
        )
        self._names = list(node.robot.axes_data.names)
        self._controller = reference
        self._newest: tuple[Array, Array] | None = None  # that the jogging has got
        self.jogging = Jogging(
            node.robot,
            standing=standing,
            busy=busy,
            reference=self._reference,
            speed_fraction=speed,
            tool_speed=tool_speed,
            timeout=timeout,
        )
        self._loop: Loop | None = None
        self._limits: tuple[str, ...] = ()
        self._stream: ReferenceStream | None = None
        subscribe(node, TwistStamped, 'teach_twist', self._on_twist)
        subscribe(node, JointState, 'teach_joints', self._on_joints)

    # -- the executor's thread -----------------------------------------------------------------------

    def _on_twist(self, message: TwistStamped) -> None:
        v, w = message.twist.linear, message.twist.angular
        twist = [v.x, v.y, v.z, w.x, w.y, w.z]
        self._jog(message, partial(self.jogging.jog_tool, twist, jog_axes(message.header.frame_id)))

    def _on_joints(self, message: JointState) -> None:
        velocity = joint_values(message.name, message.velocity, self._names, 'teach_joints')
        self._jog(message, partial(self.jogging.jog_axes, velocity))

    def _jog(self, message: Any, jog: Callable[[float, float], bool]) -> None:
        """Give a command, with its age by the stamp and the time in s; a first one starts the loop."""
        self._commanders.check(Commander.PENDANT)
        sent = nanoseconds(message.header.stamp)
        age = (self._node.get_clock().now().nanoseconds - sent) / NANOSECONDS if sent else 0.0
        if not jog(age, self._node.now()):
            return
        if self._stream is None:
            self._stream = ReferenceStream(
                self._node, 'joint_trajectory', self._names, time_from_start=1.0 / JOG_RATE
            )
        self._loop = self._node.start_loop(
            self._step, period=1.0 / JOG_RATE, name='jogging', phase=Phase.GUIDANCE
        )

    # -- the loop's thread ---------------------------------------------------------------------------

    def _step(self, now: float) -> None:
        step = self.jogging.step(now)
        if self.jogging.limits != self._limits:
            self._limits = self.jogging.limits
            if limits := ', '.join(self._limits):
                text = f'jogging is limited by {limits}'
                self._node.report_health(DiagnosticStatus.WARN, text, limits=limits)
            else:
                self._node.ready()
        if step is None:
            self.stop()
            self.jogging.end()
        else:
            assert self._stream is not None
            self._stream.publish(np.array([step.q, step.q_dot, step.q_ddot]), now)

    def _reference(self) -> Array | None:
        before, self._newest = self._newest, self._controller.newest()
        return None if self._newest is None or self._newest is before else self._newest[0]

    def stop(self) -> None:
        """End the loop."""
        if self._loop is not None:
            self._loop.stop()
