"""SerializedRows: messages of which only the stamp and rows of numbers change, written in their place."""

from collections.abc import Callable
from typing import Any

import numpy as np
from rclpy.serialization import serialize_message

from robots_core.ros.messages import ENCAPSULATION_SIZE, NANOSECONDS, SERIALIZED_STAMP
from robots_core.validation import Array


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
