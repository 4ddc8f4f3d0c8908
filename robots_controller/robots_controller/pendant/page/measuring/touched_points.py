"""TouchedPoints: the points of a sequence, those that are touched and those to come."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Sequence
from functools import partial
from typing import Final

from nicegui import ui

from robots_controller.measuring.frame_measuring import NEEDED
from robots_controller.measuring.frame_measuring import Sequence as Kind
from robots_controller.pendant.page.elements import Changes, icon_button
from robots_controller.pendant.page.viewer import ActionButton, Part, RefusalLine, Viewer
from robots_controller.pendant.permissions import Action

ICONS: Final = {'touched': 'check_circle', 'next': 'arrow_forward', 'later': 'radio_button_unchecked'}


class TouchedPoints(Part):
    """A row for each point, and buttons that touch the next one and start again.

    Args:
        kind: The sequence.
        line: Says why something is refused.
    """

    def __init__(self, viewer: Viewer, kind: Kind, line: RefusalLine) -> None:
        super().__init__(viewer)
        self._kind, self._line, self._changed = kind, line, Changes()
        text, operator, measuring = viewer.texts, viewer.operator, viewer.operator.measuring
        with ui.element('div').classes('sequence'):
            self._rows = ui.element('div').classes('touched-points')
            with ui.element('div').classes('row-of-buttons'):
                for key, icon, press in (
                    ('touch', 'ads_click', lambda: viewer.do(line, operator.touch, kind)),
                    ('again', 'restart_alt', lambda: self._do(partial(measuring.clear, kind))),
                ):
                    ActionButton(viewer, Action.TEACH, text(f'frames.{key}'), icon, press)

    def _do(self, step: Callable[[], None]) -> Awaitable[object]:
        return self.viewer.do(self._line, self.operator.measure, step)

    def refresh(self, names: Sequence[str], details: Sequence[str] = ()) -> None:
        """Show the points.

        Args:
            names: Of all points, one for each row.
            details: Of the touched ones; 'touched' by default.
        """
        count = len(self.operator.measuring.points[self._kind])
        if not self._changed(count, *names, *details):
            return
        self._rows.clear()
        with self._rows:
            for index in range(max(NEEDED[self._kind], count)):
                state = 'touched' if index < count else 'next' if index == count else 'later'
                detail = details[index] if index < len(details) else self.text('frames.touched')
                self._build_row(index, state, names[index], detail if state == 'touched' else '')

    def _build_row(self, index: int, state: str, name: str, detail: str) -> None:
        with ui.element('div').classes(f'touched-point {state}'):
            ui.icon(ICONS[state])
            ui.label(name).classes('name')
            ui.label(detail).classes('number detail')
            if state == 'touched':
                label = self.text('frames.remove', name=name)
                remove = partial(self.operator.measuring.remove, self._kind, index)
                icon_button('close', label, lambda: self._do(remove))
