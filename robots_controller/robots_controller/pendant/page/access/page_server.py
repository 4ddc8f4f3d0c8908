"""PageServer: serves the operator's page, from a thread of its own."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Callable
from html import escape
from typing import Final

import uvicorn
from fastapi import FastAPI, Request
from fastapi.responses import HTMLResponse
from nicegui import core, ui
from starlette.types import ASGIApp

from robots_controller.pendant.page.access.origin_guard import EVERY_ADDRESS, OriginGuard
from robots_controller.pendant.page.access.password_guard import PasswordGuard
from robots_controller.pendant.page.access.scene_proxy import SceneProxy
from robots_controller.pendant.page.trend_panel import REPORT
from robots_controller.pendant.page_access import PageAccess
from robots_core.errors import InstallationError, RobotsError
from robots_core.free_port import free_port

START_TIMEOUT: Final = 60.0  # s
POLL: Final = 0.01  # s
RECONNECT_TIMEOUT: Final = 30.0  # s for which the server keeps a page whose connection is lost
CONNECTION_TIMEOUT: Final = 4.0  # s
PING_PERIOD: Final = 1.0  # s
Build = Callable[[Request], object]


class _Served:
    """NiceGUI has one application in a process, mounted once; its page is that of the newest server."""

    app: FastAPI | None = None
    build: Build | None = None
    report: Callable[[], str] = str


class PageServer:
    """Serves a page.

    Args:
        build: Makes the elements of the page, for each viewer.
        port: First port to try; 0: chosen by the system.
        title: Of the page.
        access: Where it is served, and to whom; by default on this machine alone.
        log: Gets who has given a wrong password, in the thread of the page.
        report: Makes the page of the report of the last run.
        scene: Gives the address of the 3D view on this machine; '' for none.
        connection_timeout: Silence of a browser after which its connection is lost, s; above `PING_PERIOD`.

    Raises:
        InvalidInputError: a port outside 0..65535, or an address that is none of this machine.
        InstallationError: the page cannot be served.
    """

    def __init__(
        self,
        build: Build,
        *,
        port: int,
        title: str,
        access: PageAccess | None = None,
        log: Callable[[str], object] = print,
        report: Callable[[], str] = str,
        scene: Callable[[], str] = str,
        connection_timeout: float = CONNECTION_TIMEOUT,
    ) -> None:
        access = access or PageAccess()
        self._host, self._port = access.host, free_port(access.host, port)
        _Served.report = report
        app: ASGIApp = SceneProxy(_application(build, title), scene)
        if access.password:
            app = PasswordGuard(app, access.password, title=title, log=log)
        config = uvicorn.Config(
            OriginGuard(app, self._host),
            self._host,
            self._port,
            log_level='warning',
            ws_per_message_deflate=False,  # the 3D view is compressed already
            timeout_graceful_shutdown=1,
        )
        self._server = uvicorn.Server(config)
        self._thread = threading.Thread(target=self._server.run, name='page', daemon=True)
        self._thread.start()
        deadline = time.monotonic() + START_TIMEOUT
        while not self._server.started:
            if not self._thread.is_alive() or time.monotonic() > deadline:
                raise InstallationError(f'the page cannot be served at {self.url}')
            time.sleep(POLL)
        # NiceGUI derives both from the time for which it keeps a page: 36 s in all.
        core.sio.eio.ping_interval = PING_PERIOD
        core.sio.eio.ping_timeout = connection_timeout - PING_PERIOD

    @property
    def url(self) -> str:
        """Address of the page."""
        host = socket.gethostname() if self._host in EVERY_ADDRESS else self._host
        return f'http://{f"[{host}]" if ":" in host else host}:{self._port}'

    def close(self) -> None:
        """End the page."""
        self._server.should_exit = True
        self._thread.join(START_TIMEOUT)


def _application(build: Build, title: str) -> FastAPI:
    _Served.build = build
    if _Served.app is None:
        _Served.app = FastAPI(docs_url=None, redoc_url=None, openapi_url=None)

        @_Served.app.get(REPORT)
        def report() -> HTMLResponse:
            try:
                return HTMLResponse(_Served.report())
            except (RobotsError, OSError) as error:
                return HTMLResponse(f'<p>{escape(str(error))}</p>', 503)

        @ui.page('/', response_timeout=START_TIMEOUT)
        def page(request: Request) -> None:
            assert _Served.build is not None
            _Served.build(request)

        ui.run_with(
            _Served.app,
            title=title,
            dark=None,
            tailwind=False,
            reconnect_timeout=RECONNECT_TIMEOUT,
            binding_refresh_interval=None,
            show_welcome_message=False,
        )
    return _Served.app
