"""PasswordGuard: the operator's page is only for viewers who have given its password."""

from __future__ import annotations

import hmac
import math
import secrets
import time
from collections.abc import Callable
from html import escape
from importlib.resources import files
from typing import Final
from urllib.parse import parse_qs

from itsdangerous import BadSignature, TimestampSigner
from starlette.requests import HTTPConnection, Request
from starlette.responses import HTMLResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocketClose

from robots_controller.pendant.page.access.origin_guard import POLICY_VIOLATION
from robots_controller.pendant.page_access import LoginAttempts
from robots_controller.pendant.texts import preferred_language, read_texts

COOKIE: Final = 'pendant_session'
SESSION: Final = b'viewer'
SESSION_TIME: Final = 12 * 3600  # s, a shift
LOGIN: Final = '/login'
LARGEST_FORM: Final = 4096  # bytes


class PasswordGuard:
    """An ASGI application before another one; without a session, requests get a form for the password.

    Sessions are signed with a key of this process: they end with it.
    """

    def __init__(
        self,
        app: ASGIApp,
        password: str,
        *,
        title: str,
        log: Callable[[str], object],
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self.app: Final = app  # NiceGUI looks for the application below by this name
        self._password, self._title, self._log, self._now = password.encode(), title, log, now
        self._signer = TimestampSigner(secrets.token_bytes(32))
        self._attempts = LoginAttempts()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """See ASGI."""
        if scope['type'] == 'lifespan' or self._is_known(scope):
            await self.app(scope, receive, send)
        elif scope['type'] == 'websocket':
            await WebSocketClose(POLICY_VIOLATION)(scope, receive, send)
        else:
            request = Request(scope, receive)
            posted = (request.method, request.url.path) == ('POST', LOGIN)
            response = await self._log_in(request) if posted else self._form(request, 'needed', 401)
            await response(scope, receive, send)

    def _is_known(self, scope: Scope) -> bool:
        signed = HTTPConnection(scope).cookies.get(COOKIE, '')
        try:
            return self._signer.unsign(signed, max_age=SESSION_TIME) == SESSION
        except BadSignature:
            return False

    async def _log_in(self, request: Request) -> Response:
        address = request.client.host if request.client else ''
        form = b''
        async for part in request.stream():
            form += part
            if len(form) > LARGEST_FORM:
                return self._form(request, 'wrong', 413)
        given = parse_qs(form.decode('latin1'), encoding='utf-8').get('password', [''])[0]
        if delay := self._attempts.delay(address, self._now()):
            return self._form(request, 'wait', 429, delay)
        if not hmac.compare_digest(given.encode(), self._password):
            self._attempts.wrong(address, self._now())
            self._log(f"the operator's page refused a wrong password from {address}")
            return self._form(request, 'wrong', 403, self._attempts.delay(address, self._now()))
        self._attempts.right(address)
        response = RedirectResponse('/', 303)
        signed = self._signer.sign(SESSION).decode()
        response.set_cookie(COOKIE, signed, SESSION_TIME, httponly=True, samesite='strict')
        return response

    def _form(self, request: Request, key: str, status: int, delay: float = 0.0) -> HTMLResponse:
        text = read_texts(preferred_language(request.headers.get('accept-language', '')))
        seconds = str(math.ceil(delay))
        html = (files('robots_controller.pendant.page.access') / 'login.html').read_text('utf-8')
        values = {
            'title': self._title,
            'said': text(f'login.{key}', delay=seconds),
            'state': 'hint' if key == 'needed' else 'bad',
            'label': text('login.password'),
            'button': text('login.enter'),
        }
        for name, value in values.items():
            html = html.replace(f'[[{name}]]', escape(value))
        headers = {'cache-control': 'no-store', **({'retry-after': seconds} if delay else {})}
        return HTMLResponse(html, status, headers)
