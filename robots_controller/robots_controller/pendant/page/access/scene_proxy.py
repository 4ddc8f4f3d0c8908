"""SceneProxy: the 3D view for browsers on other machines, through the server of the operator's page."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Final
from urllib.parse import urlsplit

import httpx
from starlette.responses import Response
from starlette.types import ASGIApp, Receive, Scope, Send
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import WebSocketException

from robots_controller.pendant.page.access.origin_guard import SCENE
from robots_controller.pendant.page_access import is_this_machine

PATIENCE: Final = 10.0  # s
ASKED: Final = (b'accept', b'accept-encoding')
ANSWERED: Final = ('content-type', 'content-encoding')
GET: Final = ('GET', 'HEAD')


class SceneProxy:
    """An ASGI application before another one; the server of the 3D view answers what is below `/scene`.

    That server listens on the loopback interface, without a password: this belongs behind the page's guards.
    A server on another machine is not asked.
    """

    def __init__(self, app: ASGIApp, url: Callable[[], str]) -> None:
        self.app: Final = app  # NiceGUI looks for the application below by this name
        self._url = url

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """See ASGI."""
        path = scope.get('path', '')
        if path != SCENE and not path.startswith(f'{SCENE}/'):
            await self.app(scope, receive, send)
        elif scope['type'] == 'websocket':
            await self._connect(scope, receive, send)
        else:
            await self._answer(scope, receive, send)

    @property
    def _server(self) -> str:
        """Host and port; '' for none on this machine."""
        parts = urlsplit(self._url())
        return parts.netloc if parts.scheme == 'http' and is_this_machine(parts.hostname or '') else ''

    async def _answer(self, scope: Scope, receive: Receive, send: Send) -> None:
        status, headers, body = 502, {'content-type': 'text/plain'}, b'there is no 3D view\n'
        if scope['method'] not in GET:
            status, body = 405, b'the 3D view is only read\n'
        elif server := self._server:
            asked = [(name, value) for name, value in scope['headers'] if name.lower() in ASKED]
            address = f'http://{server}{scope["path"].removeprefix(SCENE) or "/"}'
            try:
                async with (
                    httpx.AsyncClient(trust_env=False, timeout=PATIENCE) as client,
                    client.stream('GET', address, headers=asked) as found,
                ):
                    status, body = found.status_code, b''.join([part async for part in found.aiter_raw()])
                    headers = {name: found.headers[name] for name in ANSWERED if name in found.headers}
            except (httpx.HTTPError, httpx.InvalidURL):
                pass  # its node has ended, or is starting
        await Response(body, status, headers)(scope, receive, send)

    async def _connect(self, scope: Scope, receive: Receive, send: Send) -> None:
        await receive()  # its request to connect
        gone = False
        try:
            async with connect(
                f'ws://{self._server}/',
                subprotocols=scope.get('subprotocols') or None,
                compression=None,
                max_size=None,
                open_timeout=PATIENCE,
                proxy=None,
            ) as scene:
                await send({'type': 'websocket.accept', 'subprotocol': scene.subprotocol})
                gone = await _pass_on(scene, receive, send)
        except (OSError, ValueError, WebSocketException):  # as above; ValueError: there is no address
            pass
        if not gone:
            await send({'type': 'websocket.close', 'code': 1001})


async def _pass_on(scene: ClientConnection, receive: Receive, send: Send) -> bool:
    """Pass messages on in both directions until one side ends; True if it was the browser."""
    tasks = [
        asyncio.ensure_future(_to_scene(receive, scene)),
        asyncio.ensure_future(_to_browser(scene, send)),
    ]
    try:
        ended, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        return tasks[0] in ended and tasks[0].exception() is None
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


async def _to_scene(receive: Receive, scene: ClientConnection) -> None:
    while (message := await receive())['type'] == 'websocket.receive':
        data = message.get('bytes')
        await scene.send(message['text'] if data is None else data)


async def _to_browser(scene: ClientConnection, send: Send) -> None:
    async for data in scene:
        await send({'type': 'websocket.send', 'bytes' if isinstance(data, bytes) else 'text': data})
