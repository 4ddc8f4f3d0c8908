"""ReferenceReader: streamed references out of serialized JointTrajectory messages, at little cost."""

from collections.abc import Sequence

import numpy as np
from rclpy.serialization import deserialize_message
from trajectory_msgs.msg import JointTrajectory

from robots_core.ros.joint_trajectories import single_point
from robots_core.ros.messages import (
    ENCAPSULATION_SIZE,
    LITTLE_ENDIAN,
    NANOSECONDS,
    SERIALIZED_STAMP,
    STAMP_END,
    seconds,
)
from robots_core.validation import Array


class ReferenceReader:
    """Reads streamed references.

    Of a reference that stands, only the stamp changes from message to message: the rest is read once.

    Args:
        names: The wanted joints, n of them.
        what: Topic, for errors.
    """

    def __init__(self, names: Sequence[str], what: str) -> None:
        self._names, self._what = list(names), what
        self.lead = 0.0
        """How long after its stamp the last reference is to be reached, s: the period of its sender."""
        self._content = b''  # of the last message, behind its stamp
        self._rows: Array | None = None

    def read(self, raw: bytes) -> tuple[Array, float]:
        """Position, velocity and acceleration, (3, n), not to be changed, and the stamp, s.

        The array is the same object as long as only the stamp changes.

        Args:
            raw: The serialized message.

        Raises:
            InvalidInputError: see `single_point`.
        """
        content = raw[STAMP_END:] if raw.startswith(LITTLE_ENDIAN) else b''
        if self._rows is not None and content and content == self._content:
            sec, nanosec = SERIALIZED_STAMP.unpack_from(raw, ENCAPSULATION_SIZE)
            return self._rows, (sec * NANOSECONDS + nanosec) / NANOSECONDS
        message = deserialize_message(raw, JointTrajectory)
        before, self._rows, self._content = self._rows, None, content
        rows = single_point(message, self._names, self._what)
        # Bytes that only fill up are whatever was in the sender's memory.
        self._rows = before if before is not None and np.array_equal(before, rows) else rows
        self.lead = seconds(message.points[0].time_from_start)
        return self._rows, seconds(message.header.stamp)
