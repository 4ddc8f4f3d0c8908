"""ReferenceStream: publishes one-point JointTrajectory messages at a high rate, at little cost."""

import time
from collections.abc import Sequence
from typing import Final

from rclpy.node import Node
from trajectory_msgs.msg import JointTrajectory

from robots_core.periodic.resting_rate import RestingRate
from robots_core.ros.lockstep.counted_endpoints import CountedPublisher
from robots_core.ros.lockstep.phases import NANOSECONDS
from robots_core.ros.messages import BUILD
from robots_core.ros.qos import make_publisher
from robots_core.ros.streams.serialized_rows import SerializedRows
from robots_core.validation import Array

EMPTY_SEQUENCE_SIZE = 4
DURATION_SIZE = 8
# The time of day has been set if it has changed by more than this; two readings of a busy machine differ too.
CLOCK_STEP: Final = 1_000_000  # ns
READINGS: Final = 5


class ReferenceStream:
    """Publisher of `trajectory_msgs/JointTrajectory` with one point and always the same joints.

    Only the stamp and 3 n numbers change from message to message; they are written into `SerializedRows`.

    Args:
        node: Owner; stamps are on its clock.
        topic: Topic name.
        names: Joint names, n of them.
        time_from_start: The point's time, s.
        resting: When a reference that is the same as the one before is sent; by default always. Before one
            that differs, the last one is sent again if it was left out: of each motion the stream has the
            period before it.
    """

    def __init__(
        self,
        node: Node,
        topic: str,
        names: Sequence[str],
        *,
        time_from_start: float,
        resting: RestingRate | None = None,
    ) -> None:
        self._period = time_from_start
        self._publisher = make_publisher(node, JointTrajectory, topic)
        if isinstance(self._publisher, CountedPublisher):
            self._publish = self._publisher.publish
        else:
            self._publish = self._publisher.handle.publish_raw  # without its checks of the argument
        self._simulated = bool(getattr(node.get_clock(), 'ros_time_is_active', False))
        n = len(names)

        def message(rows: Array) -> JointTrajectory:
            return BUILD.joint_trajectory(0, names, [(round(NANOSECONDS * time_from_start), *rows)])

        self._offset = _offset_to_time_of_day()
        self._serialized = SerializedRows(message, (3, n), end=EMPTY_SEQUENCE_SIZE + DURATION_SIZE)
        self._last: Array | None = None
        self._resting = RestingRate(1, 0) if resting is None else resting
        self._left_out = False

    def publish(self, reference: Array, deadline: float) -> None:
        """Publish a reference.

        Args:
            reference: (3, n): position, velocity, acceleration; never changed after it was published.
            deadline: When it was due, s on the clock of `TimedNode.now`: the message's stamp. Two stamps are
                as far apart as their deadlines, whatever the jitter of sending.
        """
        stands = reference is self._last  # the controller makes no new one
        if not self._resting.due(resting=stands):
            self._left_out = True
            return
        if not stands:
            if self._left_out:
                self._send(deadline - self._period)
            self._serialized.rows[:] = self._last = reference
        self._left_out = False
        self._send(deadline)

    @property
    def ahead(self) -> int:
        """So many of the next references are not sent if they are the same as the last one."""
        return self._resting.ahead

    def pass_over(self, references: int) -> None:
        """So many were the same, and not sent."""
        self._resting.pass_over(references)
        self._left_out = True

    def restart(self) -> None:
        """Publish each reference again, as if the last one had moved."""
        self._resting.restart()

    def _send(self, deadline: float) -> None:
        if self._simulated:
            nanoseconds = round(NANOSECONDS * deadline)
        else:
            if abs(time.time_ns() - time.monotonic_ns() - self._offset) > CLOCK_STEP:
                self._offset = _offset_to_time_of_day()
            nanoseconds = self._offset + int(NANOSECONDS * deadline)
        self._publish(self._serialized.stamped(nanoseconds))


def _offset_to_time_of_day() -> int:
    """Time of day less `time.monotonic`, ns: the least interrupted of several readings."""
    readings = []
    for _ in range(READINGS):
        before, now, after = time.monotonic_ns(), time.time_ns(), time.monotonic_ns()
        readings.append((after - before, now - (before + after) // 2))
    return min(readings)[1]
