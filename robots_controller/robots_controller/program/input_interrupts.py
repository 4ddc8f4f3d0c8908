"""InputInterrupts: handlers that a digital input calls."""

from collections import deque

import numpy as np
from numpy.typing import NDArray


class InputInterrupts:
    """Which handlers are due; one is served at a time, in the order in which their inputs changed.

    A handler is due when its input takes the value it waits for, not while it has it. Not safe by itself:
    the program's state guards it.
    """

    def __init__(self) -> None:
        self._wanted: dict[int, tuple[int, bool]] = {}
        self._seen: NDArray[np.bool_] | None = None
        self._due: deque[int] = deque()
        self.serving: int | None = None
        """The handler that runs now."""

    @property
    def any(self) -> bool:
        """There is a handler."""
        return bool(self._wanted)

    def add(self, index: int, value: bool, inputs: NDArray[np.bool_]) -> int:  # noqa: FBT001  # an input's value
        """A handler for an input, counted from 1; it replaces the one for the same change.

        Returns:
            The handler's number, from 1.
        """
        for handler, wanted in list(self._wanted.items()):
            if wanted == (index, value):
                del self._wanted[handler]
        if self._seen is None:
            self._seen = inputs
        handler = 1 + max(self._wanted, default=0)
        self._wanted[handler] = (index, value)
        return handler

    def look(self, inputs: NDArray[np.bool_]) -> bool:
        """Note what has changed; True if a handler is due and none runs."""
        if self._seen is not None:
            changed = inputs != self._seen
            if changed.any():
                for handler, (index, value) in self._wanted.items():
                    if changed[index - 1] and inputs[index - 1] == value and handler not in self._due:
                        self._due.append(handler)
                self._seen = inputs
        return bool(self._due) and self.serving is None

    def begin(self) -> int:
        """The next handler, which runs from now on."""
        self.serving = self._due.popleft()
        return self.serving

    def end(self) -> None:
        """The handler has ended."""
        self.serving = None
