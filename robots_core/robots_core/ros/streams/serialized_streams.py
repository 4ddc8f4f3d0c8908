"""Publishers of messages of which only the stamp and rows of numbers change, at little cost."""

import time
from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np
from rclpy.node import Node
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

from robots_core.periodic.resting_rate import RestingRate
from robots_core.ros.lockstep.counted_endpoints import CountedPublisher
from robots_core.ros.messages import (
    BUILD,
    ENCAPSULATION_SIZE,
    NANOSECONDS,
    SERIALIZED_STAMP,
)
from robots_core.ros.qos import make_publisher
from robots_core.validation import Array

EMPTY_SEQUENCE_SIZE: Final = 4
DURATION_SIZE: Final = 8
# The time of day has been set if it has changed by more than this; two readings of a busy machine differ too.
CLOCK_STEP: Final = 1_000_000  # ns
READINGS: Final = 5


class SerializedRows:
    """A serialized message that begins with a header and has rows of n >= 1 numbers, one after the other.

    Writing numbers into it takes a fraction of what building and converting a message object takes.

    Args:
        make: The message with rows of numbers, (k, n).
        shape: k rows of n numbers.
        end: Size of what the message has behind the last row, bytes.

    Attributes:
        rows: The numbers, (k, n), to be written to.
    """

    def __init__(self, make: Callable[[Array], Any], shape: tuple[int, int], *, end: int) -> None:
        k, n = shape
        # Marks that cannot occur by chance show where serialization puts each of the rows.
        marks = 1e300 * (1.0 + np.arange(float(k * n)).reshape(shape))
        template = bytearray(serialize_message(make(marks)))
        offsets = [template.index(row.tobytes()) for row in marks]
        # The serializer leaves padding behind the message's end.
        del template[offsets[-1] + 8 * n + end :]
        self._buffer = template
        # Rows that are equally long are equally far from each other.
        stride = (offsets[-1] - offsets[0]) // max(1, k - 1)
        self.rows: Array = np.ndarray(shape, np.float64, template, offsets[0], (stride, 8))

    def stamped(self, nanoseconds: int) -> bytes:
        """The message with this stamp, ns."""
        SERIALIZED_STAMP.pack_into(self._buffer, ENCAPSULATION_SIZE, *divmod(nanoseconds, NANOSECONDS))
        return bytes(self._buffer)


class JointStateStream:
    """Publisher of `sensor_msgs/JointState` with joints that seldom change, stamped by the node's clock."""

    def __init__(self, node: Node, topic: str) -> None:
        self._publisher = make_publisher(node, JointState, topic)
        self._clock = node.get_clock()
        self._layout: tuple[list[str], int] = [], 0
        self._serialized: SerializedRows | None = None

    def publish(self, names: Sequence[str], values: Sequence[Array]) -> None:
        """Publish what joints do now.

        Args:
            names: Of the joints, n of them.
            values: Positions and velocities, (n,) each, and efforts where there are any.
        """
        layout = list(names), len(values)
        if layout != self._layout:
            self._layout = layout
            self._serialized = self._template() if names else None
        now = self._clock.now()
        if self._serialized is None:
            message = JointState()
            message.header.stamp = now.to_msg()
            self._publisher.publish(message)
            return
        for row, numbers in zip(self._serialized.rows, values, strict=True):
            row[:] = numbers
        self._publisher.publish(self._serialized.stamped(now.nanoseconds))

    def _template(self) -> SerializedRows:
        names, fields = self._layout
        end = EMPTY_SEQUENCE_SIZE if fields == 2 else 0  # positions and velocities
        return SerializedRows(lambda rows: BUILD.joint_state(0, names, *rows), (fields, len(names)), end=end)


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
        self.resting = RestingRate(1, 0) if resting is None else resting
        """When a reference is sent that is the same as the one before."""
        self._left_out = False

    def publish(self, reference: Array, deadline: float) -> None:
        """Publish a reference.

        Args:
            reference: (3, n): position, velocity, acceleration; never changed after it was published.
            deadline: When it was due, s on the clock of `TimedNode.now`: the message's stamp. Two stamps are
                as far apart as their deadlines, whatever the jitter of sending.
        """
        stands = reference is self._last  # the controller makes no new one
        if not self.resting.due(resting=stands):
            self._left_out = True
            return
        if not stands:
            if self._left_out:
                self._send(deadline - self._period)
            self._serialized.rows[:] = self._last = reference
        self._left_out = False
        self._send(deadline)

    def pass_over(self, references: int) -> None:
        """So many were the same, and not sent."""
        self.resting.pass_over(references)
        self._left_out = True

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
