"""Joint positions out of serialized `sensor_msgs/JointState` messages, at little cost."""

import struct
from collections.abc import Sequence

import numpy as np
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import JointState

from robots_core.ros.messages import ENCAPSULATION_SIZE, STAMP_END, joint_indices, joint_values
from robots_core.validation import Array, finite_vector


class JointStateReader:
    """Reads the wanted joints' positions.

    From one message of a driver to the next only the stamp and the numbers change. As long as frame and
    joints stay the same the positions are read in their place, which takes a fraction of what building a
    message object takes; a message with others is read as any.

    Args:
        names: The wanted joints, n of them.
    """

    def __init__(self, names: Sequence[str]) -> None:
        self._names = list(names)
        self._pieces: list[tuple[int, bytes]] = []
        self._head = b''
        self._start = STAMP_END
        self._numbers = struct.Struct('')
        self._indices: list[int] = []

    def position(self, raw: bytes) -> Array:
        """Positions of the wanted joints, (n,), matched by name.

        Args:
            raw: The serialized message.

        Raises:
            InvalidInputError: a missing joint, not one position per name, or values that are not finite.
        """
        if self._is_known(raw):
            numbers = self._numbers.unpack_from(raw, self._start)
            position = np.array([numbers[index] for index in self._indices])
        else:
            message = deserialize_message(raw, JointState)
            position = joint_values(message.name, message.position, self._names, 'joint_states')
            self._learn(message)
        return finite_vector(position, len(self._names), 'joint_states')

    def _is_known(self, raw: bytes) -> bool:
        if len(raw) < self._start + self._numbers.size:
            return False
        head = raw[STAMP_END : self._start]
        if head and head == self._head:
            return True
        # Others are of other joints, or from a machine of another byte order; or their padding differs.
        known = bool(self._pieces) and all(raw.startswith(piece, at) for at, piece in self._pieces)
        self._head = head if known else b''
        return known

    def _learn(self, message: JointState) -> None:
        """Find out what stands before the positions, and where; padding in between may be anything."""
        texts = [text.encode() + b'\0' for text in (message.header.frame_id, *message.name)]
        frame, *names = (struct.pack('=I', len(text)) + text for text in texts)
        count = struct.pack('=I', len(names))  # of the names, and of the positions
        at, self._pieces = STAMP_END, []
        for piece in (frame, count, *names, count):
            at += -at % 4
            self._pieces.append((at, piece))
            at += len(piece)
        self._start = at + (ENCAPSULATION_SIZE - at) % 8
        self._numbers = struct.Struct(f'={len(names)}d')
        self._indices = joint_indices(message.name, self._names, 'joint_states')
