"""The robot's OPC UA server with a test in the place of the cell, and paths of its nodes."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from opcua_client import as_client
from plant_partners import free_port
from robots_controller.io.io_image import Channel
from robots_controller.opcua.robot_server import RobotServer
from robots_controller.opcua.server_settings import ServerSettings
from robots_controller.pendant.pendant_state import PendantState, ShownIo, ShownProgram
from robots_controller.program.run_state import RunState
from robots_core import load_robot_model
from robots_core.blocks.multibody.payload import Payload
from robots_core.cell_interface.operating_modes import Commander, OperatingMode
from robots_core.errors import RobotsError

ROBOT = load_robot_model('kuka_kr210_r2700')
SYSTEM = 'di:DeviceSet/MotionDeviceSystem'
DEVICE = f'{SYSTEM}/rob:MotionDevices/kuka_kr210_r2700'
CONTROLLER = f'{SYSTEM}/rob:Controllers/Controller'
TASK = f'{CONTROLLER}/rob:TaskControls/TaskControl'
MACHINE = f'{TASK}/rob:TaskControlOperation/rob:TaskControlStateMachine'
CHANNELS = f'{CONTROLLER}/rob:Components/InputsAndOutputs/di:ParameterSet'
SAFETY = f'{SYSTEM}/rob:SafetyStates/SafetyState'

STATE = PendantState(
    lost=(),
    mode=OperatingMode.T1,
    commander=Commander.PROGRAM,
    drives_on=True,
    override=0.5,
    q=ROBOT.home,
    q_dot=0.1 * np.arange(6.0),
    torque=0.5 * ROBOT.axes_data.effort,
    payload=Payload(80.0, np.array([0.1, 0.0, 0.2])),
    program=ShownProgram('/cell/welding.lua', RunState.OPENED),
    io=ShownIo(
        {'digital_inputs': (1.0, 0.0), 'digital_outputs': (0.0, 1.0), 'analog_outputs': (2.5,)},
        {'digital_outputs': ('gripper', '')},
    ),
)


class Cell:
    """What clients command; the test is the cell."""

    def __init__(self) -> None:
        self.calls: list[Any] = []
        self.error: RobotsError | None = None

    def _call(self, what: Any) -> None:
        if self.error is not None:
            raise self.error
        self.calls.append(what)

    def call(self, service: str) -> str:
        self._call(service)
        return ''

    def open_program(self, path: str) -> None:
        self._call(Path(path).name)

    def set_io(self, channel: Channel, value: float) -> None:
        self._call((channel.name, value))


class Served:
    """A server, and clients of it."""

    def __init__(self, settings: ServerSettings, programs: Path) -> None:
        self.cell, self.told = Cell(), []  # type: ignore[var-annotated]
        self.programs = programs
        self.port = free_port()
        self.server = RobotServer(
            ROBOT,
            self.cell,
            settings,
            programs=programs,
            host='127.0.0.1',
            tcp_port=self.port,
            log=self.told.append,
        )
        self.keys: dict[str, tuple[str, str]] = {}

    def renewed(self, **changes: Any) -> Served:
        """The same without what was called and told before."""
        self.cell.calls, self.cell.error = [], None
        self.told.clear()
        self.show(**changes)
        return self

    def show(self, **changes: Any) -> None:
        """Show a state."""
        self.server.update(replace(STATE, **changes))
        self.server._updating.result(60.0)

    def client(
        self,
        work: Callable[[Any], Coroutine[Any, Any, Any]],
        *,
        user: str = '',
        password: str = '',
        key: str = '',
    ) -> Any:
        """What a client finds out."""

        return asyncio.run(
            as_client(
                self.server.url,
                work,
                user=user,
                password=password,
                application=key,
                files=self.keys.get(key),
            )
        )
