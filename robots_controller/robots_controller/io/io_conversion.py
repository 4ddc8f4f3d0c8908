"""Values between channels and their places: scale, bits, debounce and fail-safe; the time is handed in."""

import math
import sys
from typing import Final

from robots_controller.io.io_map import IoRow
from robots_controller.io.number_kinds import INTEGERS, bits_of
from robots_core.errors import InvalidInputError

SHOWN: Final = 60
"""Letters of what is no value."""


class InputValue:
    """Value of one input, from what arrives for it and the time; it waits for messages from `start` on, s."""

    def __init__(self, row: IoRow, start: float) -> None:
        self.row = row
        self.stamp = math.nan
        """Of the newest value, s since 1970."""
        self._last = start
        self._known = False
        self._sending = False
        self._value = row.fail_safe
        self._coming: float | None = None  # what is debounced
        self._since = start

    def receive(self, raw: object, now: float, stamp: float = math.nan) -> None:
        """Take what its place holds, which came now.

        Args:
            raw: What its place holds.
            now: s.
            stamp: When its source says that it measured it, s since 1970; NaN where it does not say.

        Raises:
            InvalidInputError: not a finite number; it does not count.
        """
        value = from_field(self.row, raw)
        self.stamp = stamp
        self.update(now)
        first, self._sending, self._known, self._last = not self._sending, True, True, now
        if value == self._value or self.row.debounce == 0.0 or first:
            self._value, self._coming = value, None
        elif value != self._coming:
            self._coming, self._since = value, now

    def update(self, now: float) -> float:
        """The input's value now."""
        if self._coming is not None and now >= self._since + self.row.debounce:
            self._value, self._coming = self._coming, None
        if self.silent(now):
            # The first value after a silence counts at once, as at the start.
            self._value, self._coming, self._sending = self.row.fail_safe, None, False
        return self._value

    def silent(self, now: float) -> bool:
        """It has been waiting for a message longer than its timeout."""
        return now >= self._last + self.row.timeout

    def unknown(self, now: float) -> str:
        """Why the value is not that of its place, for a person; '' if it is."""
        source = self.row.place.source
        if not self._known:
            return f'{source} has sent no value yet'
        return f'{source} has been silent for {self.row.timeout:g} s' if self.silent(now) else ''

    def next_time(self, now: float) -> float:
        """When the value may change without a message, s; infinite for never."""
        debounced = math.inf if self._coming is None else self._since + self.row.debounce
        return min(debounced, math.inf if self.silent(now) else self._last + self.row.timeout)


def from_field(row: IoRow, raw: object) -> float:
    """Value of an input from what its place holds.

    A digital input is on for every number but 0: programmable controllers say 1, 255 or -1.

    Raises:
        InvalidInputError: not a finite number, or a bit of what is not a whole number.
    """
    number, shown = _number(raw), repr(raw)[:SHOWN]
    if number is None:
        raise InvalidInputError(f'{row.place.text} is {shown}; needed is a number')
    if not abs(number) <= sys.float_info.max:
        raise InvalidInputError(f'{row.place.text} is {shown}; needed is a finite number')
    if row.bit is not None:
        if not float(number).is_integer():
            raise InvalidInputError(f'{row.place.text} is {number!r}; a bit needs a whole number')
        number = int(number) >> row.bit & 1
    if row.channel.kind == 'digital':
        return float((number != 0) != row.invert)
    value = row.scale * number + row.offset
    if not math.isfinite(value):
        raise InvalidInputError(f'{row.place.text} is {number:g}; times {row.scale:g} it is no finite number')
    return value


def _number(raw: object) -> int | float | None:
    """A value as a number; None for what is none, as a text of digits: its source sends another type."""
    if isinstance(raw, str):
        return None
    try:
        return int(raw) if isinstance(raw, int) else float(raw)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return None


def check_kind(row: IoRow, raw: object, kind: str) -> None:
    """Check that what came for an input is of the kind that its place has.

    Raises:
        InvalidInputError: its place has whole numbers of a range. `from_field` refuses what is no number.
    """
    if kind not in INTEGERS or not isinstance(raw, (int, float)):
        return
    low, high = INTEGERS[kind]
    if not low <= raw <= high or raw != int(raw):
        raise InvalidInputError(
            f'{row.place.text} is {repr(raw)[:SHOWN]}; {kind} is a whole number in {low}..{high}'
        )


def to_field(row: IoRow, value: float, kind: str, before: float) -> tuple[bool | int | float, str]:
    """What the place of an output holds.

    Args:
        row: The output.
        value: The channel's value.
        kind: Type of the field: 'boolean', 'float', 'double' or one of `INTEGERS`.
        before: What the field holds now; the other bits of a word keep their values.

    Returns:
        The field's value, and what was lost ('' for nothing): a whole number is rounded, one beyond the
        type's range becomes the nearest that fits.
    """
    if row.channel.kind == 'digital':
        on = int((value != 0.0) != row.invert)
        if row.bit is not None:
            return _signed(int(before) & ~(1 << row.bit) | on << row.bit, kind), ''
        return _typed(on, kind), ''
    scaled = row.scale * value + row.offset
    if kind not in INTEGERS:
        largest = 3.4028234663852886e38 if kind == 'float' else 1.7976931348623157e308
        fitting: float = min(max(scaled, -largest), largest)
    else:
        low, high = INTEGERS[kind]
        fitting = int(min(max(round(scaled) if math.isfinite(scaled) else scaled, low), high))
    # Half a unit is what rounding to a whole number may take.
    lost = abs(fitting - scaled) > 0.5 if math.isfinite(scaled) else True
    problem = f'{row.channel.name} would be {scaled:g}; {kind} ends at {fitting:g}' if lost else ''
    return _typed(fitting, kind), problem


def _typed(value: float, kind: str) -> bool | int | float:
    if kind == 'boolean':
        return bool(value)
    return int(value) if kind in INTEGERS else float(value)


def _signed(word: int, kind: str) -> int:
    word &= (1 << bits_of(kind)) - 1
    return word if word <= INTEGERS[kind][1] else word - (1 << bits_of(kind))
