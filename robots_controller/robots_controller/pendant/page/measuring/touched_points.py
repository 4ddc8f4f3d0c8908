"""TouchedPoints: the points of a sequence, those that are touched and those to come."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Final

from nicegui import ui

from robots_controller.measuring.frame_measuring import NEEDED
from robots_controller.measuring.frame_measuring import Sequence as Kind
from robots_controller.pendant.page.viewer import ActionButton, RefusalLine, Viewer
from robots_controller.pendant.permissions import Action

ICONS: Final = {'touched': 'check_circle', 'next': 'arrow_forward', 'later': 'radio_button_unchecked'}


class TouchedPoints:
    """A row for each point, and buttons that touch the next one and start again.

    Args:
        viewer: Its page.
        kind: The sequence.
        line: Says why something is refused.
    """

    def __init__(self, viewer: Viewer, kind: Kind, line: RefusalLine) -> None:
        self._viewer, self._kind, self._line = viewer, kind, line
        self._shown: tuple[object, ...] = ()
        text = viewer.texts
        with ui.element('div').classes('sequence'):
            self._rows = ui.element('div').classes('touched-points')
            with ui.element('div').classes('row-of-buttons'):
                self._buttons = [
                    ActionButton(viewer, Action.TEACH, text('frames.touch'), 'ads_click', self._touch),
                    ActionButton(viewer, Action.TEACH, text('frames.again'), 'restart_alt', self._clear),
                ]

    async def _touch(self) -> None:
        viewer = self._viewer
        operator = viewer.operator
        await viewer.do(
            self._line, lambda: operator.measuring.touch(self._kind, operator.measured_position(viewer.id))
        )

    async def _clear(self) -> None:
        viewer = self._viewer

        def work() -> None:
            viewer.operator.check_measuring(viewer.id)
            viewer.operator.measuring.clear(self._kind)

        await viewer.do(self._line, work)

    async def _remove(self, index: int) -> None:
        viewer = self._viewer

        def work() -> None:
            viewer.operator.check_measuring(viewer.id)
            viewer.operator.measuring.remove(self._kind, index)

        await viewer.do(self._line, work)

    def refresh(self, names: Sequence[str], details: Sequence[str] = ()) -> None:
        """Show the points.

        Args:
            names: Of all points, one for each row.
            details: Of the touched ones; 'touched' by default.
        """
        for button in self._buttons:
            button.refresh()
        count = len(self._viewer.operator.measuring.points[self._kind])
        shown = (count, *names, *details)
        if shown == self._shown:
            return
        self._shown = shown
        self._rows.clear()
        with self._rows:
            for index in range(max(NEEDED[self._kind], count)):
                state = 'touched' if index < count else 'next' if index == count else 'later'
                detail = details[index] if index < len(details) else self._viewer.texts('frames.touched')
                self._build_row(index, state, names[index], detail if state == 'touched' else '')

    def _build_row(self, index: int, state: str, name: str, detail: str) -> None:
        with ui.element('div').classes(f'touched-point {state}'):
            ui.icon(ICONS[state])
            ui.label(name).classes('name')
            ui.label(detail).classes('number detail')
            if state == 'touched':
                label = self._viewer.texts('frames.remove', name=name)
                ui.button(icon='close', on_click=partial(self._remove, index), color=None).props(
                    f'flat dense round aria-label="{label}"'
                )
