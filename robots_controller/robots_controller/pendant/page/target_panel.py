"""TargetPanel: the robot moves to typed positions or a typed pose, which the 3D view shows before."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

from nicegui import run, ui

from robots_controller.pendant.jog.held_button import MOVE_KEY
from robots_controller.pendant.jog.pendant_motion import WAYS, Preview
from robots_controller.pendant.page.elements import choices, held_button, mark, text_button
from robots_controller.pendant.page.viewer import PERIOD, Part, RefusalLine, Viewer
from robots_controller.pendant.pendant_state import PendantState
from robots_core.errors import InvalidInputError, RobotsError

MILLIMETRES: Final = 1e3
STAY: Final = 1.0  # s at the target, before the path around obstacles is shown again


class TargetPanel(Part):
    """Fields for a target, and the buttons to preview it and to move there.

    `speed` gives the part of the highest jog speed, 0..1.
    """

    def __init__(self, viewer: Viewer, speed: Callable[[], float], line: RefusalLine) -> None:
        super().__init__(viewer, line)
        self._speed = speed
        self._around: Preview | None = None  # what the ghost runs along
        self._played = 0.0  # s of it
        self._fields: list[tuple[ui.number, float]] = []  # with the factor from SI
        text = viewer.texts
        with ui.element('div').classes('panel target') as self.element:
            ways = {way: text(f'target.{way}') for way in WAYS}
            self._way = choices(ways, 'joints', self._build)
            self._grid = ui.element('div').classes('fields')
            with ui.element('div').classes('row-of-buttons'):
                text_button(text('target.present'), 'my_location', self._fill)
                text_button(text('target.preview'), 'visibility', self._preview)
                self._move = held_button(MOVE_KEY, 'play_arrow', text('target.move'))
            self._found = ui.label().classes('hint')
        self._build()

    def _build(self) -> None:
        robot, convention = self.operator.robot, self.operator.robot.orientation_convention
        self._grid.clear()
        with self._grid:
            if self._way.value == 'joints':
                axes = robot.axes_data
                slides = zip(axes.names, axes.prismatic, strict=True)
                self._fields = [self._field(name, slides=one) for name, one in slides]
            else:
                self._fields = [self._field(axis, slides=True) for axis in 'XYZ']
                self._fields += [self._field(f'φ{i} ({convention})', slides=False) for i in (1, 2, 3)]
        self._fill()
        self._forget()

    def _field(self, name: str, *, slides: bool) -> tuple[ui.number, float]:
        field = ui.number(name, format='%.3f', suffix='mm' if slides else '°', on_change=self._forget)
        return field.props('dense outlined'), MILLIMETRES if slides else math.degrees(1.0)

    def _fill(self) -> None:
        """Write where the robot is into the fields."""
        state = self.operator.state
        if state.q is None or state.tool is None:
            return
        if self._way.value == 'joints':
            values = state.q.tolist()
        else:
            angles = state.tool.angles(self.operator.robot.orientation_convention)
            values = [*state.tool.r.tolist(), *angles.tolist()]
        for (field, factor), value in zip(self._fields, values, strict=True):
            field.set_value(round(factor * value, 3) + 0.0)

    def _forget(self) -> None:
        self.operator.forget_preview(self.viewer.id)
        self._show(None)

    def _show(self, found: Preview | None) -> None:
        self._around, self._played = (found if found is not None and found.around else None), 0.0
        mark(self._move, 'blocked', on=found is None)
        if found is None:
            self._found.set_text(self.text('target.hint'))
            return
        override = self.operator.state.override
        duration = f'{found.duration / override:.1f}' if override > 0.0 else '∞'
        lines = [self.text('target.found', duration=duration, axis=found.limiting_axis)]
        if found.around:
            lines.append(self.text('target.around'))
        if (closest := found.closest) is not None:
            distance = f'{MILLIMETRES * closest.distance:.1f}'
            lines.append(
                self.text('target.closest', distance=distance, first=closest.first, second=closest.second)
            )
        self._found.set_text(' '.join(lines))

    async def _preview(self) -> None:
        viewer, self._found.text = self.viewer, self.text('target.planning')
        try:
            values = [self._si(field, factor) for field, factor in self._fields]
            work = viewer.operator.preview
            found = await run.io_bound(work, viewer.id, self._way.value, values, self._speed())
        except RobotsError as error:
            self.line.show(viewer.texts.error(error))
            self._show(None)
            return
        if found is not None:  # otherwise its fields have changed meanwhile
            self.line.show('')
            self._show(found)

    @staticmethod
    def _si(field: ui.number, factor: float) -> float:
        if field.value is None:
            raise InvalidInputError(
                f'{field.label} is empty; valid is a number', key='empty_field', field=str(field.label)
            )
        return float(field.value) / factor

    def set_shown(self, *, shown: bool) -> None:
        """Show the panel, or hide it and forget its target."""
        self.element.set_visibility(shown)
        if not shown:
            self._forget()

    def refresh(self, state: PendantState) -> None:
        """Fill the fields with the first position that comes, and show the next position of a path around."""
        if self._around is not None:
            self.operator.play_preview(self.viewer.id, self._played)
            self._played = (self._played + PERIOD) % (self._around.duration + STAY)
        if state.q is not None and all(field.value is None for field, _ in self._fields):
            self._fill()
