"""Where the operator's page is served, and who gets it."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import pytest
from httpx import ASGITransport, AsyncClient, Response

from robots_controller.pendant.page.access.password_guard import (
    COOKIE,
    LARGEST_FORM,
    SESSION_TIME,
    PasswordGuard,
)
from robots_controller.pendant.page_access import MOST_ADDRESSES, LoginAttempts, PageAccess, read_access
from robots_core.errors import InvalidInputError, RobotsError

PASSWORD = 'drei Äpfel'  # noqa: S105


@pytest.fixture
def password_file(tmp_path: Path) -> Path:
    path = tmp_path / 'password'
    path.write_text(f'{PASSWORD}\nrest\n')
    path.chmod(0o600)
    return path


@pytest.mark.parametrize('host', ['', '127.0.0.1', 'localhost', '::1', '127.0.1.1'])
def test_this_machine_needs_no_password(host: str) -> None:
    assert read_access(host) == PageAccess(host or '127.0.0.1')


@pytest.mark.parametrize('host', ['0.0.0.0', '::', '192.168.0.5', 'robot.local'])  # noqa: S104
def test_other_machines_need_one(host: str, password_file: Path) -> None:
    with pytest.raises(InvalidInputError, match=r'to other machines; this needs a password'):
        read_access(host)
    access = read_access(host, str(password_file))
    assert access == PageAccess(host, PASSWORD)
    assert PASSWORD not in repr(access)


def test_a_password_file_that_others_can_read_is_refused(password_file: Path) -> None:
    password_file.chmod(0o640)
    with pytest.raises(InvalidInputError, match=r'is open to others .* \(mode 640, .*: chmod 600 '):
        read_access('', str(password_file))


@pytest.mark.parametrize(
    ('content', 'message'),
    [
        (b'', 'has 0 characters; a password has at least 8'),
        (b'short\nlonger than eight', 'has 5 characters'),
        (b'x' * 5000, 'at most 4096 are read'),
        (b'\xff' * 20, 'is not UTF-8'),
    ],
)
def test_a_password_file_without_a_password_is_refused(
    password_file: Path, content: bytes, message: str
) -> None:
    password_file.write_bytes(content)
    with pytest.raises(RobotsError, match=message):
        read_access('', str(password_file))


def test_no_password_file(tmp_path: Path) -> None:
    with pytest.raises(RobotsError, match='there is no password file'):
        read_access('', str(tmp_path / 'none'))
    with pytest.raises(RobotsError, match='is a directory'):
        read_access('', str(tmp_path))


def test_each_wrong_password_doubles_the_delay() -> None:
    attempts, now, delays = LoginAttempts(), 0.0, []
    for _ in range(9):
        assert attempts.delay('10.0.0.1', now) == 0.0
        attempts.wrong('10.0.0.1', now)
        delays.append(attempts.delay('10.0.0.1', now))
        now += delays[-1]
    assert delays == [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 60.0, 60.0, 60.0]
    assert attempts.delay('10.0.0.2', now) == 0.0  # another one is not held up
    attempts.wrong('10.0.0.1', now + 601.0)
    assert attempts.delay('10.0.0.1', now + 601.0) == 1.0  # forgotten
    attempts.right('10.0.0.1')
    assert attempts.delay('10.0.0.1', now + 601.0) == 0.0


def test_wrong_passwords_need_no_more_memory_than_is_bounded() -> None:
    attempts = LoginAttempts()
    for number in range(2 * MOST_ADDRESSES):
        attempts.wrong(f'10.0.{number // 256}.{number % 256}', 0.0)
        attempts.wrong(f'fe80::{number:x}', 0.0)  # all of one network
    assert len(attempts._wrong) == MOST_ADDRESSES
    assert attempts.delay('fe80::1:2', 0.0) == 60.0


class Guarded:
    """A guard before an application that answers 'inside', on a clock of its own."""

    def __init__(self) -> None:
        self.time, self.told = 0.0, list[str]()
        self.guard = PasswordGuard(
            self._app, PASSWORD, title='<arm>', log=self.told.append, now=lambda: self.time
        )
        self.cookies: dict[str, str] = {}

    async def _app(self, _scope: Any, _receive: Any, send: Any) -> None:
        await send({'type': 'http.response.start', 'status': 200, 'headers': []})
        await send({'type': 'http.response.body', 'body': b'inside'})

    def ask(self, method: str = 'GET', path: str = '/', **options: Any) -> Response:
        async def ask() -> Response:
            transport = ASGITransport(self.guard)
            async with AsyncClient(transport=transport, base_url='http://x', cookies=self.cookies) as client:
                return await client.request(method, path, **options)

        return asyncio.run(ask())

    def log_in(self, password: str) -> Response:
        return self.ask('POST', '/login', data={'password': password})


@pytest.fixture
def guarded() -> Guarded:
    return Guarded()


@pytest.mark.parametrize('path', ['/', '/_nicegui/1.0/static/x.js', '/login'])
def test_without_a_session_there_is_a_form_alone(guarded: Guarded, path: str) -> None:
    answer = guarded.ask(path=path)
    assert (answer.status_code, 'inside' in answer.text) == (401, False)
    assert 'type="password"' in answer.text
    assert '&lt;arm&gt;' in answer.text
    assert '[[' not in answer.text
    german = guarded.ask(path=path, headers={'accept-language': 'de'})
    assert 'Passwort' in german.text


def test_the_password_begins_a_session(guarded: Guarded) -> None:
    answer = guarded.log_in(PASSWORD)
    assert (answer.status_code, answer.headers['location']) == (303, '/')
    cookie = answer.headers['set-cookie']
    for part in ('HttpOnly', 'SameSite=strict', f'Max-Age={SESSION_TIME}'):
        assert part in cookie
    guarded.cookies = {COOKIE: answer.cookies[COOKIE]}
    assert guarded.ask().text == 'inside'


@pytest.mark.parametrize('change', ['', 'viewer', 'cut', 'tampered', 'of another process'])
def test_a_session_that_is_not_signed_is_none(guarded: Guarded, change: str) -> None:
    signed = guarded.log_in(PASSWORD).cookies[COOKIE]
    other = Guarded().log_in(PASSWORD).cookies[COOKIE]
    forged = {'cut': signed[:-2], 'tampered': f'V{signed[1:]}', 'of another process': other}
    guarded.cookies = {COOKIE: forged.get(change, change)}
    assert guarded.ask().status_code == 401


def test_a_session_ends(guarded: Guarded, monkeypatch: pytest.MonkeyPatch) -> None:
    signer = guarded.guard._signer
    begun = signer.get_timestamp()
    monkeypatch.setattr(signer, 'get_timestamp', lambda: begun)
    guarded.cookies = {COOKIE: guarded.log_in(PASSWORD).cookies[COOKIE]}
    for passed, status in ((SESSION_TIME, 200), (SESSION_TIME + 1, 401)):
        monkeypatch.setattr(signer, 'get_timestamp', lambda: begun + passed)  # noqa: B023
        assert guarded.ask().status_code == status


def test_wrong_passwords_are_delayed(guarded: Guarded) -> None:
    first = guarded.log_in('guess')
    assert (first.status_code, first.headers['retry-after']) == (403, '1')
    assert COOKIE not in first.cookies
    assert guarded.told == ["the operator's page refused a wrong password from 127.0.0.1"]
    held = guarded.log_in(PASSWORD)  # the right one, too early: it is not checked
    assert held.status_code == 429
    guarded.time = 1.0
    assert guarded.log_in(PASSWORD).status_code == 303


def test_a_form_is_bounded(guarded: Guarded) -> None:
    assert guarded.log_in('x' * LARGEST_FORM).status_code == 413
    assert guarded.ask('POST', '/login', content=b'\xff&=%').status_code == 403


def test_a_websocket_needs_a_session(guarded: Guarded) -> None:
    sent: list[Any] = []

    async def send(message: Any) -> None:
        sent.append(message['type'])

    async def receive() -> Any:
        return {'type': 'websocket.connect'}

    asyncio.run(guarded.guard({'type': 'websocket', 'headers': [(b'cookie', b'\xff;=')]}, receive, send))
    assert sent == ['websocket.close']
