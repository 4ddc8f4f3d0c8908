"""JogPanel: the robot moves while a button is held."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np
from nicegui import ui

from robots_controller.pendant.jog.jog_command import JOG_FRAMES
from robots_controller.pendant.page.elements import Changes, Choice, choices, mark
from robots_controller.pendant.page.target_panel import TargetPanel
from robots_controller.pendant.page.viewer import Part, RefusalLine, Viewer
from robots_controller.pendant.pendant_state import PendantState
from robots_controller.pendant.permissions import Action
from robots_controller.pendant.texts import Texts
from robots_core.files.user_file import when_written
from robots_core.orientation import angles_from_orientation
from robots_core.pose import Pose
from robots_core.validation import Array
from robots_planning.guidance.jogging import NOT_FOLLOWING
from robots_planning.guidance.teach_box import OUT_OF_REACH
from robots_planning.motion_settings import frame

SPEEDS: Final = (1, 3, 10, 30, 100)  # %
FIRST_SPEED: Final = 10  # %
DIRECTIONS: Final = ('X', 'Y', 'Z', 'RX', 'RY', 'RZ')
STEPS: Final = (0.0, 0.1, 1.0, 10.0)
"""mm or deg; 0 jogs while a button is held."""
TARGET: Final = 'target'
WHOLE: Final = {OUT_OF_REACH: 'jog.out_of_reach', NOT_FOLLOWING: 'jog.not_following'}
"""Limits that are none of an axis, with their texts."""
NEAR_LIMIT: Final = 0.03  # part of an axis' range


class _Row:
    """A name, two buttons and what is between them."""

    def __init__(self, viewer: Viewer, frame: str, index: int, name: str) -> None:
        text = viewer.texts
        with ui.element('div').classes('jog-row'):
            ui.label(name).classes('name')
            self._button(f'{frame} {index} -', '−', text('jog.minus', name=name))  # noqa: RUF001
            with ui.element('div').classes('gauge'):
                self._value = ui.label().classes('number')
                self._bar = ui.element('div').classes('mark')
                self._bar.set_visibility(False)
            self._button(f'{frame} {index} +', '+', text('jog.plus', name=name))

    @staticmethod
    def _button(key: str, sign: str, label: str) -> None:
        button = ui.element('button').classes('jog')
        with button.props(f'type=button data-press="{key}" aria-label="{label}"'):
            ui.label(sign)

    def show(self, value: str, part: float | None = None, *, near: bool = False) -> None:
        """Show a value, and where it is between its limits, 0..1."""
        self._value.set_text(value)
        self._bar.set_visibility(part is not None)
        if part is not None:
            self._bar.style(f'left: {100.0 * part:.1f}%')
        mark(self._bar, 'near', on=near)


class FrameChoice(Part):
    """The base of the program, or one of its taught points, as its points file has them now."""

    def __init__(self, viewer: Viewer) -> None:
        super().__init__(viewer)
        self._poses: dict[str, Pose] = {}
        self._changed = Changes()
        self._base = viewer.texts('jog.program_base')
        self.element = Choice({'': self._base}, value='', label=viewer.texts('jog.frame'))
        self.element.when_opened(self._read).classes('frame')

    @property
    def pose(self) -> Pose:
        """The frame that is chosen, in the robot's base."""
        if self.element.value and self._changed(*self._state()):
            self.element.show(self._read())
        base = frame(self.operator.state.settings.base, 'base')
        return self._poses.get(str(self.element.value), base) if self.element.value else base

    def _state(self) -> tuple[object, ...]:
        """Another one after each change of the points."""
        file = self.operator.state.program.points_file
        return file, when_written(file)

    def _read(self) -> dict[str, str]:
        self.line.show('')
        self._changed(*self._state())
        points = self.read(self.operator.points) or {}
        self._poses = {name: points[name].pose for name in sorted(points)}
        return {'': self._base, **{name: name for name in self._poses}}


class JogPanel(Part):
    """Axes, or the tool along and about the axes of tool or base."""

    def __init__(self, viewer: Viewer) -> None:
        super().__init__(viewer)
        text = viewer.texts
        with ui.element('div').classes('panel jog-panel'):
            with ui.element('div').classes('choices'):
                frames = {frame: text(f'jog.{frame}') for frame in (*JOG_FRAMES, TARGET)}
                self._chosen = choices(frames, 'axes', self._choose)
                self._taught = FrameChoice(viewer)
                with ui.element('div').classes('choice') as self._steps:
                    steps = {step: f'{step:g}' if step else '∞' for step in STEPS}
                    self._step = _small_choices(text('jog.step'), steps, STEPS[0])
                with ui.element('div').classes('choice'):
                    speeds = {speed: f'{speed} %' for speed in SPEEDS}
                    self._speed = _small_choices(text('jog.speed'), speeds, FIRST_SPEED)
            self.line = self._taught.line = RefusalLine()
            self._hint = ui.label(text('jog.hint')).classes('hint')
            self._rows_place = ui.element('div').classes('rows')
            self._target = TargetPanel(viewer, lambda: self.speed, self.line)
            self._pose = ui.label().classes('pose number')
        self._rows: list[_Row] = []
        self._choose()

    def _choose(self) -> None:
        typed = self._frame == TARGET
        self._target.set_shown(shown=typed)
        self._rows_place.set_visibility(not typed)
        self._steps.set_visibility(not typed)
        self._taught.element.set_visibility(self._frame == 'taught')
        if not typed:
            self._build_rows()
        self.refresh(self.operator.state)

    @property
    def _frame(self) -> str:
        return str(self._chosen.value)

    @property
    def speed(self) -> float:
        """Part of the highest jog speed."""
        return float(self._speed.value) / 100.0

    def step(self, key: str) -> float:
        """Size of the steps that a button makes, rad or m; 0 for a jog."""
        frame, _, rest = key.partition(' ')
        index = rest.partition(' ')[0]
        if frame not in JOG_FRAMES or not index.isdecimal():
            return 0.0
        slides = self.operator.robot.axes_data.prismatic
        straight = any(slides[int(index) : int(index) + 1]) if frame == 'axes' else int(index) < 3
        step = float(self._step.value)
        return step / 1e3 if straight else math.radians(step)

    @property
    def taught(self) -> Array:
        """Orientation of the taught frame that is chosen, in the robot's base, (3, 3)."""
        return self._taught.pose.T

    def _build_rows(self) -> None:
        self._rows_place.clear()
        names = self.operator.robot.axes_data.names if self._frame == 'axes' else DIRECTIONS
        with self._rows_place:
            self._rows = [_Row(self.viewer, self._frame, i, name) for i, name in enumerate(names)]

    def refresh(self, state: PendantState) -> None:
        """Show a state."""
        reason = self.viewer.reason(Action.JOG)
        warning = reason or self._ahead() or self._limited(state) or state.hindrance
        self._hint.set_text(warning or self.text('jog.step_hint' if self._step.value else 'jog.hint'))
        warned = bool(warning)
        self._hint.set_visibility(warned or not self._target.element.visible)
        mark(self._hint, 'warned', on=warned)
        mark(self._rows_place, 'blocked', on=bool(reason))
        self._pose.set_text(self._pose_text(state))
        self._show_failure()
        self._target.refresh(state)
        if state.q is not None and self._frame == 'axes':
            self._show_axes(state.q)
        elif state.tool is not None and self._frame in ('base', 'taught'):
            tool = self._taught.pose.inverse() @ state.tool if self._frame == 'taught' else state.tool
            for row, value in zip(self._rows, tool.r, strict=False):
                row.show(f'{round(1e3 * value, 1) + 0.0:.1f} mm')

    def _ahead(self) -> str:
        """What will stop the jog of this page, for a person; '' for nothing."""
        operator = self.operator
        ahead = operator.ahead() if operator.held.viewer == self.viewer.id else None
        if ahead is None:
            return ''
        what = ', '.join(_limit_text(self.text, limit) for limit in ahead.limits)
        return self.text('jog.ahead', time=f'{ahead.time:.1f}', what=what) if ahead.time else what

    def _limited(self, state: PendantState) -> str:
        """What stops the jog now, whoever's it is, for a person; '' for nothing."""
        what = ', '.join(_limit_text(self.text, limit) for limit in state.limits)
        return self.text('jog.limited', what=what) if what else ''

    def _show_failure(self) -> None:
        held = self.operator.held
        if held.failure is not None and held.failure[0] == self.viewer.id:
            self.line.show(self.text.error(held.failure[1]))
            held.failure = None

    def _show_axes(self, positions: Array) -> None:
        axes = self.operator.robot.axes_data
        for i, row in enumerate(self._rows):
            q, lower, upper = float(positions[i]), float(axes.lower[i]), float(axes.upper[i])
            value = f'{1e3 * q:.1f} mm' if axes.prismatic[i] else f'{math.degrees(q):.2f}°'
            if math.isinf(lower):
                row.show(value)
                continue
            part = min(1.0, max(0.0, (q - lower) / (upper - lower)))
            near = min(part, 1.0 - part) < NEAR_LIMIT
            row.show(f'{value} !' if near else value, part, near=near)

    def _pose_text(self, state: PendantState) -> str:
        if state.tool is None:
            return self.text('jog.waiting')
        convention = self.operator.robot.orientation_convention
        angles = np.degrees(angles_from_orientation(state.tool.T, convention))
        x, y, z = np.round(1e3 * state.tool.r, 1) + 0.0
        turned = '  '.join(f'{angle:.2f}°' for angle in np.round(angles, 2) + 0.0)
        return f'X {x:.1f}  Y {y:.1f}  Z {z:.1f} mm   {convention}: {turned}'


def _small_choices(caption: str, options: dict[Any, str], first: float) -> ui.toggle:
    ui.label(caption).classes('caption')
    return choices(options, first).props(f'padding="4px 9px" aria-label="{caption}"')


def _limit_text(text: Texts, limit: str) -> str:
    """What a teach box says of a limit, in the language of the page."""
    if limit in WHOLE:
        return text(WHOLE[limit])
    name, quantity, side = limit.rsplit(' ', 2)
    return text(f'jog.{side}_limit' if quantity == 'position' else 'jog.singular', name=name)
