"""ModbusLink: a connection to a Modbus TCP server, by pymodbus."""

from __future__ import annotations

import select
import socket
import struct
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from robots_controller.io.bridge.io_port import Arrival, Number
from robots_controller.io.plant.modbus.modbus_map import ModbusPlace, ModbusServer
from robots_controller.io.plant.plant_link import LinkError, library

if TYPE_CHECKING:
    from collections.abc import Iterator

    from robots_controller.io.bridge.place import Place

MOST_READ: Final = {'coil': 2000, 'discrete_input': 2000, 'holding_register': 125, 'input_register': 125}
MOST_WRITTEN: Final = {'coil': 1968, 'holding_register': 123}
"""Places of a request, by the protocol."""

REASONS: Final = {
    1: 'illegal function',
    2: 'illegal data address',
    3: 'illegal data value',
    4: 'device failure',
    5: 'acknowledged, still busy',
    6: 'device busy',
    8: 'memory parity error',
    10: 'gateway path unavailable',
    11: 'gateway target does not respond',
}
"""Of the protocol's exception codes."""

ILLEGAL_ADDRESS: Final = 2

_FORMATS: Final = {
    **{f'int{8 * size}': f'>{letter}' for size, letter in ((2, 'h'), (4, 'i'), (8, 'q'))},
    **{f'uint{8 * size}': f'>{letter}' for size, letter in ((2, 'H'), (4, 'I'), (8, 'Q'))},
    'float': '>f',
    'double': '>d',
}


@dataclass
class _Block:
    """Places that follow each other, read by one request; `due` is when, s."""

    places: list[ModbusPlace]
    period: float
    due: float = 0.0


class ModbusLink:
    """A connection to a Modbus TCP server.

    Args:
        server: The server.
        inputs: Places to read, and their periods, s.

    Raises:
        InvalidInputError: pymodbus is not installed.
    """

    def __init__(self, server: ModbusServer, inputs: Mapping[Any, float]) -> None:
        self._server = server
        self._library = library('pymodbus.client', 'pymodbus', 'modbus')
        self._modbus_error = library('pymodbus.exceptions', 'pymodbus', 'modbus').ModbusException
        self._client: Any = None
        self._receive: Callable[[Iterable[Arrival]], None] = lambda _: None
        self._blocks = [
            _Block(places, period)
            for period in sorted(set(inputs.values()))
            for places in _runs((place for place in inputs if inputs[place] == period), MOST_READ)
        ]

    def open(self, receive: Callable[[Iterable[Arrival]], None]) -> None:
        """Connect."""
        server, self._receive = self._server, receive
        self._client = self._library.ModbusTcpClient(
            server.host, port=server.tcp_port, timeout=server.response_timeout, retries=0
        )
        if not self._client.connect():
            raise LinkError(f'{server.host}:{server.tcp_port} cannot be reached')

    def close(self) -> None:
        """Disconnect."""
        if self._client is not None:
            self._client.close()

    def read(self, now: float) -> float:
        """Read the block that is due first: what is to be written waits for one slow answer, not for all."""
        if not self._blocks:
            self._check_open()
            return now + self._server.period
        block = min(self._blocks, key=lambda one: one.due)
        if block.due <= now:
            block.due = max(block.due, now - block.period) + block.period
            self._read_block(block)
        return min(one.due for one in self._blocks)

    def write(self, values: Mapping[Any, Number]) -> Mapping[Place, str]:
        """Write values; neighbours in one request."""
        refused: dict[Place, str] = {}
        for places in _runs(values, MOST_WRITTEN, sort=False):
            why = self._write(places, values)
            for place in places if why else ():
                # One that is refused refuses the whole request.
                if why := self._write([place], values) if len(places) > 1 else why:
                    refused[place] = why
        return refused

    def _read_block(self, block: _Block) -> None:
        first = block.places[0]
        size = _end(block.places) - first.address
        names = {'coil': 'coils', 'discrete_input': 'discrete_inputs'}
        read = getattr(self._client, f'read_{names.get(first.table, f"{first.table}s")}')
        with self._answering():
            answer = read(first.address, count=size, device_id=first.unit)
        if not answer.isError():
            held = answer.registers if first.table.endswith('register') else answer.bits
            self._receive([_arrival(place, held, place.address - first.address) for place in block.places])
        elif answer.exception_code == ILLEGAL_ADDRESS and len(block.places) > 1:
            # Some of them are there: each half is tried by itself from now on.
            middle = len(block.places) // 2
            self._blocks.remove(block)
            for places in (block.places[:middle], block.places[middle:]):
                self._blocks.append(_Block(places, block.period, block.due))
                self._read_block(self._blocks[-1])
        else:
            why = _reason(answer)
            self._receive([Arrival(place, problem=f'{place.text}: {why}') for place in block.places])

    def _write(self, places: Sequence[ModbusPlace], values: Mapping[Any, Number]) -> str:
        """Write neighbours; why they are refused, '' if they are not."""
        first = places[0]
        held: list[Any] = [one for place in places for one in _held(place, values[place])]
        several = len(held) > 1
        write = getattr(self._client, f'write_{first.table.removeprefix("holding_")}{"s" * several}')
        with self._answering():
            answer = write(first.address, held if several else held[0], device_id=first.unit)
        return _reason(answer) if answer.isError() else ''

    def _check_open(self) -> None:
        """Notice a server that has gone although nothing is read from it."""
        readable, _, _ = select.select([self._client.socket], [], [], 0.0)
        try:
            gone = bool(readable) and self._client.socket.recv(1, socket.MSG_PEEK) == b''
        except OSError:
            gone = True
        if gone:
            raise LinkError('the server has closed the connection')

    @contextmanager
    def _answering(self) -> Iterator[None]:
        if self._client.socket is None:  # pymodbus would connect again by itself
            raise LinkError('the connection is lost')
        try:
            yield
        except (self._modbus_error, OSError) as error:
            lost = 'no answer within' if 'No response' in str(error) else 'connection lost, response timeout'
            raise LinkError(f'{lost} {self._server.response_timeout:g} s') from error


def _held(place: ModbusPlace, value: Number) -> list[Any]:
    return [bool(value)] if place.table == 'coil' else encoded(place, value)


def encoded(place: ModbusPlace, value: Number) -> list[int]:
    """The registers of a value, the first first."""
    packed = struct.pack(_FORMATS[place.kind], value)
    words = [word for (word,) in struct.iter_unpack('>H', packed)]
    return words[::-1] if place.little else words


def decoded(place: ModbusPlace, words: Sequence[int]) -> int | float:
    """The value of registers, the first first."""
    packed = struct.pack(f'>{len(words)}H', *(words[::-1] if place.little else words))
    value: int | float
    (value,) = struct.unpack(_FORMATS[place.kind], packed)
    return value


def _arrival(place: ModbusPlace, held: Sequence[Any], start: int) -> Arrival:
    words = held[start : start + place.size]
    if len(words) < place.size:
        return Arrival(place, problem=f'{place.text} is missing in the answer')
    value = bool(words[0]) if place.kind == 'boolean' else decoded(place, words)
    return Arrival(place, value)


def _reason(answer: Any) -> str:
    code = answer.exception_code
    return f'exception {code}, {REASONS.get(code, "of no standard")}'


def _runs(
    places: Iterable[ModbusPlace], most: Mapping[str, int], *, sort: bool = True
) -> Iterator[list[ModbusPlace]]:
    """Places that follow each other without a gap, or overlap where they are read, as requests hold them."""
    ordered = sorted(places, key=lambda one: (one.unit, one.table, one.address)) if sort else list(places)
    run: list[ModbusPlace] = []
    for place in ordered:
        if run:
            first, end = run[0], _end(run)
            follows = place.address == end or (sort and place.address < end)
            same = (place.unit, place.table) == (first.unit, first.table)
            if not (same and follows and _end([*run, place]) - first.address <= most[first.table]):
                yield run
                run = []
        run.append(place)
    if run:
        yield run


def _end(places: Iterable[ModbusPlace]) -> int:
    return max(place.address + place.size for place in places)
