"""A network between a browser and a server, which can fall silent without an end of its connections."""

from __future__ import annotations

import contextlib
import socket
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from urllib.parse import urlsplit

CHUNK = 65536  # bytes


class SilentNetwork:
    """Passes on what both sides send, until it is silent: then neither hears anything, not even an end."""

    def __init__(self, port: int, ending: ExitStack) -> None:
        self._port, self._ending = port, ending
        self._passing = threading.Event()
        self._passing.set()
        self._listener = ending.enter_context(socket.create_server(('127.0.0.1', 0)))
        self.url = f'http://127.0.0.1:{self._listener.getsockname()[1]}'
        threading.Thread(target=self._accept, daemon=True).start()

    def silence(self) -> None:
        """Pass on nothing more."""
        self._passing.clear()

    def restore(self) -> None:
        """Pass on what waits and what follows."""
        self._passing.set()

    def _accept(self) -> None:
        with contextlib.suppress(OSError):  # the listener is closed
            while True:
                near, _ = self._listener.accept()
                far = socket.create_connection(('127.0.0.1', self._port))
                for one, other in ((near, far), (far, near)):
                    self._ending.callback(one.close)
                    threading.Thread(target=self._pass_on, args=(one, other), daemon=True).start()

    def _pass_on(self, near: socket.socket, far: socket.socket) -> None:
        with contextlib.suppress(OSError):
            while data := near.recv(CHUNK):
                self._passing.wait()
                far.sendall(data)
            self._passing.wait()
            far.shutdown(socket.SHUT_WR)


@contextmanager
def silent_network(url: str) -> Iterator[SilentNetwork]:
    """A network to a server of this machine."""
    port = urlsplit(url).port
    assert port is not None
    with ExitStack() as ending:
        network = SilentNetwork(port, ending)
        try:
            yield network
        finally:
            network.restore()
