"""An editor that debugs a robot program, and the program that it debugs."""

from __future__ import annotations

import itertools
import json
import socket
from functools import partial
from pathlib import Path
from typing import Any

from cell_double import CellDouble
from robots_controller.editor.debug_adapter_server import HOST, DebugAdapterServer
from robots_controller.interpreter.lua_program import LuaProgram

DEADLINE = 120.0  # s
TOKEN = 'the token'  # noqa: S105


class Editor:
    """Speaks the protocol with nothing but a socket and JSON."""

    def __init__(self, port: int) -> None:
        self.socket = socket.create_connection((HOST, port), timeout=DEADLINE)
        self.stream = self.socket.makefile('rb')
        self.events: list[dict[str, Any]] = []
        self.numbers = itertools.count(1)

    def send(self, command: str, **arguments: object) -> int:
        number = next(self.numbers)
        self.send_raw(
            json.dumps(
                {'seq': number, 'type': 'request', 'command': command, 'arguments': arguments}
            ).encode()
        )
        return number

    def send_raw(self, data: bytes) -> None:
        self.socket.sendall(b'Content-Length: %d\r\n\r\n%b' % (len(data), data))

    def receive(self) -> dict[str, Any]:
        header = self.stream.readline()
        assert header.startswith(b'Content-Length: '), header
        assert self.stream.readline() == b'\r\n'
        return json.loads(self.stream.read(int(header.split()[1])))

    def ask(self, command: str, **arguments: object) -> dict[str, Any]:
        """The response; events that come before it are kept."""
        number = self.send(command, **arguments)
        while True:
            message = self.receive()
            if message['type'] == 'response':
                assert message['request_seq'] == number
                assert message['command'] == command
                return message
            self.events.append(message)

    def do(self, command: str, **arguments: object) -> dict[str, Any]:
        response = self.ask(command, **arguments)
        assert response['success'], response
        return response.get('body', {})

    def wait_for(self, event: str) -> dict[str, Any]:
        while True:
            for index, message in enumerate(self.events):
                if message['event'] == event:
                    del self.events[index]
                    return message.get('body', {})
            message = self.receive()
            assert message['type'] == 'event', message
            self.events.append(message)

    def close(self) -> None:
        self.stream.close()
        self.socket.close()


class DebuggedProgram:
    """A program, its debug adapter's server, and an editor that has connected.

    Args:
        folder: For its file.
        text: The program.
    """

    def __init__(self, folder: Path, text: str) -> None:
        self.path = folder / 'test.lua'
        self.path.write_text(text)
        report = {'held_changed': 'on_held', 'printed': 'on_print', 'ended': 'on_finished'}
        cell = CellDouble(**{name: partial(self._tell, event) for name, event in report.items()})
        self.program = LuaProgram(6, cell)
        self.server = DebugAdapterServer(self.program, token=TOKEN, folder=folder)
        self.editor = Editor(self.server.port)

    def _tell(self, event: str, *what: object) -> None:
        getattr(self.server.adapter, event)(*what)

    def close(self) -> None:
        self.editor.close()
        self.server.close()
        self.program.stop()
        assert self.program.join(DEADLINE)
