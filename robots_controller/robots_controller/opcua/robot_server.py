"""RobotServer: an OPC UA server with the nodes of a robot, in a thread of its own."""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

from asyncua import Server, ua
from asyncua.common.callback import CallbackType
from asyncua.crypto.security_policies import SecurityPolicyFactory, SecurityPolicyNone

from robots_controller.io.plant.credentials import application_uri, read_credential
from robots_controller.io.plant.loop_thread import CLOSE_TIMEOUT, LoopThread
from robots_controller.io.plant.opcua import MODES, POLICIES
from robots_controller.io.plant.opcua_frames import start_guarded
from robots_controller.opcua.address_space.node_writer import NAMESPACE
from robots_controller.opcua.address_space.robot_nodes import RobotNodes
from robots_controller.opcua.server_access import NOBODY, ServerAccess
from robots_controller.opcua.server_settings import ServerSettings
from robots_controller.opcua.task_control import TaskControl
from robots_controller.pendant.pendant_port import ProgramPort
from robots_controller.pendant.pendant_state import PendantState
from robots_core.errors import InvalidInputError
from robots_core.free_port import free_port
from robots_core.garbage import garbage_kept
from robots_core.robot_model.base_robot_model import BaseRobotModel


class RobotServer:
    """Listens until it is closed; `log` is called in any thread.

    Raises:
        InvalidInputError: a port that is taken, a host that this machine does not have, or certificates that
            cannot be read.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        port: ProgramPort,
        settings: ServerSettings,
        *,
        programs: Path,
        host: str,
        tcp_port: int,
        log: Callable[[str], object],
    ) -> None:
        settings.check_host(host)
        if (free := free_port(host, tcp_port)) != tcp_port:
            raise InvalidInputError(
                f'port {tcp_port} of {host} is taken by another server; {free} is free', port=tcp_port
            )
        # What matters of its messages is answered to the client, or raised here.
        logging.getLogger('asyncua').setLevel(logging.CRITICAL)
        self.url: Final = f'opc.tcp://{host}:{tcp_port}'
        self._robot, self._port, self._settings, self._log = robot, port, settings, log
        self._programs = programs
        self._access = ServerAccess(settings, log)
        self._state = PendantState()
        self._control = TaskControl(port, programs, lambda: self._state, log)
        self._thread = LoopThread('OPC UA')
        self._server: Server | None = None
        self._updating: Any = None
        try:
            self._thread.wait(self._open())
        except BaseException:
            self.close()
            raise

    def update(self, state: PendantState) -> None:
        """Show a state; one that comes while the one before is still being written is left out."""
        self._state = state
        if self._updating is None or self._updating.done():
            if self._updating is not None:
                self._updating.result()  # raises what has gone wrong
            self._updating = self._thread.post(self._nodes.update(state))

    def close(self) -> None:
        """Disconnect all clients, and end the thread."""
        server, self._server = self._server, None
        if server is not None:
            self._thread.wait(server.stop(), CLOSE_TIMEOUT)
        self._thread.close()

    async def _open(self) -> None:
        server = Server(user_manager=self._access)
        with garbage_kept():  # thousands of nodes of the specifications
            await server.init()
        server.set_endpoint(self.url)
        server.set_server_name(f'Robots: {self._robot.name}')
        settings, policies = self._settings, [ua.SecurityPolicyType.NoSecurity]
        server.set_identity_tokens(self._access.identity_tokens)
        if settings.certificate:
            await self._load_certificate(server)
            policies = [
                ua.SecurityPolicyType[f'{POLICIES[name].removeprefix("SecurityPolicy")}_{mode}']
                for name in settings.security
                for mode in MODES.values()
            ]
            # Without encryption, endpoints can be asked for and nothing else; asyncua would permit all.
            discovery = SecurityPolicyFactory(
                SecurityPolicyNone, ua.MessageSecurityMode.None_, permission_ruleset=NOBODY
            )
            server._policies.append(discovery)  # noqa: SLF001
            server.set_certificate_validator(self._access.check_certificate)
        server.set_security_policy(policies, permission_ruleset=self._access)
        namespace = await server.register_namespace(NAMESPACE)
        self._nodes = RobotNodes(
            server,
            namespace,
            self._robot,
            settings.nameplate,
            programs=self._programs,
            control=self._control,
        )
        await self._nodes.build()
        server.subscribe_server_callback(CallbackType.PostWrite, self._on_written)
        await start_guarded(server)
        self._server = server

    async def _load_certificate(self, server: Server) -> None:
        settings = self._settings
        for path, what in ((settings.certificate, 'certificate'), (settings.key, 'key')):
            read_credential(path, what)
        try:
            await server.load_certificate(settings.certificate)
            await server.load_private_key(settings.key)
            uri = application_uri(settings.certificate)
        except Exception as error:
            raise InvalidInputError(
                f'certificate {settings.certificate} or key {settings.key} cannot be read: {error!r}; valid '
                f'are DER and PEM'
            ) from error
        if uri:
            await server.set_application_uri(uri)

    async def _on_written(self, event: Any, _service: Any) -> None:
        if event.is_external:
            nodes, answers = event.request_params.NodesToWrite, event.response_params
            for text in await self._nodes.channels.take_written(self._port, nodes, answers):
                self._log(f'refused to write {text}')
