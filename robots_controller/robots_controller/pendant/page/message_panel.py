"""MessagePanel: what happened, newest first."""

from __future__ import annotations

import time
from collections.abc import Sequence
from html import escape
from typing import Final

from nicegui import ui

from robots_controller.pendant.message_log import Level, LoggedMessage
from robots_controller.pendant.page.elements import Changes, choices, text_button
from robots_controller.pendant.page.viewer import Part, Viewer
from robots_controller.pendant.pendant_state import PendantState
from robots_controller.pendant.texts import Texts

MOST_ROWS: Final = 100


class MessagePanel(Part):
    """The messages of all nodes, with a filter; they are acknowledged and exported here."""

    def __init__(self, viewer: Viewer) -> None:
        super().__init__(viewer)
        text = viewer.texts
        self._changed = Changes()
        self._known: Sequence[LoggedMessage] = ()
        with ui.element('div').classes('panel message-panel'):
            with ui.element('div').classes('row-of-buttons'):
                names = {Level.INFO: 'all', Level.WARNING: 'warnings', Level.ERROR: 'errors'}
                shown = {level: text(f'messages.{name}') for level, name in names.items()}
                self._lowest = choices(shown, Level.INFO)
            with ui.element('div').classes('row-of-buttons'):
                self._search = ui.input(text('messages.search')).props(
                    'dense outlined clearable debounce=200'
                )
                text_button(text('messages.acknowledge'), 'done_all', self._acknowledge)
                text_button(text('messages.export'), 'download', self._export)
            self._list = ui.html('', sanitize=False).classes('messages')

    def refresh(self, _state: PendantState) -> None:
        """Show the messages."""
        log, part, lowest = self.operator.messages, str(self._search.value or ''), self._lowest.value
        if not self._changed(log.version, part, lowest):
            return
        self._known = log.shown()
        rows = [_row(message, self.text) for message in log.shown(lowest, part)[:MOST_ROWS]]
        nothing = f'<div class="hint">{escape(self.text("messages.none"))}</div>'
        self._list.set_content(''.join(rows) or nothing)

    def _acknowledge(self) -> None:
        """Those that the page had when it was pressed, of any level."""
        self.operator.messages.acknowledge(self._known)

    def _export(self) -> None:
        messages = self.operator.messages.shown(self._lowest.value, str(self._search.value or ''))
        ui.download.content(
            '\n'.join('\t'.join(_cells(message)) for message in messages) + '\n', 'messages.tsv'
        )


def _cells(message: LoggedMessage) -> tuple[str, ...]:
    when = time.strftime('%Y-%m-%d %H:%M:%S', time.localtime(message.time))
    text = ' '.join(message.text.split())
    return when, message.level.name.lower(), message.node, message.place, str(message.count), text


def _row(message: LoggedMessage, text: Texts) -> str:
    when, name, node, place, *_ = _cells(message)
    icon = f'<i class="material-icons" title="{escape(text(f"messages.{name}"))}">{name}</i>'
    count = f'<span class="count">×{message.count}</span>' if message.count > 1 else ''  # noqa: RUF001
    return (
        f'<div class="message {name}{" seen" if message.acknowledged else ""}">{icon}'
        f'<div><div class="caption">{when[11:]} {escape(node)} {escape(place)} {count}</div>'
        f'<div class="text">{escape(message.text)}</div></div></div>'
    )
