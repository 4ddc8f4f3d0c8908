"""opcua_node: the robot as an OPC UA server, by the companion specification for robotics."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any, Final

from robots_controller.nodes.ports.cell_reader import RATE, CellReader
from robots_controller.nodes.ports.program_link import ProgramLink
from robots_controller.opcua.server_settings import ServerSettings, read_server_settings
from robots_controller.pendant.pendant_state import PendantState
from robots_core.errors import InstallationError
from robots_core.ros.robot_node import PORTS, RobotNode
from robots_core.ros.running.run import run

PATIENCE: Final = 10.0  # s, for answers of the cell


class OpcuaNode(RobotNode):
    """Shows clients the state of the cell, and passes on the methods and outputs of those that may operate.

    Clients can do nothing that other nodes could not do over the same services.
    """

    diagnostics_group = 'plant'
    takes_part = False  # clients do not hold time

    def __init__(self, **options: Any) -> None:
        super().__init__('opcua_node', **options)
        port = self.parameter('port', 0, 'TCP port of the server, such as 4840; 0: no server', bounds=PORTS)
        host = self.parameter('host', '127.0.0.1', 'address to listen at; 127.0.0.1: this machine alone')
        access = self.parameter(
            'access', '', 'who may do what (YAML); empty: anyone may read, nobody operate'
        )
        folder = self.parameter('programs', 'programs', 'folder of the robot programs that can be loaded')
        self.state = PendantState()
        if port == 0:
            self.ready('ready; parameter port is 0, there is no server')
            return
        settings = read_server_settings(access) if access else ServerSettings()
        self._server = self._serve(settings, host, port, Path(folder).resolve())
        self.closing.callback(self._server.close)
        CellReader(self, self)
        self.create_timer(1.0 / RATE, lambda: self._server.update(self.state))
        self.journal.info(f'the robot is an OPC UA server at {self._server.url}')
        self.ready(url=self._server.url)

    def _serve(self, settings: ServerSettings, host: str, port: int, programs: Path) -> Any:
        try:
            from robots_controller.opcua.robot_server import RobotServer  # noqa: PLC0415
        except ImportError as error:
            raise InstallationError(
                f'the OPC UA server needs asyncua ({error}): make plant-requirements, or pip install asyncua'
            ) from error
        return RobotServer(
            self.robot,
            ProgramLink(self, PATIENCE),
            settings,
            programs=programs,
            host=host,
            tcp_port=port,
            log=self.journal.warning,
        )


main: Final = partial(run, OpcuaNode)
