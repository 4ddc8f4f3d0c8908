"""MessageRows: many messages that differ in their stamp and some numbers alone, serialized at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from rosbags.typesys.store import Typestore

from robots_core.validation import Array

# CDR of a message that begins with a Header: 4 bytes of encapsulation, then the stamp's two 32-bit words.
STAMP_OFFSET: Final = 4
NANOSECONDS: Final = 1_000_000_000


def marks(count: int, number: int) -> Array:
    """Numbers (count,) that cannot occur by chance, others for every `number`."""
    return 1e300 * (1.0 + number + np.arange(count) / 1024.0)


class MessageRows:
    """A template of a message, filled row by row.

    Args:
        typestore: Knows the type.
        type_name: package/msg/Name.
        template: Message whose changing numbers are those of `groups`.
        groups: Arrays of marks, each of which stands in the template as one run of doubles.
        stamped: It begins with a header.
    """

    def __init__(
        self,
        typestore: Typestore,
        type_name: str,
        template: Any,
        groups: Sequence[Array],
        *,
        stamped: bool = True,
    ) -> None:
        self._stamped = stamped
        data = bytes(typestore.serialize_cdr(template, type_name))
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
