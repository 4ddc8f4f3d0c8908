"""A page of another origin can do nothing with the operator's page."""

from __future__ import annotations

import asyncio
from socket import gethostname
from typing import Any

import pytest

from robots_controller.pendant.page.access.origin_guard import OriginGuard, is_own


@pytest.mark.parametrize(
    ('headers', 'own'),
    [
        ({'host': '127.0.0.1:8090'}, True),
        ({'host': 'localhost:8090', 'origin': 'http://localhost:8090'}, True),
        ({'host': '[::1]:8090', 'origin': 'http://[::1]:8090'}, True),
        ({'host': 'localhost'}, True),
        ({'host': '127.0.0.1:8090', 'origin': 'http://evil.example'}, False),
        ({'host': '127.0.0.1:8090', 'origin': 'http://127.0.0.1:3000'}, False),
        ({'host': '127.0.0.1:8090', 'origin': 'null'}, False),
        # A foreign name that resolves to this machine.
        ({'host': 'evil.example:8090', 'origin': 'http://evil.example:8090'}, False),
        ({'host': '127.0.0.1.evil.example:8090'}, False),
        ({}, False),
    ],
)
def test_own_requests(headers: dict[str, str], own: bool) -> None:  # noqa: FBT001
    assert is_own(headers) is own


@pytest.mark.parametrize(
    ('served', 'host', 'own'),
    [
        ('192.168.0.5', '192.168.0.5:8090', True),
        ('192.168.0.5', '192.168.0.6:8090', False),
        ('Robot.local', 'robot.local:8090', True),
        ('0.0.0.0', '192.168.0.6:8090', True),  # noqa: S104
        ('0.0.0.0', f'{gethostname()}:8090', True),  # noqa: S104
        ('::', '[fe80::1]:8090', True),
        ('0.0.0.0', 'evil.example:8090', False),  # noqa: S104
        ('127.0.0.1', '192.168.0.6:8090', False),
    ],
)
def test_requests_from_other_machines(served: str, host: str, own: bool) -> None:  # noqa: FBT001
    assert is_own({'host': host, 'origin': f'http://{host.lower()}'}, served) is own
    assert not is_own({'host': host, 'origin': 'http://evil.example'}, served)


def answers(kind: str, **headers: str) -> tuple[list[dict[str, Any]], bool]:
    """What is sent for a request, and whether the application got it."""
    sent: list[dict[str, Any]] = []
    reached: list[str] = []

    async def app(scope: Any, _receive: Any, send: Any) -> None:
        reached.append(scope['type'])
        if scope['type'] == 'http':
            await send({'type': 'http.response.start', 'status': 200, 'headers': []})

    async def receive() -> dict[str, Any]:
        return {'type': f'{kind}.connect'}

    async def send(message: Any) -> None:
        sent.append(message)

    raw = [(name.encode(), value.encode()) for name, value in headers.items()]
    asyncio.run(OriginGuard(app)({'type': kind, 'headers': raw}, receive, send))
    return sent, bool(reached)


def test_foreign_requests_are_refused() -> None:
    sent, reached = answers('http', host='127.0.0.1:1', origin='http://evil.example')
    assert (sent[0]['status'], reached) == (403, False)


@pytest.mark.parametrize('headers', [{'origin': 'http://evil.example'}, {}])
def test_foreign_websockets_are_refused(headers: dict[str, str]) -> None:
    sent, reached = answers('websocket', host='127.0.0.1:1', **headers)
    assert ([message['type'] for message in sent], reached) == (['websocket.close'], False)
    assert answers('websocket', host='127.0.0.1:1', origin='http://127.0.0.1:1')[1]


def test_no_other_page_shows_this_one_in_a_frame() -> None:
    sent, _ = answers('http', host='127.0.0.1:1')
    assert (b'x-frame-options', b'DENY') in sent[0]['headers']


def test_what_is_no_request_passes() -> None:
    assert answers('lifespan')[1]
