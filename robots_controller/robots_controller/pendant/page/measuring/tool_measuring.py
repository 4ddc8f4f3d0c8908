"""ToolMeasuring: the guide to measure a tool, by four points or more and two for its orientation."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Final

from nicegui import ui

from robots_controller.measuring.frame_measuring import NEEDED
from robots_controller.measuring.shown_numbers import degrees, millimetres
from robots_controller.pendant.page.measuring.saved_frame import SavedFrame
from robots_controller.pendant.page.measuring.touched_points import TouchedPoints
from robots_controller.pendant.page.viewer import RefusalLine, Viewer
from robots_controller.pendant.pendant_state import PendantState
from robots_core.blocks.calibration.three_points import AXES, Axis
from robots_core.errors import MeasurementError

FIRST_AXIS: Final[Axis] = '-z'


class ToolMeasuring:
    """Points, what follows from them, and the name.

    Args:
        viewer: Its page.
        line: Says why something is refused.
        file: Gives the frames file.
    """

    def __init__(self, viewer: Viewer, line: RefusalLine, file: Callable[[], Path]) -> None:
        self._viewer, text = viewer, viewer.texts
        self._axis: Axis = FIRST_AXIS
        self._known: object = None
        with ui.element('div').classes('guide tool-guide') as self.element:
            ui.label(text('frames.tool_hint')).classes('hint')
            self._points = TouchedPoints(viewer, 'tool', line)
            self._found = ui.label().classes('found number')
            with ui.expansion(text('frames.orientation'), icon='3d_rotation').classes('orientation'):
                ui.label(text('frames.orientation_hint')).classes('hint')
                ui.select(
                    {axis: axis if axis.startswith('-') else f'+{axis}' for axis in AXES},
                    value=self._axis,
                    on_change=lambda event: self._set_axis(event.value),
                ).props(f'dense outlined options-dense label="{text("frames.axis")}"').classes('point')
                self._turns = TouchedPoints(viewer, 'orientation', line)
                self._turned = ui.label().classes('found number')
            measuring = viewer.operator.measuring
            self._saved = SavedFrame(
                viewer, 'tool', line, file, lambda name: measuring.save_tool(file(), name, self._axis)
            )

    def _set_axis(self, axis: Axis) -> None:
        self._axis = axis

    def refresh(self, _state: PendantState) -> None:
        """Show a state."""
        self._saved.refresh()
        measuring, text = self._viewer.operator.measuring, self._viewer.texts
        touched, turned = (tuple(measuring.points[kind]) for kind in ('tool', 'orientation'))
        known = (*map(id, touched), *map(id, turned), self._axis)
        if known != self._known:
            self._known = known
            self._residuals = [
                text('frames.residual', distance=f'{1e3 * one:.2f}') for one in measuring.residuals()
            ]
            self._show()
        count = max(NEEDED['tool'], len(touched))
        self._points.refresh([text('frames.point', number=i + 1) for i in range(count)], self._residuals)
        axis, plane = self._axis, 'xyz'[('xyz'.index(self._axis[-1]) + 1) % 3]
        self._turns.refresh(
            [
                text('frames.orientation_1', axis=axis if axis.startswith('-') else f'+{axis}'),
                text('frames.orientation_2', plane=plane),
            ]
        )

    def _show(self) -> None:
        measuring, text = self._viewer.operator.measuring, self._viewer.texts
        found = turned = ''
        wrong = False
        try:
            if measuring.complete('tool'):
                center = measuring.tool_center()
                values = {
                    'std': f'{1e3 * center.std.max():.2f}',
                    'residual': f'{1e3 * center.residuals.max():.2f}',
                }
                found = text('frames.center', **millimetres(center.r), **values)
                if measuring.complete('orientation'):
                    convention = self._viewer.operator.robot.orientation_convention
                    turned = text('frames.angles', **degrees(measuring.tool(self._axis), convention))
        except MeasurementError as error:
            wrong = True
            if found:
                turned = text.error(error)
            else:
                found = text.error(error)
        for label, shown in ((self._found, found), (self._turned, turned)):
            label.set_text(shown)
            label.set_visibility(bool(shown))
            bad = wrong and label is (self._turned if turned else self._found)
            label.classes(add='wrong' if bad else '', remove='' if bad else 'wrong')
