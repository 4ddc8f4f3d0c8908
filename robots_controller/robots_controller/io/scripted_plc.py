"""ScriptedPlc: plays a PlcScript against outputs; the time is handed in."""

import heapq
import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final

from robots_controller.io.io_image import Channel
from robots_controller.io.plc_script import PlcRule, PlcScript
from robots_core.errors import InvalidInputError

# Rules that trigger each other without any time between them would never end.
MOST_AT_ONCE: Final = 1000
SHOWN: Final = 60  # characters of a text that is refused


@dataclass(frozen=True)
class InputChange:
    """An input that the PLC set to another value, and when, s."""

    time: float
    channel: Channel
    value: float


Pending = tuple[tuple[float, int, Mapping[str, float]], ...]
"""When (s), the line of the rule, and inputs by name with their new values."""


@dataclass(frozen=True)
class _Due:
    settings: tuple[tuple[Channel, float], ...]
    rule: PlcRule
    reverts: bool = False  # after the duration of the rule


class ScriptedPlc:
    """Steps a script from change to change; the same outputs at the same times give the same inputs.

    What is due is done in the order of time, and at the same time in the order in which it was triggered.
    Times count from the trigger itself, not from the step in which it was noticed. Outputs are read as a PLC
    reads them: `output` collects their changes, and the next step acts on each in turn.
    """

    def __init__(self, script: PlcScript, start: float = 0.0) -> None:
        self._script = script
        self._now = start
        self._count = 0
        self._due: list[tuple[float, int, _Due]] = []
        self._values: dict[Channel, float] = dict.fromkeys(script.channels, 0.0) | dict(script.initial)
        self._changes: list[InputChange] = []
        self.outputs = tuple(channel for channel in script.channels if channel.direction == 'output')
        """Outputs of the robot that the script reads."""
        self._read = {channel.name: (channel, 0.0) for channel in self.outputs}
        self._collected: list[tuple[Channel, float]] = []
        for rule in script.rules:
            if rule.event is None:
                first = start if rule.period == math.inf else start + rule.period
                self._schedule(first, _Due((), rule))

    @property
    def inputs(self) -> Mapping[Channel, float]:
        """Values of the inputs that the script sets."""
        return {channel: self._values[channel] for channel in self._script.inputs}

    @property
    def next_time(self) -> float:
        """When the PLC acts by itself, s; 0 while a change of an output waits, infinite for never."""
        if self._collected:
            return 0.0
        return self._due[0][0] if self._due else math.inf

    @property
    def pending(self) -> Pending:
        """What the PLC will do by itself, unless outputs change that, in the order of time."""
        found = []
        for time, _, due in self._due:
            when, settings = (
                (time, due.settings) if due.settings else (time + due.rule.after, due.rule.settings)
            )
            found.append((when, due.rule.line, {channel.name: value for channel, value in settings}))
        return tuple(sorted(found, key=lambda one: one[0]))

    def output(self, name: str, value: float) -> None:
        """Take the value of an output such as 'digital_output.1'; outputs of no rule are ignored."""
        channel, last = self._read.get(name, (None, value))
        if channel is not None and value != last:
            self._read[name] = (channel, value)
            self._collected.append((channel, value))

    def step(self, now: float) -> list[InputChange]:
        """Do what was due up to now, then act on the changes of outputs that were collected.

        Returns:
            The inputs that changed, in order; one may change several times.

        Raises:
            InvalidInputError: a time before the last step, or rules that trigger each other without end.
        """
        if not now >= self._now:
            raise InvalidInputError(f'now = {now} s is before the last step at {self._now} s')
        self._changes = []
        self._do_until(now)
        self._now = now
        collected, self._collected = self._collected, []
        for channel, value in collected:
            self._set(now, channel, value)
            self._do_until(now)
        return self._changes

    def _do_until(self, now: float) -> None:
        at, done = -math.inf, 0
        while self._due and self._due[0][0] <= now:
            time, _, due = heapq.heappop(self._due)
            at, done = time, done + 1 if time == at else 0
            if done > MOST_AT_ONCE:
                raise InvalidInputError(
                    f'rules trigger each other without end at {time:g} s; give one of them a time after'
                )
            if not due.settings:
                self._trigger(time, due.rule)
                if due.rule.period < math.inf:
                    self._schedule(time + due.rule.period, due)
                continue
            self._apply(time, due)

    def _apply(self, time: float, due: _Due) -> None:
        before = tuple((channel, self._values[channel]) for channel, _ in due.settings)
        for channel, value in due.settings:
            self._set(time, channel, value)
        if not due.reverts and due.rule.duration < math.inf:
            self._schedule(time + due.rule.duration, _Due(before, due.rule, reverts=True))

    def _set(self, time: float, channel: Channel, value: float) -> None:
        before, self._values[channel] = self._values[channel], value
        if before == value:
            return
        if channel.direction == 'input':
            self._changes.append(InputChange(time, channel, value))
        for rule in self._script.rules:
            if rule.event and rule.event.channel == channel and rule.event.occurs(before, value):
                self._trigger(time, rule)

    def _trigger(self, time: float, rule: PlcRule) -> None:
        if all(condition.holds(self._values[condition.channel]) for condition in rule.conditions):
            self._schedule(time + rule.after, _Due(rule.settings, rule))

    def _schedule(self, time: float, due: _Due) -> None:
        self._count += 1
        heapq.heappush(self._due, (time, self._count, due))


def pending_as_text(changes: Pending, start: float) -> str:
    """Changes as JSON; `start` is when their clock was 0 s, on the clock of the message."""
    return json.dumps([[start + time, line, inputs] for time, line, inputs in changes])


def pending_from_text(text: str, start: float) -> Pending:
    """Inverse of `pending_as_text`.

    Raises:
        InvalidInputError: text of another form.
    """
    try:
        return tuple(_pending(json.loads(text), start))
    except (ValueError, TypeError, AttributeError, RecursionError, OverflowError):
        raise InvalidInputError(f'pending = {text[:SHOWN]!r} is no list of [time, line, inputs]') from None


def _pending(rows: Any, start: float) -> Iterator[tuple[float, int, Mapping[str, float]]]:
    for time, line, inputs in rows:
        numbers = {str(name): float(value) for name, value in inputs.items()}
        if not all(map(math.isfinite, (time, *numbers.values()))):
            raise ValueError
        yield time - start, int(line), numbers
