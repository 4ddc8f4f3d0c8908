"""PendantPage: the operator's page, for one viewer."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable, Mapping
from contextlib import suppress
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any, Final

import numpy as np
from fastapi import Request
from nicegui import ui
from nicegui.events import GenericEventArguments
from nicegui.language import Language

from robots_controller.pendant.jog.held_button import RUN_KEY, STEP_KEY, Sign
from robots_controller.pendant.page.access.origin_guard import SCENE
from robots_controller.pendant.page.io_panel import IoPanel
from robots_controller.pendant.page.jog_panel import JogPanel
from robots_controller.pendant.page.measuring.frames_panel import FramesPanel
from robots_controller.pendant.page.message_panel import MessagePanel
from robots_controller.pendant.page.program_panel import ProgramPanel
from robots_controller.pendant.page.top_bar import TopBar
from robots_controller.pendant.page.trend_panel import TrendPanel
from robots_controller.pendant.page.viewer import PERIOD, Panel, Viewer
from robots_controller.pendant.page_access import is_this_machine
from robots_controller.pendant.pendant_operator import PendantOperator
from robots_controller.pendant.permissions import Action
from robots_controller.pendant.texts import LANGUAGES, preferred_language, read_texts
from robots_core.errors import RobotsError
from robots_core.validation import Array

PAGE_LANGUAGES: Final[Mapping[str, Language]] = {'en': 'en-US', 'de': 'de'}
"""Of what the browser and NiceGUI themselves say."""
GONE_AFTER: Final = 1.5  # s without a connection, after which a page has no control any more
ANSWERS_WITHIN: Final = 30.0  # s in which a browser that comes back answers
LANGUAGE_COOKIE: Final = 'language'
THEME_COOKIE: Final = 'theme'
PANELS: Final[Mapping[str, tuple[str, Callable[[Viewer], Panel]]]] = {
    'jog': ('gamepad', JogPanel),
    'program': ('code', ProgramPanel),
    'io': ('toggle_on', IoPanel),
    'trends': ('show_chart', TrendPanel),
    'frames': ('straighten', FramesPanel),
    'messages': ('notifications', MessagePanel),
}
"""Icons, and what makes the panels."""


class PendantPage:
    """The bar, the 3D view, and panels to jog, for programs, for inputs and outputs, and for messages."""

    def __init__(self, operator: PendantOperator, folder: Path, request: Request) -> None:
        self._client = client = ui.context.client
        chosen = request.cookies.get(LANGUAGE_COOKIE, '')
        language = (
            chosen if chosen in LANGUAGES else preferred_language(request.headers.get('accept-language', ''))
        )
        client.page.language = PAGE_LANGUAGES[language]
        self._operator = operator
        self._number = 0  # of the newest press
        self._taught: Array = np.eye(3)  # orientation of the taught frame at its begin
        address = request.client.host if request.client else ''
        self._viewer = viewer = Viewer(
            client.id, operator, read_texts(language), self.refresh, folder, address
        )
        theme = request.cookies.get(THEME_COOKIE)
        ui.dark_mode(value=None if theme not in ('dark', 'light') else theme == 'dark')
        ui.colors(primary='#00796b')
        ui.add_head_html(f'<style>{_asset("pendant.css")}</style><script>{_asset("pendant.js")}</script>')
        client.content.classes('page')
        self._scene_url, self._host = '', request.headers.get('host', '')
        with client.content:
            self._bar = TopBar(viewer)
            ui.element('div').props('id=tooltips')
            with ui.element('main').classes('work'):
                with ui.element('div').classes('scene'):
                    self._no_scene = ui.label(viewer.texts('bar.no_scene')).classes('hint')
                    self._scene = ui.element('iframe').props('title=3D')
                    self._scene.set_visibility(False)
                with ui.element('section').classes('side'):
                    self._build_panels()
        ui.on('pendant_hold', self._hold)
        ui.on('pendant_release', self._release)
        self._connected_before = False
        client.on_connect(self._on_connect)
        client.on_disconnect(self._on_disconnect)
        client.on_delete(lambda: operator.give_back_control(viewer.id))
        self.refresh()
        ui.timer(PERIOD, self._refresh_with_scene)

    def _build_panels(self) -> None:
        text = self._viewer.texts
        with ui.tabs().props('dense no-caps inline-label mobile-arrows').classes('tabs') as self._tabs:
            for name, (icon, _) in PANELS.items():
                with ui.tab(name, text(f'tabs.{name}'), icon):
                    if name == 'messages':
                        self._pending = ui.badge().props('floating color=negative')
        with ui.tab_panels(self._tabs, value='jog', animated=False).classes('panels').props('keep-alive'):
            self._places = {name: ui.tab_panel(name) for name in PANELS}
        with self._places['jog']:
            self._jog = JogPanel(self._viewer)
        self._panels: dict[str, Panel] = {'jog': self._jog}

    def _panel(self, name: str) -> Panel:
        """A panel, which is made when it is opened first: a page with all of them takes long to load."""
        if name not in self._panels:
            with self._places[name]:
                self._panels[name] = PANELS[name][1](self._viewer)
        return self._panels[name]

    # -- what is held -------------------------------------------------------------------------------------

    def _hold(self, event: GenericEventArguments) -> Awaitable[object] | None:
        """Take a sign at once, before the release is served; the action that it starts may take longer."""
        number, key = _press(event.args)
        program = self._panels.get('program') if key == RUN_KEY or key.startswith(STEP_KEY) else None
        panel = program if isinstance(program, ProgramPanel) else self._jog
        if number != self._number:
            self._number = number
            panel.line.show('')
            self._taught = self._jog.taught
        try:
            jog = self._jog
            sign = Sign(self._viewer.id, number, key, jog.speed, jog.step(key), self._taught)
            action = self._operator.hold(sign)
        except RobotsError as error:
            panel.line.show(self._viewer.texts.error(error))
            return None
        if action is None:
            return None
        if action is Action.STEP:
            return panel.do(self._operator.step, key.removeprefix(STEP_KEY))
        return panel.do(self._operator.act, action)

    def _release(self) -> None:
        self._operator.release(self._viewer.id)

    async def _on_connect(self) -> None:
        """Send everything again to a browser that comes back.

        NiceGUI sends first what has changed meanwhile, then what the browser had missed before: old values
        would stay. A browser has received all of that when it answers.
        """
        again, self._connected_before = self._connected_before, True
        if not again:
            return
        with suppress(TimeoutError):  # the connection is lost again: the next one starts anew
            await self._client.run_javascript('true', timeout=ANSWERS_WITHIN)
            for element in list(self._client.elements.values()):
                element.update()

    async def _on_disconnect(self) -> None:
        """Release at once; a page that does not come back soon was closed, and gives control back."""
        self._release()
        await asyncio.sleep(GONE_AFTER)
        if not self._client.has_socket_connection:
            self._operator.give_back_control(self._viewer.id)

    # -- what is shown ------------------------------------------------------------------------------------

    def refresh(self) -> None:
        """Show the newest state: the bar, and the panel that is in front."""
        state = self._operator.state
        self._bar.refresh(state)
        pending = self._operator.messages.pending
        self._pending.set_text(str(pending))
        self._pending.set_visibility(bool(pending))
        self._panel(str(self._tabs.value)).refresh(state)
        self._viewer.show_permitted()

    def _refresh_with_scene(self) -> None:
        """As `refresh`; the 3D view, which takes a browser long to draw, comes when the page is connected."""
        self.refresh()
        state = self._operator.state
        if state.scene_url != self._scene_url:
            self._scene_url = state.scene_url
            source = json.dumps(_scene_source(state.scene_url, self._host))
            ui.run_javascript(f'pendant.showScene("{self._scene.html_id}", {source})')
            self._scene.set_visibility(bool(state.scene_url))
            self._no_scene.set_visibility(not state.scene_url)


def _press(arguments: Any) -> tuple[int, str]:
    """Number and key of a press, as the browser sends them."""
    number, key, *_ = [*arguments, 0, ''] if isinstance(arguments, list) else [0, '']
    return (number, key) if isinstance(number, int) and isinstance(key, str) else (0, '')


def _scene_source(url: str, host: str) -> str:
    """Where a browser gets the 3D view: through the page's own server, or on this machine directly.

    Directly it has another name of this machine than the page has. A browser then gives it a process of its
    own: drawing it does not delay the signs of a held button.
    """
    if not is_this_machine(host.rpartition(':')[0]):
        return f'{SCENE}/' if url else ''
    return url.replace('127.0.0.1', 'localhost') if host.startswith('127.0.0.1') else url


@cache
def _asset(name: str) -> str:
    return (files('robots_controller.pendant.page') / name).read_text('utf-8')
