"""opcua_node: clients see what the nodes of a cell report, and command them."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import pytest
from asyncua import ua

from opcua_client import Nodes, as_client
from plant_partners import DEADLINE, free_port
from robots_controller.nodes.opcua_node import OpcuaNode
from robots_controller.program.run_state import RunState
from robots_core.errors import InvalidInputError

from .program_cell import CRAWL, MOVE, ROBOT, ProgramCell

CONTROLLER = 'di:DeviceSet/MotionDeviceSystem/rob:Controllers/Controller'
MACHINE = f'{CONTROLLER}/rob:TaskControls/TaskControl/rob:TaskControlOperation/rob:TaskControlStateMachine'
CHANNELS = f'{CONTROLLER}/rob:Components/InputsAndOutputs/di:ParameterSet'
AXIS = f'di:DeviceSet/MotionDeviceSystem/rob:MotionDevices/{ROBOT}/rob:Axes/A1/di:ParameterSet'


USER = {'user': 'plc', 'password': 'secret'}


class ServedCell(ProgramCell):
    """A cell that is an OPC UA server too."""

    def __init__(self, runner: Any, folder: Path) -> None:
        super().__init__(runner, folder)
        (folder / 'password.txt').write_text('secret')
        access = folder / 'access.yaml'
        access.write_text(f'users: {{plc: {{password_file: {folder}/password.txt, operate: true}}}}')
        self.node = self.start_node(
            OpcuaNode,
            robot_model=ROBOT,
            port=free_port(),
            access=str(access),
            programs=str(folder),
        )

    def client(self, work: Any) -> Any:
        return asyncio.run(as_client(self.node._server.url, work, **USER))

    def until_state(self, state: RunState) -> None:
        self.wait(lambda: self.node.state.program.state is state, state)


@pytest.fixture(scope='module')
def cell(module_ros_nodes: Any, tmp_path_factory: pytest.TempPathFactory) -> ServedCell:
    return ServedCell(module_ros_nodes, tmp_path_factory.mktemp('programs'))


def test_a_client_loads_starts_and_stops_a_program_and_sees_the_robot_move(cell: ServedCell) -> None:
    (cell.folder / 'move.lua').write_text(CRAWL + MOVE)

    async def start(nodes: Nodes) -> None:
        assert await nodes.call(f'{MACHINE}/rob:LoadByName', 'move.lua') == 0
        assert await nodes.call(f'{MACHINE}/rob:Start') == 0
        async with asyncio.timeout(DEADLINE):
            while not await nodes.value(f'{AXIS}/rob:ActualSpeed'):
                pass
        assert await nodes.call(f'{MACHINE}/rob:Stop', ua.Variant(2, ua.VariantType.Int64)) == 0

    cell.client(start)
    cell.until_state(RunState.STOPPED)
    cell.until_standing()

    async def unload(nodes: Nodes) -> None:
        async with asyncio.timeout(DEADLINE):
            while await nodes.call(f'{MACHINE}/rob:UnloadProgram') != 0:  # the motion is still ending
                pass
        assert await nodes.call(f'{MACHINE}/rob:UnloadProgram') == 1

    cell.client(unload)
    cell.until_state(RunState.IDLE)


def test_a_client_writes_outputs(cell: ServedCell) -> None:
    async def write(nodes: Nodes) -> None:
        await nodes.write(f'{CHANNELS}/digital_output.3', value=True, kind=ua.VariantType.Boolean)

    cell.wait(lambda: cell.node.state.io.values.get('digital_outputs'), 'the outputs')
    cell.node._server.update(cell.node.state)
    cell.client(write)
    cell.wait(lambda: cell.outputs and cell.outputs[-1][2] == 1, 'the output')


def test_a_host_that_is_not_this_machines_is_refused_at_the_start(cell: ServedCell) -> None:
    with pytest.raises(InvalidInputError, match='cannot serve at host'):
        cell.start_node(OpcuaNode, robot_model=ROBOT, port=free_port(), host='192.0.2.1')
