"""Modbus TCP in an I/O map: servers, coils and registers as places, and the connection, by pymodbus."""

from __future__ import annotations

import select
import socket
import struct
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Final, Self

from robots_controller.io.bridge.io_port import Arrival, Number, Place, PlantPlace
from robots_controller.io.io_image import Channel
from robots_controller.io.number_kinds import KINDS
from robots_controller.io.plant.plant_link import LinkError, library
from robots_core.files.yaml_section import YamlSection

TABLES: Final = ('coil', 'discrete_input', 'holding_register', 'input_register')
WRITABLE: Final = ('coil', 'holding_register')
LAST_ADDRESS: Final = 65535
_FORMATS: Final = {
    **{f'int{8 * size}': f'>{letter}' for size, letter in ((2, 'h'), (4, 'i'), (8, 'q'))},
    **{f'uint{8 * size}': f'>{letter}' for size, letter in ((2, 'H'), (4, 'I'), (8, 'Q'))},
    'float': '>f',
    'double': '>d',
}
WORDS: Final = {kind: struct.calcsize(packed) // 2 for kind, packed in _FORMATS.items()}
"""Registers of each type that they can hold."""

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


@dataclass(frozen=True)
class ModbusServer:
    """A Modbus TCP server.

    Attributes:
        port: As of its places.
        unit: Unit of places that name none.
        period: How often it is read, where a row does not say, s.
        response_timeout: For connecting and for each answer, s.
    """

    port: str
    host: str
    tcp_port: int = 502
    unit: int = 1
    period: float = 0.1
    response_timeout: float = 1.0

    @classmethod
    def read(cls, section: YamlSection, port: str) -> Self:
        """An entry of the section `modbus`."""
        return cls(
            port,
            section.text('host'),
            section.whole('port', 502, low=1, high=65535),
            section.whole('unit', 1, low=0, high=255),
            section.number('period', 0.1, low=0.001, high=3600.0),
            section.number('response_timeout', 1.0, low=0.01, high=60.0),
        )

    def read_place(self, item: YamlSection, channel: Channel) -> ModbusPlace:
        """The keys below `modbus` of a row."""
        tables = [table for table in TABLES if table in item]
        if len(tables) != 1:
            raise item.error(
                f'modbus needs one of {", ".join(TABLES)}; here are {", ".join(tables) or "none"}'
            )
        (table,) = tables
        if channel.direction == 'output' and table not in WRITABLE:
            raise item.error(f'{table} cannot be written; outputs go to {" or ".join(WRITABLE)}', table)
        kind, little = 'boolean', False
        if table.endswith('register'):
            names = [name for name, kind in KINDS.items() if kind in WORDS]
            kind = KINDS[item.text('type', 'uint16', among=names)]
            little = item.text('word_order', 'big', among=('big', 'little')) == 'little'
        else:
            for key in ('type', 'word_order'):
                if key in item:
                    raise item.error(f'{key} is for registers; {table} is one bit', key)
        unit = item.whole('unit', self.unit, low=0, high=255)
        address = item.whole(table, low=0, high=LAST_ADDRESS + 1 - WORDS.get(kind, 1))
        return ModbusPlace(self.port, kind, unit, table, address, little)

    def link(self, inputs: Mapping[Any, float], _outputs: Iterable[Any]) -> ModbusLink:
        """See `ModbusLink`."""
        return ModbusLink(self, inputs)


@dataclass(frozen=True)
class ModbusPlace(PlantPlace):
    """A coil or discrete input, which is 'boolean', or one or several registers, of a kind in `WORDS`.

    Attributes:
        table: One of `TABLES`.
        address: Counted from 0, as in the protocol.
        little: The register with the lowest bits comes first, where there are several.
    """

    unit: int
    table: str
    address: int
    little: bool = False

    @property
    def text(self) -> str:
        """Table and address."""
        return f'{self.table} {self.address} of unit {self.unit}'

    @property
    def cells(self) -> tuple[str, ...]:
        """All its coils or registers."""
        return tuple(f'{self.unit} {self.table} {self.address + n}' for n in range(self.size))

    @property
    def size(self) -> int:
        """How many coils or registers it takes."""
        return WORDS.get(self.kind, 1)


@dataclass
class _Block:
    """Places that follow each other, read by one request; `due` is when, s."""

    places: list[ModbusPlace]
    period: float
    due: float = 0.0


class ModbusLink:
    """A connection to a Modbus TCP server; see `PlantLink`."""

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
