"""MessageRows: many messages that differ in their stamp and some numbers alone, written and read at once."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from rosbags.typesys.store import Typestore

from robots_core.message_builder import NANOSECONDS
from robots_core.validation import Array

# CDR of a message that begins with a Header: 4 bytes of encapsulation, then the stamp's two 32-bit words.
STAMP_OFFSET: Final = 4


def marks(count: int, number: int) -> Array:
    """Numbers (count,) that cannot occur by chance, others for every `number`."""
    return 1e300 * (1.0 + number + np.arange(count) / 1024.0)


class MessageRows:
    """A template of a message, filled row by row, or read so.

    Args:
        typestore: Holds its type.
        template: Message whose changing numbers are those of `groups`.
        groups: Arrays of marks, each of which stands in the template as one run of doubles, or nowhere if it
            is empty.
    """

    def __init__(self, typestore: Typestore, template: Any, groups: Sequence[Array]) -> None:
        self.type_name: str = template.__msgtype__
        """package/msg/Name."""
        self._stamped = hasattr(template, 'header')
        data = bytes(typestore.serialize_cdr(template, self.type_name))
        self._template = np.frombuffer(data, np.uint8)
        self._places = [(data.index(group.tobytes()), group.size) for group in groups]

    def fill(self, nanoseconds: NDArray[np.int64], values: Sequence[Array]) -> NDArray[np.uint8]:
        """The messages.

        Args:
            nanoseconds: (k,) stamps.
            values: For each group (k, size).

        Returns:
            (k, length of a message) bytes.
        """
        count = nanoseconds.size
        rows = np.tile(self._template, (count, 1))
        if self._stamped:
            stamps = np.stack(np.divmod(nanoseconds, NANOSECONDS), axis=1).astype('<u4')
            rows[:, STAMP_OFFSET : STAMP_OFFSET + 8] = stamps.view(np.uint8)
        for (offset, size), numbers in zip(self._places, values, strict=True):
            doubles = np.ascontiguousarray(numbers, '<f8').reshape(count, size)
            rows[:, offset : offset + 8 * size] = doubles.view(np.uint8)
        return rows

    def read(self, messages: Sequence[bytes]) -> tuple[NDArray[np.int64], list[Array]] | None:
        """What `fill` was given for messages of anybody; None where they differ in anything else.

        Args:
            messages: k, serialized, the first like the template except for what was filled in.

        Returns:
            (k,) stamps in ns, 0 without a header; and for each group (k, size).
        """
        size = len(messages[0])
        if size < self._template.size or any(len(message) != size for message in messages):
            return None
        rows = np.frombuffer(b''.join(messages), np.uint8).reshape(len(messages), size)
        fixed = np.ones(size, bool)
        if self._stamped:
            fixed[STAMP_OFFSET : STAMP_OFFSET + 8] = False
        for offset, count in self._places:
            fixed[offset : offset + 8 * count] = False
        same = (rows[:, fixed] == rows[0, fixed]).all()
        if not (same and (rows[0, :STAMP_OFFSET] == self._template[:STAMP_OFFSET]).all()):
            return None
        stamps = np.zeros(len(messages), np.int64)
        if self._stamped:
            words = np.ascontiguousarray(rows[:, STAMP_OFFSET : STAMP_OFFSET + 8]).view('<u4')
            stamps = words[:, 0].astype(np.int64) * NANOSECONDS + words[:, 1]
        values = [
            np.ascontiguousarray(rows[:, offset : offset + 8 * count]).view('<f8').astype(np.float64)
            for offset, count in self._places
        ]
        return stamps, values
