"""IoBridge: inputs from the places of an I/O map, outputs to them, with their fail-safe values."""

import math
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Final, Protocol

from robots_controller.io.bridge.io_port import Arrival, IoPort, Number, Place
from robots_controller.io.fail_safe import FailSafe, safe_value
from robots_controller.io.io_conversion import InputValue, check_kind, to_field
from robots_controller.io.io_image import Channel
from robots_controller.io.io_map import IoMap, IoRow
from robots_core.errors import InvalidInputError

LOG_AGAIN: Final = 5.0  # s
WRITER: Final = 'lua_program_node'
LOST: Final = f'{WRITER} gives no sign of life'
LEFT: Final = f'{WRITER} gave no sign of life for some time, and has not switched it since'


class Outputs(Protocol):
    """The robot's outputs, as their images bring them."""

    def value(self, channel: Channel) -> float | None:
        """Value of an output; None where it is unknown."""

    def absent_for(self, channel: Channel, now: float) -> float:
        """Time since the newest image of the channel, s."""


class Problems:
    """What is wrong now, by keys; a problem that comes and goes is logged at most once in `LOG_AGAIN`."""

    def __init__(self, log: Callable[[str], None]) -> None:
        self._log = log
        self._now: dict[str, str] = {}
        self._logged: dict[str, tuple[float, int]] = {}  # when (s), and how often since
        self.count = 0
        """Values that were lost."""

    def __str__(self) -> str:
        return '; '.join(self._now.values())

    def set(self, key: str, problem: str, now: float, *, lost: int = 0) -> None:
        """Set or, with '', clear the problem of a key, by which so many values were lost."""
        if not problem:
            self._now.pop(key, None)
            return
        self.count += lost
        fresh = key not in self._now
        self._now[key] = problem
        last, times = self._logged.get(key, (-LOG_AGAIN, 0))
        if fresh and now - last >= LOG_AGAIN:
            self._log(f'{problem} ({times} times more before)' if times else problem)
            self._logged[key] = now, 0
        elif lost or fresh:
            self._logged[key] = last, times + (lost or 1)

    def replace(self, prefix: str, problems: Mapping[str, str], now: float) -> None:
        """Set all problems of one origin, whose keys have a prefix; those that it has no more are cleared."""
        for key in [key for key in self._now if key.startswith(prefix)]:
            if key.removeprefix(prefix) not in problems:
                self.set(key, '', now)
        for key, problem in problems.items():
            self.set(prefix + key, problem, now)


class IoBridge:
    """Values between the robot's channels and the ports of a map; the time is handed in.

    Args:
        ports: The partners of all rows, by `Place.port`.
        fail_safe: Values of outputs for which no running program answers.
        log: Logs a warning.
    """

    def __init__(
        self,
        io_map: IoMap,
        ports: Mapping[str, IoPort],
        fail_safe: FailSafe,
        log: Callable[[str], None],
        now: float,
    ) -> None:
        self._ports = ports
        self._fail_safe = fail_safe
        self._stopping = frozenset(io_map.emergency_stop)
        self.problems = Problems(log)
        self._inputs: dict[Place, list[InputValue]] = {}
        for row in io_map.inputs:
            self._inputs.setdefault(row.place, []).append(InputValue(row, now))
        self.unknown: dict[Channel, str] = {}
        """Emergency stops that have no value of the PLC, and why, for a person."""
        self.next_time = now
        """When an input may change without an arrival, s; infinite for never."""
        self._outputs: dict[Place, list[IoRow]] = {}
        for row in io_map.outputs:
            self._outputs.setdefault(row.place, []).append(row)
        self._kinds = {place: ports[place.port].kind(place) for place in (*self._inputs, *self._outputs)}
        self._sent: dict[Place, Number] = {}
        self.left: set[str] = set()
        """Outputs that a lost program's node has not put to their fail-safe values itself."""

    # -- inputs -----------------------------------------------------------------------------------

    def take_inputs(self, now: float) -> Iterator[tuple[Channel, float]]:
        """Take what came since the last call; the values of the inputs that may have changed."""
        touched: list[InputValue] = []
        for name, port in self._ports.items():
            for arrival in port.arrivals():
                touched += self._receive(arrival, now)
            lost = port.lost()
            flood = f'{name}: values came faster than they could be taken; at least {lost} lost'
            self.problems.set(f'flood {name}', flood if lost else '', now, lost=lost)
            self.problems.replace(f'port {name} ', port.problems(), now)
        if now >= self.next_time:
            self.next_time = math.inf
            touched = [value for values in self._inputs.values() for value in values]
        for value in touched:
            yield value.row.channel, value.update(now)
            self._check_silence(value, now)
            self.next_time = min(self.next_time, value.next_time(now))

    def places(self) -> Iterator[tuple[Channel, Place, float]]:
        """Where channels stand, and when their sources say that they measured them, s since 1970 or NaN."""
        for values in self._inputs.values():
            for value in values:
                yield value.row.channel, value.row.place, value.stamp
        for rows in self._outputs.values():
            for row in rows:
                yield row.channel, row.place, math.nan

    def _receive(self, arrival: Arrival, now: float) -> list[InputValue]:
        values = self._inputs.get(arrival.place, [])
        for value in values:
            name, problem = value.row.channel.name, arrival.problem
            if not problem:
                try:
                    check_kind(value.row, arrival.value, self._kinds[arrival.place])
                    value.receive(arrival.value, now, arrival.stamp)
                except InvalidInputError as error:
                    problem = error.message
            if problem:
                problem = f'{arrival.place.port}: {problem}; {name} keeps its value'
            self.problems.set(f'value {name}', problem, now, lost=bool(problem))
        return values

    def _check_silence(self, value: InputValue, now: float) -> None:
        row, problem = value.row, ''
        if row.channel.name in self._stopping:
            if why := value.unknown(now):
                self.unknown[row.channel] = why
            else:
                self.unknown.pop(row.channel, None)
        if value.silent(now):
            problem = (
                f'{row.place.source} has been silent for {row.timeout:g} s; {row.channel.name} is at its '
                f'fail-safe value {row.fail_safe:g}'
            )
        self.problems.set(f'silence {row.channel.name}', problem, now)

    # -- outputs ----------------------------------------------------------------------------------

    def send_outputs(self, outputs: Outputs, now: float, *, lost: bool) -> None:
        """Send the places whose values have changed; `lost` if the program's node gives no sign of life."""
        self._send(lambda row: self._output(row, outputs, now, lost=lost), now)

    def make_safe(self, outputs: Outputs, now: float) -> None:
        """Send the fail-safe values."""
        self._send(
            lambda row: (safe_value(self._fail_safe, row.channel, outputs.value(row.channel)), ''), now
        )

    def repetitions(self) -> Iterator[tuple[float, Callable[[], None]]]:
        """What is to be called in which period (s), to send again what has not changed."""
        found: dict[tuple[str, float], list[Place]] = {}
        for place, rows in self._outputs.items():
            found.setdefault((place.port, min(row.period for row in rows)), []).append(place)
        for (port, period), places in found.items():
            if period < math.inf:
                yield period, partial(self._repeat, port, places)

    def _repeat(self, port: str, places: list[Place]) -> None:
        if again := {place: self._sent[place] for place in places if place in self._sent}:
            self._ports[port].send(again)

    def _send(self, value_of: Callable[[IoRow], tuple[float | None, str]], now: float) -> None:
        changed: dict[str, dict[Place, Number]] = {}
        for place, rows in self._outputs.items():
            field: Number | None = self._sent.get(place, 0)
            for row in rows:
                value, problem = value_of(row)
                if value is None or field is None:
                    field = None  # a made-up value must not switch anything
                    continue
                field, cut = to_field(row, value, self._kinds[place], field)
                self.problems.set(f'output {row.file}:{row.line}', problem or cut, now)
            if field is not None and (place not in self._sent or field != self._sent[place]):
                changed.setdefault(place.port, {})[place] = self._sent[place] = field
        for port, values in changed.items():
            self._ports[port].send(values)

    def _output(self, row: IoRow, outputs: Outputs, now: float, *, lost: bool) -> tuple[float | None, str]:
        channel = row.channel
        value, absent = outputs.value(channel), outputs.absent_for(channel, now) >= row.timeout
        safe = safe_value(self._fail_safe, channel, value)
        if lost and safe != value:
            self.left.add(channel.name)
        elif safe == value:
            # The node has put it there itself; one that froze must not switch it on again before.
            self.left.discard(channel.name)
        if not (lost or absent or channel.name in self.left):
            return value, ''
        why = LOST if lost else LEFT
        if absent:
            why = f'{channel.image} was not published for {row.timeout:g} s'
        return safe, f'{why}; {channel.name} is at its fail-safe value'
