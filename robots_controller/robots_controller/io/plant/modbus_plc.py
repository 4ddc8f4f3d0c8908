"""ModbusPlc: a PLC as a Modbus TCP server.

Digital inputs of the robot are discrete inputs, digital outputs coils; analog inputs are input registers,
analog outputs holding registers, two for each number (float32, the high word first). Channel 1 is at
address 0.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any, Final

from robots_controller.io.io_image import Channel
from robots_controller.io.plant.loop_thread import LoopThread
from robots_controller.io.plant.modbus import ModbusPlace, decoded, encoded
from robots_controller.io.plant.plant_link import library
from robots_controller.io.plant.plc_server import HOST, OnWritten, check_port, served_sizes

DISCRETE_INPUT, INPUT_REGISTER = 2, 4
"""Codes that read them."""
COILS, REGISTERS = (5, 15), (6, 16)
"""Codes that write them."""
NUMBER: Final = ModbusPlace('', 'float', 0, 'input_register', 0)
WORDS: Final = NUMBER.size
"""Registers of a number."""


class ModbusPlc:
    """See `PlcServer`."""

    def __init__(self, channels: Iterable[Channel], port: int, on_written: OnWritten) -> None:
        self._on_written = on_written
        server = library('pymodbus.server', 'pymodbus', 'modbus')
        check_port('Modbus', port)
        self._codes = library('pymodbus.constants', 'pymodbus', 'modbus').ExcCodes
        self._sizes = served_sizes(channels)
        self._holding = [0] * (WORDS * self._sizes['analog_outputs'])
        self._thread = LoopThread('Modbus PLC')
        self._server = self._thread.wait(self._open(server.ModbusTcpServer, port))

    async def _open(self, server_type: Any, port: int) -> Any:
        simulator = library('pymodbus.simulator', 'pymodbus', 'modbus')
        kinds = simulator.DataType

        def table(image: str) -> list[Any]:
            size = self._sizes[image]
            if image.startswith('digital'):
                return [simulator.SimData(0, count=size, values=False, datatype=kinds.BITS)]
            return [simulator.SimData(0, count=WORDS * size, values=0, datatype=kinds.REGISTERS)]

        tables = tuple(map(table, ('digital_outputs', 'digital_inputs', 'analog_outputs', 'analog_inputs')))
        device = simulator.SimDevice(0, simdata=tables, action=self._on_request)  # of any unit
        server = server_type(device, address=(HOST, port))
        await server.serve_forever(background=True)
        return server

    def set(self, values: Mapping[Channel, float]) -> None:
        """See `PlcServer`."""
        self._thread.wait(self._set(values))

    async def _set(self, values: Mapping[Channel, float]) -> None:
        for channel, value in values.items():
            if channel.kind == 'digital':
                await self._server.async_setValues(0, DISCRETE_INPUT, channel.index - 1, [bool(value)])
            else:
                first = WORDS * (channel.index - 1)
                await self._server.async_setValues(0, INPUT_REGISTER, first, encoded(NUMBER, value))

    async def _on_request(
        self, code: int, _start: int, address: int, _count: int, _now: list[int], values: list[Any] | None
    ) -> Any:
        if not values:
            return None
        if code in COILS:
            for index, value in enumerate(values, address + 1):
                self._on_written(f'digital_output.{index}', float(bool(value)))
        elif code in REGISTERS:
            holding = [*self._holding]
            holding[address : address + len(values)] = [int(value) for value in values]
            touched = range(address // WORDS, (address + len(values) - 1) // WORDS + 1)
            numbers = {
                index + 1: decoded(NUMBER, holding[WORDS * index : WORDS * (index + 1)]) for index in touched
            }
            if not all(map(math.isfinite, numbers.values())):
                return self._codes.ILLEGAL_VALUE
            self._holding = holding
            for index, number in numbers.items():
                self._on_written(f'analog_output.{index}', number)
        return None

    def close(self) -> None:
        """See `PlcServer`."""
        if not self._thread.closed:
            self._thread.wait(self._server.shutdown())
            self._thread.close()
