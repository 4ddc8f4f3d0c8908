"""Modbus in an I/O map: servers, and coils and registers as places."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Self

from robots_controller.io.bridge.place import PlantPlace
from robots_controller.io.io_image import Channel
from robots_controller.io.number_kinds import INTEGERS, KINDS
from robots_core.files.yaml_section import YamlSection

TABLES: Final = ('coil', 'discrete_input', 'holding_register', 'input_register')
WRITABLE: Final = ('coil', 'holding_register')
LAST_ADDRESS: Final = 65535
WORDS: Final = {
    **{
        kind: max(1, (high - low).bit_length() // 16)
        for kind, (low, high) in INTEGERS.items()
        if '8' not in kind
    },
    'float': 2,
    'double': 4,
}
"""Registers of each type that they can hold."""


@dataclass(frozen=True)
class ModbusServer:
    """A Modbus TCP server.

    Attributes:
        port: As of its places.
        host: Its address.
        tcp_port: Its port.
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
        """An entry of the section `modbus`.

        Raises:
            InvalidInputError: a key is missing or not valid; with file and line.
        """
        return cls(
            port,
            section.text('host'),
            section.whole('port', 502, low=1, high=65535),
            section.whole('unit', 1, low=0, high=255),
            section.number('period', 0.1, low=0.001, high=3600.0),
            section.number('response_timeout', 1.0, low=0.01, high=60.0),
        )

    def read_place(self, item: YamlSection, channel: Channel) -> ModbusPlace:
        """The keys below `modbus` of a row.

        Raises:
            InvalidInputError: a key is missing or not valid, or not for outputs; with file and line.
        """
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


@dataclass(frozen=True)
class ModbusPlace(PlantPlace):
    """A coil or discrete input, which is 'boolean', or one or several registers, of a kind in `WORDS`.

    Attributes:
        unit: Unit of the server.
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
