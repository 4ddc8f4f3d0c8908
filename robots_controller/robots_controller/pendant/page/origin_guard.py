"""OriginGuard: a page of another origin can neither read the operator's page nor press anything on it."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Mapping, MutableMapping
from typing import Any, Final

LOCAL_NAMES: Final = frozenset({'127.0.0.1', 'localhost', '[::1]'})
"""How a browser on this machine addresses the page."""
HEADERS: Final = (
    (b'content-security-policy', b"frame-ancestors 'none'"),
    (b'x-frame-options', b'DENY'),
    (b'referrer-policy', b'no-referrer'),
)
"""No other page may show this one in a frame, where a person would press what they do not see."""

Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
App = Callable[[Message, Receive, Send], Awaitable[None]]


def is_own(headers: Mapping[str, str]) -> bool:
    """A request comes from a page of this server, or from no page at all.

    The host must be a name of this machine: a foreign name that resolves to this address is of a foreign page
    (DNS rebinding).

    Args:
        headers: By lower-case name.
    """
    host = headers.get('host', '')
    if host.rpartition(':')[0] not in LOCAL_NAMES and host not in LOCAL_NAMES:
        return False
    origin = headers.get('origin')
    return origin is None or origin == f'http://{host}'


class OriginGuard:
    """An ASGI application before another one; requests and websockets of foreign origins are refused (403).

    Args:
        app: The other one.
    """

    def __init__(self, app: App) -> None:
        self.app: Final = app  # NiceGUI looks for the application below by this name

    async def __call__(self, scope: Message, receive: Receive, send: Send) -> None:
        """See ASGI."""
        if scope['type'] == 'lifespan':
            await self.app(scope, receive, send)
            return
        headers = {key.decode('latin1').lower(): value.decode('latin1') for key, value in scope['headers']}
        websocket = scope['type'] == 'websocket'
        if not is_own(headers) or (websocket and 'origin' not in headers):
            await _refuse(websocket=websocket, receive=receive, send=send)
            return

        async def send_with_headers(message: Message) -> None:
            if message['type'] == 'http.response.start':
                message['headers'] = [*message.get('headers', ()), *HEADERS]
            await send(message)

        await self.app(scope, receive, send_with_headers)


async def _refuse(*, websocket: bool, receive: Receive, send: Send) -> None:
    if websocket:
        await receive()
        await send({'type': 'websocket.close', 'code': 1008})  # before it is accepted: 403
        return
    text = b'refused: this page takes requests from this machine and from itself alone\n'
    head = [(b'content-type', b'text/plain'), (b'content-length', str(len(text)).encode())]
    await send({'type': 'http.response.start', 'status': 403, 'headers': head})
    await send({'type': 'http.response.body', 'body': text})
