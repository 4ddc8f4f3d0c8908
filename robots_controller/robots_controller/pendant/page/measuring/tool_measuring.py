"""ToolMeasuring: the guide to measure a tool, by four points or more and two for its orientation."""

from __future__ import annotations

from typing import Final, cast

from nicegui import ui

from robots_controller.measuring.frame_measuring import NEEDED
from robots_controller.measuring.shown_numbers import degrees, millimetres
from robots_controller.pendant.page.elements import Choice
from robots_controller.pendant.page.measuring.guide import Guide, TouchedPoints, show_result
from robots_core.blocks.calibration.three_points import AXES, Axis
from robots_core.errors import MeasurementError

FIRST_AXIS: Final[Axis] = '-z'
AXIS_NAMES: Final = {axis: axis if axis.startswith('-') else f'+{axis}' for axis in AXES}


class ToolMeasuring(Guide):
    """Points, and what follows from them."""

    name = 'tool'
    kind = 'tool'

    def build(self) -> None:
        """See `Guide`."""
        text = self.text
        self._residuals: list[str] = []
        self._points = TouchedPoints(self.viewer, 'tool', self.line)
        self._found = ui.label().classes('found number')
        with ui.expansion(text('frames.orientation'), icon='3d_rotation').classes('orientation'):
            ui.label(text('frames.orientation_hint')).classes('hint')
            self._choice = Choice({**AXIS_NAMES}, value=FIRST_AXIS, label=text('frames.axis'))
            self._choice.classes('point')
            self._turns = TouchedPoints(self.viewer, 'orientation', self.line)
            self._turned = ui.label().classes('found number')

    @property
    def _axis(self) -> Axis:
        return cast(Axis, self._choice.value)

    def save(self, name: str) -> None:
        """See `Guide`."""
        self.operator.measuring.save_tool(self.file(), name, self._axis)

    def refresh(self) -> None:
        """See `Guide`."""
        super().refresh()
        measuring, text, axis = self.operator.measuring, self.text, self._axis
        touched, turned = (tuple(measuring.points[kind]) for kind in ('tool', 'orientation'))
        if self.changed(touched, turned, axis):
            self._residuals = [
                text('frames.residual', distance=f'{1e3 * one:.2f}') for one in measuring.residuals()
            ]
            self._show()
        count = max(NEEDED['tool'], len(touched))
        self._points.refresh([text('frames.point', number=i + 1) for i in range(count)], self._residuals)
        plane = 'xyz'[('xyz'.index(axis[-1]) + 1) % 3]
        self._turns.refresh(
            [
                text('frames.orientation_1', axis=AXIS_NAMES[axis]),
                text('frames.orientation_2', plane=plane),
            ]
        )

    def _show(self) -> None:
        measuring = self.operator.measuring
        found = turned = ''
        wrong: ui.label | None = None
        try:
            if measuring.complete('tool'):
                center = measuring.tool_center()
                values = {
                    'std': f'{1e3 * center.std.max():.2f}',
                    'residual': f'{1e3 * center.residuals.max():.2f}',
                }
                found = self.text('frames.center', **millimetres(center.r), **values)
                if measuring.complete('orientation'):
                    convention = self.operator.robot.orientation_convention
                    turned = self.text('frames.angles', **degrees(measuring.tool(self._axis), convention))
        except MeasurementError as error:
            if found:
                turned, wrong = self.text.error(error), self._turned
            else:
                found, wrong = self.text.error(error), self._found
        show_result(self._found, found, wrong=wrong is self._found)
        show_result(self._turned, turned, wrong=wrong is self._turned)
