"""Viewer: one page that is open, and how its panels do what is pressed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Protocol

from nicegui import run, ui

from robots_controller.pendant.pendant_operator import PendantOperator
from robots_controller.pendant.pendant_state import PendantState
from robots_controller.pendant.permissions import Action, NotPermittedError, refusal
from robots_controller.pendant.texts import Texts
from robots_core.errors import RobotsError

PERIOD: Final = 0.1  # s between two refreshes


class Panel(Protocol):
    """A part of the page."""

    def refresh(self, state: PendantState) -> None:
        """Show a state."""


class RefusalLine:
    """Says, beside what was pressed, why it was refused."""

    def __init__(self) -> None:
        self._label = ui.label().classes('refusal').props('role=alert')
        self.show('')

    def show(self, text: str) -> None:
        """Show a reason; '' for none."""
        self._label.set_text(text)
        self._label.set_visibility(bool(text))


@dataclass(frozen=True)
class Viewer:
    """One page that is open.

    Attributes:
        id: Its own.
        operator: Takes what is pressed.
        texts: In its language.
        refresh: Shows the newest state on it.
        address: Of its browser.
    """

    id: str
    operator: PendantOperator
    texts: Texts
    refresh: Callable[[], None]
    address: str = ''

    async def do(self, line: RefusalLine, work: Callable[[], None]) -> bool:
        """Do what waits for an answer of the cell, and show why it was refused; True if it was not.

        What has changed is shown before the caller confirms it: no button moves after the confirmation.
        """
        try:
            await run.io_bound(work)
        except RobotsError as error:
            line.show(self.texts.error(error))
            return False
        line.show('')
        self.refresh()
        return True

    def reason(self, action: Action) -> str:
        """Why an action is not permitted; '' if it is."""
        found = refusal(action, self.operator.state)
        try:
            self.operator.desk.check(self.id)
        except NotPermittedError as error:
            return self.texts.error(error)
        return '' if found is None else self.texts.reason(found)


class ActionButton:
    """A button for an action; one that is not permitted is pale, and says why when it is pressed.

    Args:
        viewer: Its page.
        action: What it does.
        text: On it.
        icon: Before the text.
        press: Called when it is pressed; may be a coroutine.
    """

    def __init__(
        self, viewer: Viewer, action: Action, text: str, icon: str, press: Callable[[], object]
    ) -> None:
        self._viewer: Final = viewer
        self._action = action
        self.element = (
            ui.button(text, icon=icon, on_click=press, color=None)
            .props('unelevated no-caps')
            .classes('action')
        )
        with self.element:
            self._tooltip = ui.tooltip()
        self._reason: str | None = None

    def refresh(self) -> None:
        """Show whether it is permitted."""
        reason = self._viewer.reason(self._action)
        if reason == self._reason:
            return
        self._reason = reason
        self.element.classes(add='blocked' if reason else '', remove='' if reason else 'blocked')
        self.element.props(f'aria-disabled={"true" if reason else "false"}')
        self._tooltip.set_text(reason)
        self._tooltip.set_visibility(bool(reason))
