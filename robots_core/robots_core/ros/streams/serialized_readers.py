"""Readers of serialized messages that stay the same but for their stamp and their numbers, at little cost."""

import struct
from collections.abc import Sequence

import numpy as np
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

from robots_core.ros.joint_trajectories import COUNT, first_number, read_head, single_point
from robots_core.ros.messages import (
    ENCAPSULATION_SIZE,
    LITTLE_ENDIAN,
    NANOSECONDS,
    SERIALIZED_STAMP,
    STAMP_END,
    joint_indices,
    joint_values,
    seconds,
)
from robots_core.validation import Array, finite_vector


class JointStateReader:
    """Reads the wanted joints' positions out of `sensor_msgs/JointState`.

    As long as frame and joints stay the same, the positions are where they were in the message before.

    Args:
        names: The wanted joints, n of them.
    """

    def __init__(self, names: Sequence[str]) -> None:
        self._names = list(names)
        self._before = b''  # what stands between the stamp and the positions
        self._numbers = struct.Struct('')
        self._indices: list[int] = []

    def position(self, raw: bytes) -> Array:
        """Positions of the wanted joints, (n,), matched by name.

        Raises:
            InvalidInputError: a missing joint, not one position per name, or values that are not finite.
        """
        start = STAMP_END + len(self._before)
        same = self._before and raw[STAMP_END:start] == self._before
        if same and len(raw) >= start + self._numbers.size:
            numbers = self._numbers.unpack_from(raw, start)
            position = np.array([numbers[index] for index in self._indices])
        else:
            position = self._find(raw)
        return finite_vector(position, len(self._names), 'joint_states')

    def _find(self, raw: bytes) -> Array:
        """The positions of a message of any joints, and where those of the next ones like it are."""
        try:
            names, end = read_head(raw)
            (count,) = COUNT.unpack_from(raw, end)
            start, numbers = first_number(end + COUNT.size), struct.Struct(f'<{count}d')
            values = numbers.unpack_from(raw, start)
        except (struct.error, UnicodeDecodeError):  # of another byte order
            message = deserialize_message(raw, JointState)
            return joint_values(message.name, message.position, self._names, 'joint_states')
        position = joint_values(names, values, self._names, 'joint_states')
        self._before, self._numbers = raw[STAMP_END:start], numbers
        self._indices = joint_indices(names, self._names, 'joint_states')
        return position


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
