"""DebugAdapterServer: the socket at which editors connect to debug a robot program."""

import contextlib
import secrets
import socket
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Final

from robots_controller.editor.debug_adapter import DebugAdapter, Message, message_bytes, read_messages
from robots_controller.interpreter.lua_program import LuaProgram
from robots_core.errors import InstallationError, RobotsError

HOST: Final = '127.0.0.1'
# An editor that takes nothing must not hold the program.
SEND_TIMEOUT: Final = 1.0  # s
# A stranger must not keep editors out.
TOKEN_TIMEOUT: Final = 10.0  # s


def new_token() -> str:
    """What an editor must give: twelve characters that cannot be guessed."""
    return secrets.token_urlsafe(9)


class DebugAdapterServer:
    """One editor at a time, on this machine only, with the token.

    Args:
        program: The program to debug; its owner tells the `adapter` what it does.
        token: What editors must give; see `DebugAdapter`.
        folder: Where the programs are that editors may launch.
        port: TCP port; -1 for any free one.

    Raises:
        RobotsError: the port is taken.
    """

    def __init__(self, program: LuaProgram, *, token: str, folder: Path, port: int = -1) -> None:
        self._program = program
        self._token, self._folder = token, folder
        try:
            self._socket = socket.create_server((HOST, max(port, 0)))
        except (OSError, OverflowError) as error:
            raise InstallationError(f'port {port} is not free for the debugger: {error}') from error
        self.port = int(self._socket.getsockname()[1])
        """Where editors connect."""
        self._nobody = self.adapter = self._adapter_of(lambda _: None)
        """The adapter of the editor that is connected, or one whose events nobody gets."""
        self._connection: socket.socket | None = None
        threading.Thread(target=self._serve, name='debug adapter', daemon=True).start()

    def close(self) -> None:
        """Let the editor go and wait for no other."""
        for one in (self._socket, self._connection):
            if one is not None:
                with contextlib.suppress(OSError):
                    one.shutdown(socket.SHUT_RDWR)
                one.close()

    # -- the server's thread ------------------------------------------------------------------------

    def _serve(self) -> None:
        while True:
            try:
                connection, _ = self._socket.accept()
            except OSError:  # closed
                return
            with connection:
                self._connection = connection
                self._talk(connection)
                self._connection = None

    def _adapter_of(self, send: Callable[[Message], None]) -> DebugAdapter:
        return DebugAdapter(self._program, send, token=self._token, folder=self._folder)

    def _talk(self, connection: socket.socket) -> None:
        def send(message: Message) -> None:
            with contextlib.suppress(OSError):
                writer.sendall(message_bytes(message))

        # Reading waits for ever once the editor is admitted, writing does not: two views of one connection.
        writer = connection.dup()
        writer.settimeout(SEND_TIMEOUT)
        connection.settimeout(TOKEN_TIMEOUT)
        adapter = self.adapter = self._adapter_of(send)
        try:
            with writer, connection.makefile('rb') as stream:
                for message in read_messages(stream):
                    adapter.handle(message)
                    if adapter.admitted:
                        connection.settimeout(None)
                    if adapter.ended:
                        return
        except (OSError, RobotsError):  # the editor is gone, or what it sends is no protocol
            pass
        finally:
            self.adapter = self._nobody
            if adapter.admitted and not adapter.ended:
                adapter.leave()
