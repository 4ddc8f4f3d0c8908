"""Viewer: one page that is open; and Part, of which its panels are made."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, Protocol, TypeVar

from nicegui import run, ui

from robots_controller.pendant.page.elements import Changes, mark, show_hint, show_text, text_button
from robots_controller.pendant.pendant_operator import PendantOperator
from robots_controller.pendant.pendant_state import PendantState
from robots_controller.pendant.permissions import Action, NotPermittedError
from robots_controller.pendant.texts import Texts
from robots_core.errors import RobotsError

PERIOD: Final = 0.1  # s between two refreshes
T = TypeVar('T')


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
        show_text(self._label, text)


@dataclass(frozen=True)
class Viewer:
    """One page that is open.

    Attributes:
        id: Its own.
        operator: Takes what is pressed.
        texts: In its language.
        refresh: Shows the newest state on it.
        folder: Of the robot programs.
        address: Of its browser.
        buttons: For actions; see `show_permitted`.
    """

    id: str
    operator: PendantOperator
    texts: Texts
    refresh: Callable[[], None]
    folder: Path
    address: str = ''
    buttons: list[ActionButton] = field(default_factory=list)

    def reason(self, action: Action) -> str:
        """Why an action is not permitted; '' if it is."""
        try:
            self.operator.check(self.id, action)
        except NotPermittedError as error:
            return self.texts.error(error)
        return ''

    def show_permitted(self) -> None:
        """Show at all buttons for actions whether these are permitted."""
        reasons = {action: self.reason(action) for action in {one.action for one in self.buttons}}
        for button in self.buttons:
            button.show(reasons[button.action])


class Part:
    """A part of a page.

    Args:
        viewer: Its page.
        line: Says why something is refused; a part that gets none makes its own where it is wanted.
    """

    line: RefusalLine

    def __init__(self, viewer: Viewer, line: RefusalLine | None = None) -> None:
        self.viewer, self.operator, self.text = viewer, viewer.operator, viewer.texts
        if line is not None:
            self.line = line

    async def do(self, work: Callable[..., T], *values: Any, **named: Any) -> tuple[T, ...]:
        """Do what waits for an answer of the cell, and show why it was refused.

        The work gets the id of the viewer before its other arguments, and raises a RobotsError if refused.
        What has changed is shown before the caller confirms it: no button moves after the confirmation.

        Returns:
            What the work returns, alone in a tuple; () if it was refused.
        """
        try:
            done = await run.io_bound(lambda: (work(self.viewer.id, *values, **named),))
        except RobotsError as error:
            self.line.show(self.text.error(error))
            return ()
        self.line.show('')
        self.viewer.refresh()
        return done or ()

    def read(self, work: Callable[[], T]) -> T | None:
        """What some work returns; None where it fails, and why is shown."""
        try:
            return work()
        except RobotsError as error:
            self.line.show(self.text.error(error))
            return None


class ActionButton(Part):
    """A button for an action; one that is not permitted is pale, and says why when it is pressed."""

    def __init__(
        self, viewer: Viewer, action: Action, text: str, icon: str, press: Callable[[], object]
    ) -> None:
        super().__init__(viewer)
        self.action, self._changed = action, Changes()
        self.element = text_button(text, icon, press)
        viewer.buttons.append(self)

    def show(self, reason: str) -> None:
        """Show why it is not permitted; '' if it is."""
        if self._changed(reason):
            mark(self.element, 'blocked', on=bool(reason))
            self.element.props(f'aria-disabled={"true" if reason else "false"}')
            show_hint(self.element, reason)
