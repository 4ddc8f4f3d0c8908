"""OriginGuard: a page of another origin can neither read the operator's page nor press anything on it."""

from __future__ import annotations

import ipaddress
import socket
from collections.abc import Mapping
from typing import Final

from starlette.datastructures import Headers
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocketClose

from robots_controller.pendant.page_access import THIS_MACHINE

LOCAL_NAMES: Final = frozenset({'127.0.0.1', 'localhost', '[::1]'})
"""How a browser on this machine addresses the page."""
EVERY_ADDRESS: Final = frozenset({'0.0.0.0', '::'})  # noqa: S104  # not listened at, compared
SCENE: Final = '/scene'
"""Where the 3D view is, see `SceneProxy`: the page itself shows it in a frame."""
HEADERS: Final = (
    (b'content-security-policy', b"frame-ancestors 'none'"),
    (b'x-frame-options', b'DENY'),
    (b'referrer-policy', b'same-origin'),
)
"""No other page may show this one in a frame, where a person would press what they do not see."""
SCENE_HEADERS: Final = (
    (b'content-security-policy', b"frame-ancestors 'self'"),
    (b'x-frame-options', b'SAMEORIGIN'),
    (b'referrer-policy', b'same-origin'),
)

POLICY_VIOLATION: Final = 1008  # code of a websocket that is closed
REFUSAL: Final = 'refused: this page takes requests from itself alone, by a name of this machine\n'


def is_own(headers: Mapping[str, str], served: str = THIS_MACHINE) -> bool:
    """A request comes from a page of this server, or from no page at all.

    The host must be a name of this machine: a foreign name that resolves to this address is of a foreign page
    (DNS rebinding).

    Args:
        headers: By lower-case name.
        served: Address that the server listens at.
    """
    host = headers.get('host', '').lower()
    name = host if host.endswith(']') or ':' not in host else host.rpartition(':')[0]
    if not _is_named(name, served):
        return False
    origin = headers.get('origin')
    return origin is None or origin.lower() == f'http://{host}'


def _is_named(name: str, served: str) -> bool:
    if name in LOCAL_NAMES or name.strip('[]') == served.lower():
        return True
    if served not in EVERY_ADDRESS:
        return False
    try:
        ipaddress.ip_address(name.strip('[]'))  # an address is nobody's name
    except ValueError:
        return name == socket.gethostname().lower()
    return True


class OriginGuard:
    """An ASGI application before another one; refuses requests and websockets of foreign origins (403)."""

    def __init__(self, app: ASGIApp, served: str = THIS_MACHINE) -> None:
        self.app: Final = app  # NiceGUI looks for the application below by this name
        self._served = served

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """See ASGI."""
        if scope['type'] == 'lifespan':
            await self.app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        websocket = scope['type'] == 'websocket'
        if not is_own(headers, self._served) or (websocket and 'origin' not in headers):
            refused = WebSocketClose(POLICY_VIOLATION) if websocket else PlainTextResponse(REFUSAL, 403)
            await refused(scope, receive, send)
            return

        own = SCENE_HEADERS if scope.get('path', '').startswith(f'{SCENE}/') else HEADERS

        async def send_with_headers(message: Message) -> None:
            if message['type'] == 'http.response.start':
                message['headers'] = [*message.get('headers', ()), *own]
            await send(message)

        await self.app(scope, receive, send_with_headers)
