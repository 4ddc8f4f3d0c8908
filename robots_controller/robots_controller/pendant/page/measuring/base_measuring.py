"""BaseMeasuring: the guide to measure a base by three points."""

from __future__ import annotations

from nicegui import ui

from robots_controller.measuring.frame_measuring import NEEDED
from robots_controller.measuring.shown_numbers import degrees, millimetres
from robots_controller.pendant.page.elements import Choice
from robots_controller.pendant.page.measuring.guide import Guide, TouchedPoints, show_result
from robots_core.errors import RobotsError


class BaseMeasuring(Guide):
    """The tool that touches, the points, and what follows from them."""

    name = 'base'
    kind = 'base'

    def build(self) -> None:
        """See `Guide`."""
        text = self.text
        self._tool = Choice({'': text('frames.flange')}, value='', label=text('frames.touching_tool'))
        self._tool.classes('point')
        self._points = TouchedPoints(self.viewer, 'base', self.line)
        self._found = ui.label().classes('found number')

    def save(self, name: str) -> None:
        """See `Guide`."""
        self.operator.measuring.save_base(self.file(), name, self._touching)

    @property
    def _touching(self) -> str:
        return str(self._tool.value or '')

    def refresh(self) -> None:
        """See `Guide`."""
        super().refresh()
        tools = self.frames.names('tool')
        self._tool.show({'': self.text('frames.flange')} | {name: name for name in tools})
        if self.changed(*self.operator.measuring.points['base'], self._touching, self.frames):
            self._show()
        self._points.refresh([self.text(f'frames.base_{i + 1}') for i in range(NEEDED['base'])])

    def _show(self) -> None:
        measuring = self.operator.measuring
        found, wrong = '', False
        try:
            if measuring.complete('base'):
                base = measuring.base(measuring.tool_of(self.file(), self._touching))
                angles = degrees(base, self.operator.robot.orientation_convention)
                found = self.text('frames.pose', **millimetres(base.r), **angles)
        except RobotsError as error:
            found, wrong = self.text.error(error), True
        show_result(self._found, found, wrong=wrong)
