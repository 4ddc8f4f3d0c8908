"""InputInterrupts: handlers that changes of inputs call."""

from collections.abc import Callable, Hashable
from dataclasses import dataclass
from itertools import count

DEFAULT_PRIORITY = 100
Condition = Callable[[], bool]


@dataclass
class _Interrupt:
    what: Hashable
    holds: Condition
    priority: int
    held: bool


class InputInterrupts:
    """Which handlers are due: the most urgent first, those of one priority in the order of their changes.

    A handler is due when its condition comes true, not while it is. One that runs is interrupted by more
    urgent ones alone. Not safe by itself: the program's state guards it.
    """

    def __init__(self) -> None:
        self._interrupts: dict[int, _Interrupt] = {}
        self._numbers = count(1)
        self._due: list[int] = []
        self._serving: list[_Interrupt] = []

    def add(self, what: Hashable, holds: Condition, priority: int = DEFAULT_PRIORITY) -> int:
        """A handler for a condition that comes true; it replaces the one for the same, and has its number.

        Args:
            what: The same for the same condition.
            holds: The condition.
            priority: From 1, the most urgent.

        Returns:
            The handler's number, from 1.
        """
        same = (number for number, interrupt in self._interrupts.items() if interrupt.what == what)
        number = next(same, None) or next(self._numbers)
        self.remove(number)
        self._interrupts[number] = _Interrupt(what, holds, priority, holds())
        return number

    def remove(self, number: int) -> bool:
        """Take a handler away, also one that is due; False if there is none of this number."""
        if number in self._due:
            self._due.remove(number)
        return self._interrupts.pop(number, None) is not None

    def check(self) -> bool:
        """Note what has changed; True if a handler is due and none as urgent runs."""
        for number, interrupt in self._interrupts.items():
            held, interrupt.held = interrupt.held, interrupt.holds()
            if interrupt.held and not held and number not in self._due:
                self._due.append(number)
        return self._next() is not None

    def begin(self) -> int:
        """The next handler, which runs from now on."""
        number = self._next()
        assert number is not None
        self._due.remove(number)
        self._serving.append(self._interrupts[number])
        return number

    def end(self) -> None:
        """The handler that began last has ended."""
        self._serving.pop()

    def _next(self) -> int | None:
        number = min(self._due, key=lambda one: self._interrupts[one].priority, default=None)
        if number is None or not self._serving:
            return number
        return number if self._interrupts[number].priority < self._serving[-1].priority else None
