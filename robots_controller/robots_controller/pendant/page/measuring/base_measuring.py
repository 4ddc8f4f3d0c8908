"""BaseMeasuring: the guide to measure a base by three points."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from nicegui import ui

from robots_controller.measuring.frame_measuring import NEEDED
from robots_controller.measuring.shown_numbers import degrees, millimetres
from robots_controller.pendant.page.choice import Choice
from robots_controller.pendant.page.measuring.saved_frame import SavedFrame, file_names
from robots_controller.pendant.page.measuring.touched_points import TouchedPoints
from robots_controller.pendant.page.viewer import RefusalLine, Viewer
from robots_controller.pendant.pendant_state import PendantState
from robots_core.errors import RobotsError


class BaseMeasuring:
    """The tool that touches, the points, what follows from them, and the name.

    Args:
        viewer: Its page.
        line: Says why something is refused.
        file: Gives the frames file.
    """

    def __init__(self, viewer: Viewer, line: RefusalLine, file: Callable[[], Path]) -> None:
        self._viewer, self._line, self._file, text = viewer, line, file, viewer.texts
        self._known: object = None
        self._read: object = None
        with ui.element('div').classes('guide base-guide') as self.element:
            ui.label(text('frames.base_hint')).classes('hint')
            self._tool = (
                Choice({'': text('frames.flange')}, value='')
                .props(f'dense outlined options-dense label="{text("frames.touching_tool")}"')
                .classes('point')
            )
            self._points = TouchedPoints(viewer, 'base', line)
            self._found = ui.label().classes('found number')
            measuring = viewer.operator.measuring
            self._saved = SavedFrame(
                viewer, 'base', line, file, lambda name: measuring.save_base(file(), name, self._touching)
            )

    @property
    def _touching(self) -> str:
        return str(self._tool.value or '')

    def refresh(self, _state: PendantState) -> None:
        """Show a state."""
        self._saved.refresh()
        measuring, text = self._viewer.operator.measuring, self._viewer.texts
        names = file_names(self._viewer, self._line, self._file(), 'tool', self._read)
        if names is not None:
            self._read, tools = names
            self._tool.show({'': text('frames.flange')} | {name: name for name in tools})
        known = (*map(id, measuring.points['base']), self._touching, self._read)
        if known != self._known:
            self._known = known
            self._show()
        self._points.refresh([text(f'frames.base_{i + 1}') for i in range(NEEDED['base'])])

    def _show(self) -> None:
        measuring, text = self._viewer.operator.measuring, self._viewer.texts
        found, wrong = '', False
        try:
            if measuring.complete('base'):
                base = measuring.base(measuring.tool_of(self._file(), self._touching))
                angles = degrees(base, self._viewer.operator.robot.orientation_convention)
                found = text('frames.pose', **millimetres(base.r), **angles)
        except RobotsError as error:
            found, wrong = text.error(error), True
        self._found.set_text(found)
        self._found.set_visibility(bool(found))
        self._found.classes(add='wrong' if wrong else '', remove='' if wrong else 'wrong')
