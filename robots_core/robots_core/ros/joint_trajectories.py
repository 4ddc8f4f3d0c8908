"""trajectory_msgs/JointTrajectory as arrays, also of many points without an object for each of them.

The generated code of rclpy makes four objects for each point, and holds the interpreter meanwhile: 7 ms for a
motion of 4 s, in which a control loop in the same process would wait.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from functools import cached_property
from typing import Any, Final

import numpy as np
from builtin_interfaces.msg import Time
from numpy.typing import NDArray
from rclpy.serialization import deserialize_message, serialize_message
from trajectory_msgs.msg import JointTrajectory

from robots_core.errors import InvalidInputError
from robots_core.ros.messages import (
    ENCAPSULATION_SIZE,
    LITTLE_ENDIAN,
    NANOSECONDS,
    STAMP_END,
    joint_indices,
    nanoseconds,
    seconds,
    serialized_stamp_id,
    stamp_id,
)
from robots_core.validation import Array, finite_vector

FIELDS: Final = ('positions', 'velocities', 'accelerations')
COUNT: Final = struct.Struct('<I')


class SerializedTrajectory:
    """A serialized JointTrajectory, as a raw subscription takes it.

    Points that all have positions, velocities, accelerations and no effort are read as arrays; messages of
    any other kind are deserialized.
    """

    def __init__(self, raw: bytes) -> None:
        self.raw: Final = raw
        try:
            self._names, self._start = read_head(raw)
            (self.num_points,) = COUNT.unpack_from(raw, self._start)
        except (struct.error, UnicodeDecodeError):  # of another byte order
            self._names, self._start = [], 0
            self.num_points = len(self.message.points)

    @property
    def id(self) -> str:
        """The id of its command: the stamp."""
        return serialized_stamp_id(self.raw) if self._start else stamp_id(self.message.header.stamp)

    @cached_property
    def message(self) -> JointTrajectory:
        """The message, deserialized."""
        return deserialize_message(self.raw, JointTrajectory)

    def points(self, names: Sequence[str], what: str) -> tuple[NDArray[np.int64], Array]:
        """Times (m,) in ns, and positions, velocities and accelerations (3, m, n) of joints matched by name.

        Args:
            names: The wanted joints, n of them.
            what: Topic, for errors.

        Raises:
            InvalidInputError: missing joints, or a point without one of the three.
        """
        records = _records(self.raw, self._start, self.num_points, len(self._names))
        if records is None:
            message = self.message
            times = np.array([nanoseconds(point.time_from_start) for point in message.points], dtype=np.int64)
            return times, np.array([field_rows(message, names, what, field) for field in FIELDS])
        indices = joint_indices(self._names, names, what)
        times = records['sec'].astype(np.int64) * NANOSECONDS + records['nanosec']
        return times, np.array([records[field][:, indices] for field in FIELDS])


def serialize_points(
    names: Sequence[str], stamp: Time, frame_id: str, times: NDArray[np.int64], rows: Array
) -> bytes:
    """A serialized JointTrajectory.

    Args:
        names: The joints, n of them.
        stamp: Of the header.
        frame_id: Of the header.
        times: Of the points, (m,), ns.
        rows: Positions, velocities and accelerations, (3, m, n).
    """
    message = JointTrajectory(joint_names=list(names))
    message.header.stamp, message.header.frame_id = stamp, frame_id
    empty = serialize_message(message)
    _, start = read_head(empty)
    n, m = len(names), len(times)
    layout, first = _layout(n), first_number(start + 2 * COUNT.size)
    raw = bytearray(first + m * layout.itemsize)
    raw[:start] = empty[:start]
    COUNT.pack_into(raw, start, m)
    COUNT.pack_into(raw, start + COUNT.size, n)
    records: NDArray[Any] = np.ndarray((m,), layout, raw, first)
    records['num_velocities'] = records['num_accelerations'] = records['next'] = n
    records['sec'], records['nanosec'] = np.divmod(times, NANOSECONDS)
    for field, values in zip(FIELDS, rows, strict=True):
        records[field] = values
    return bytes(raw[: -COUNT.size])  # the last point has no next one


def read_head(raw: bytes) -> tuple[list[str], int]:
    """Names of the joints of a message that has them behind its header, and where what follows them is.

    Raises:
        struct.error: the message is of another byte order, or shorter than it says.
    """
    if not raw.startswith(LITTLE_ENDIAN):
        raise struct.error
    _, at = _text(raw, STAMP_END)
    at += -at % COUNT.size
    (count,) = COUNT.unpack_from(raw, at)
    at += COUNT.size
    names = []
    for _ in range(count):
        name, at = _text(raw, at)
        names.append(name)
    return names, at + -at % COUNT.size


def _text(raw: bytes, at: int) -> tuple[str, int]:
    at += -at % COUNT.size
    (size,) = COUNT.unpack_from(raw, at)
    at += COUNT.size
    return raw[at : at + size - 1].decode(), at + size


def first_number(at: int) -> int:
    """Where the next number of 8 bytes is, which are aligned behind the encapsulation."""
    return at + (ENCAPSULATION_SIZE - at) % 8


def _layout(n: int) -> np.dtype[Any]:
    """Of a point from its positions to the next point's number of positions, aligned as in a struct of C.

    Both ends are at a multiple of 8, behind the encapsulation; so are all arrays in between.
    """
    fields = [
        ('positions', '<f8', (n,)),
        ('num_velocities', '<u4'),
        ('velocities', '<f8', (n,)),
        ('num_accelerations', '<u4'),
        ('accelerations', '<f8', (n,)),
        ('num_effort', '<u4'),
        ('sec', '<i4'),
        ('nanosec', '<u4'),
        ('next', '<u4'),
    ]
    return np.dtype(fields, align=True)


def _records(raw: bytes, start: int, m: int, n: int) -> NDArray[Any] | None:
    """The points, None if they are none of this layout."""
    layout = _layout(n)
    first, end = first_number(start + 2 * COUNT.size), start + COUNT.size
    size = first + m * layout.itemsize - COUNT.size  # the last point has no next one
    if not start or m < 1 or n < 1 or len(raw) < size or COUNT.unpack_from(raw, end) != (n,):
        return None
    padded = raw[first:size] + COUNT.pack(n)
    records: NDArray[Any] = np.frombuffer(padded, layout)
    counts = (records[one] == n for one in ('num_velocities', 'num_accelerations', 'next'))
    if not all(one.all() for one in counts) or records['num_effort'].any():
        return None
    return records


def single_point(message: JointTrajectory, names: Sequence[str], what: str) -> Array:
    """Position, velocity and acceleration of a streamed reference, (3, n); those that are missing are 0.

    Args:
        message: With one point.
        names: The wanted joints, n of them.
        what: Topic, for errors.

    Raises:
        InvalidInputError: not one point, missing joints, no positions, or values that are not finite.
    """
    if len(message.points) != 1:
        raise InvalidInputError(f'{what} has {len(message.points)} points, a streamed reference is one point')
    indices, count = joint_indices(message.joint_names, names, what), len(message.joint_names)
    rows = np.zeros((len(FIELDS), len(names)))
    for row, field in zip(rows, FIELDS, strict=True):
        values = getattr(message.points[0], field)
        if len(values) or field == 'positions':
            row[:] = finite_vector(_checked(values, count, f'{what} has', field), count, field)[indices]
    return rows


def point_times(message: JointTrajectory) -> Array:
    """Times of the points, (m,), s."""
    return np.array([seconds(point.time_from_start) for point in message.points])


def field_rows(message: JointTrajectory, names: Sequence[str], what: str, field: str) -> Array:
    """One of `FIELDS` of all points, (m, n).

    Args:
        message: With m points.
        names: The wanted joints, n of them.
        what: Topic, for errors.
        field: Which.

    Raises:
        InvalidInputError: missing joints, or a point without it.
    """
    indices, count = joint_indices(message.joint_names, names, what), len(message.joint_names)
    rows = [
        _checked(getattr(point, field), count, f'{what} point {k} has', field)
        for k, point in enumerate(message.points, 1)
    ]
    return np.array(rows, dtype=np.float64).reshape(len(rows), count)[:, indices]


def _checked(values: Any, count: int, what: str, field: str) -> Any:
    if len(values) != count:
        raise InvalidInputError(f'{what} {len(values)} {field} for {count} joints')
    return values
