"""Jogging: the face of the TeachBox in planning_node."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import TwistStamped
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

from robots_core.errors import InvalidInputError, PlanningError, RobotsError
from robots_core.pose import Pose
from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.loop import Loop
from robots_core.ros.messages import NANOSECONDS, joint_values, nanoseconds
from robots_core.ros.polled_subscription import PolledSubscription
from robots_core.ros.qos import STREAM
from robots_core.ros.reference_stream import ReferenceStream
from robots_core.ros.robot_node import RobotNode
from robots_core.validation import Array
from robots_planning.teach_box import JOG_DEVIATION, JOG_FRAMES, JOG_RATE, TeachBox


class Jogging:
    """Takes `teach_twist` and `teach_joints`, and streams one-point `joint_trajectory` while somebody jogs.

    A command holds for `teach_timeout` from its stamp on, or from when it came without one: whoever jogs goes
    on sending, and lets go by sending nothing. The stream ends when the robot stands.

    Args:
        node: Owner.
        standing: Where the robot's reference stands, (n,); raises a PlanningError if it does not.
        position: Joint positions (n,) of a `joint_reference`.
        busy: A motion is planned or runs: no jogging.

    Parameters (of the node):
        teach_speed: Part of the velocity limits to use, in (0, 1].
        teach_tool_speed: Highest speed of the tool, m/s.
        teach_timeout: Age of a command at which the robot stops, s.
    """

    def __init__(
        self,
        node: RobotNode,
        *,
        standing: Callable[[], Array],
        position: Callable[[JointTrajectory], Array],
        busy: Callable[[], bool],
    ) -> None:
        self._node, self._standing, self._position, self._busy = node, standing, position, busy
        speed = node.parameter(
            'teach_speed', 0.1, 'part of the velocity limits to jog with', bounds=(0.001, 1.0), read_only=True
        )
        tool_speed = node.parameter(
            'teach_tool_speed',
            0.25,
            'highest speed of a jogged tool, m/s',
            bounds=(0.001, 2.0),
            read_only=True,
        )
        self._timeout: float = node.parameter(
            'teach_timeout',
            0.1,
            'a jog command older than this is stale, s',
            bounds=(0.02, 1.0),
            read_only=True,
        )
        self._names = list(node.robot.axes_data.names)
        self._make_box = partial(
            TeachBox,
            node.robot,
            1.0 / JOG_RATE,
            speed_fraction=speed,
            tool_speed=tool_speed,
            timeout=self._timeout,
        )
        self._tool = Pose.identity()
        # Made at the start: whoever jogs does not wait for it.
        self._box: TeachBox | None = self._make_box(q=node.robot.home)
        self._references: PolledSubscription[JointTrajectory] = PolledSubscription(
            node, JointTrajectory, 'joint_reference', STREAM
        )
        self._mailbox: deque[Callable[[TeachBox], None]] = deque()
        self._loop: Loop | None = None
        self._limits: tuple[str, ...] = ()
        self._stream: ReferenceStream | None = None
        node.create_subscription(TwistStamped, 'teach_twist', self._on_twist, STREAM)
        node.create_subscription(JointState, 'teach_joints', self._on_joints, STREAM)

    @property
    def active(self) -> bool:
        """The robot is jogged, or brakes from it."""
        return self._loop is not None and self._loop.alive

    def use_tool(self, tool: Pose) -> None:
        """Jog this tool centre point from the next jog on."""
        if self._tool.distance_to(tool) != (0.0, 0.0):
            self._tool, self._box = tool, None

    # -- the executor's thread -----------------------------------------------------------------------

    def _on_twist(self, message: TwistStamped) -> None:
        v, w = message.twist.linear, message.twist.angular
        frame = message.header.frame_id
        try:
            if frame not in JOG_FRAMES:
                raise InvalidInputError(
                    f'frame {frame!r} is unknown; tools are jogged in {", ".join(filter(None, JOG_FRAMES))}'
                )
            twist = np.array([v.x, v.y, v.z, w.x, w.y, w.z])
            given = self._given(message)
            self._jog(twist, lambda box: box.jog_tool(twist, given, JOG_FRAMES[frame]))
        except RobotsError as error:
            self._node.refuse('teach_twist', error, stream=True)

    def _on_joints(self, message: JointState) -> None:
        try:
            velocity = joint_values(message.name, message.velocity, self._names, 'teach_joints')
            given = self._given(message)
            self._jog(velocity, lambda box: box.jog_axes(velocity, given))
        except RobotsError as error:
            self._node.refuse('teach_joints', error, stream=True)

    def _given(self, message: Any) -> float:
        """When a command was given, s on the clock of the loop.

        Raises:
            PlanningError: it is stale already.
        """
        now, stamp = self._node.now(), message.header.stamp
        if not stamp.sec and not stamp.nanosec:
            return now
        age: float = (self._node.get_clock().now().nanoseconds - nanoseconds(stamp)) / NANOSECONDS
        if age > self._timeout:
            raise PlanningError(
                f'the command is {age:.3g} s old, allowed is {self._timeout:g} s: are the clocks the same?',
                age=age,
            )
        return now - max(age, 0.0)

    def _jog(self, command: Array, put: Callable[[TeachBox], None]) -> None:
        if not np.isfinite(command).all():
            raise InvalidInputError(f'the command is {command.tolist()}, every value must be a finite number')
        if self.active:
            self._mailbox.append(put)
            return
        if not command.any():  # of a robot that stands
            return
        if self._busy():
            raise PlanningError('a motion runs; the robot can be jogged when it has ended')
        q = self._standing()
        if self._box is None:
            self._box = self._make_box(q=q, tool=self._tool)
        else:
            self._box.place(q)
        if self._stream is None:
            self._stream = ReferenceStream(
                self._node, 'joint_trajectory', self._names, time_from_start=1.0 / JOG_RATE, qos=STREAM
            )
        self._references.take()  # older than this jog
        self._mailbox.clear()
        self._mailbox.append(put)
        self._loop = self._node.start_loop(
            partial(self._step, self._box, self._stream),
            period=1.0 / JOG_RATE,
            name='jogging',
            phase=Phase.GUIDANCE,
        )

    # -- the loop's thread ---------------------------------------------------------------------------

    def _step(self, box: TeachBox, stream: ReferenceStream, now: float) -> None:
        """One period, the last one when the robot stands and nobody jogs."""
        while self._mailbox:
            self._mailbox.popleft()(box)
        if not self._followed(box):
            self._tell(('a controller that does not follow',))
            self.stop()
            return
        step = box.step(now)
        stream.publish(np.array([step.q, step.q_dot, step.q_ddot]), now)
        if step.limits != self._limits:
            self._tell(step.limits)
        # The last point has no acceleration that the controller could extrapolate.
        if step.standing and not step.q_ddot.any() and not step.jogging:
            self.stop()

    def _followed(self, box: TeachBox) -> bool:
        message = self._references.take()
        if message is None:
            return True
        return float(np.abs(self._position(message) - box.q).max()) <= JOG_DEVIATION

    def _tell(self, limits: Sequence[str]) -> None:
        self._limits = tuple(limits)
        if limits:
            self._node.report_health(DiagnosticStatus.WARN, f'jogging is limited by {", ".join(limits)}')
        else:
            self._node.ready()

    def stop(self) -> None:
        """End the loop."""
        if self._loop is not None:
            self._loop.stop()
