"""The guides that touch points: of tools, with two points for their orientation, and of bases."""

from __future__ import annotations

from typing import Final, cast

from nicegui import ui

from robots_controller.measuring.frame_measuring import NEEDED
from robots_controller.measuring.shown_numbers import degrees, millimetres
from robots_controller.pendant.page.elements import Choice
from robots_controller.pendant.page.measuring.guide import Guide, TouchedPoints
from robots_core.blocks.calibration.three_points import AXES, Axis

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
            good = self.show_result(self._found, self._center)
            self.show_result(self._turned, self._orientation if good else str)
        count = max(NEEDED['tool'], len(touched))
        self._points.refresh([text('frames.point', number=i + 1) for i in range(count)], self._residuals)
        plane = 'xyz'[('xyz'.index(axis[-1]) + 1) % 3]
        self._turns.refresh(
            [
                text('frames.orientation_1', axis=AXIS_NAMES[axis]),
                text('frames.orientation_2', plane=plane),
            ]
        )

    def _center(self) -> str:
        measuring = self.operator.measuring
        if not measuring.complete('tool'):
            return ''
        center = measuring.tool_center()
        std, residual = (f'{1e3 * one.max():.2f}' for one in (center.std, center.residuals))
        return self.text('frames.center', **millimetres(center.r), std=std, residual=residual)

    def _orientation(self) -> str:
        measuring, convention = self.operator.measuring, self.operator.robot.orientation_convention
        if not (measuring.complete('tool') and measuring.complete('orientation')):
            return ''
        return self.text('frames.angles', **degrees(measuring.tool(self._axis), convention))


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
            self.show_result(self._found, self._base)
        self._points.refresh([self.text(f'frames.base_{i + 1}') for i in range(NEEDED['base'])])

    def _base(self) -> str:
        measuring = self.operator.measuring
        if not measuring.complete('base'):
            return ''
        base = measuring.base(measuring.tool_of(self.file(), self._touching))
        angles = degrees(base, self.operator.robot.orientation_convention)
        return self.text('frames.pose', **millimetres(base.r), **angles)
