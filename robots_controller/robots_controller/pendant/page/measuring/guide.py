"""What the guides that measure tools, bases and payloads have in common: Guide, and the points to touch."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import ClassVar, Final

from nicegui import ui

from robots_controller.measuring.frame_measuring import NEEDED
from robots_controller.measuring.frame_measuring import Sequence as Kind
from robots_controller.pendant.page.elements import Changes, icon_button, mark, show_text
from robots_controller.pendant.page.viewer import ActionButton, Part, RefusalLine, Viewer
from robots_controller.pendant.permissions import Action
from robots_controller.program.files.cell_frames import CellFrames, FrameKind, read_frames
from robots_core.errors import RobotsError
from robots_core.files.user_file import when_written

ICONS: Final = {'touched': 'check_circle', 'next': 'arrow_forward', 'later': 'radio_button_unchecked'}


class Guide(Part, ABC):
    """A guide through one sequence, and the name under which the frames file gets its result."""

    name: ClassVar[str]
    """Of its texts."""
    kind: ClassVar[FrameKind]
    """What is saved."""

    def __init__(self, viewer: Viewer, line: RefusalLine, file: Callable[[], Path]) -> None:
        super().__init__(viewer, line)
        self.file = file
        self.frames = CellFrames()
        """Of the file."""
        self.changed = Changes()
        """Of what its results depend on."""
        self._file_changed = Changes()
        text = viewer.texts
        with ui.element('div').classes(f'guide {self.name}-guide') as self.element:
            ui.label(text(f'frames.{self.name}_hint')).classes('hint')
            self.build()
            with ui.element('div').classes('row-of-buttons saved-frame'):
                self._name = ui.input(text('frames.name')).props('dense outlined').classes('point')
                ActionButton(viewer, Action.TEACH, text('frames.save'), 'save', self._save)
                ActionButton(viewer, Action.TEACH, text('frames.undo'), 'undo', self._undo)
            self._said = ui.label().classes('hint')
            show_text(self._said, '')

    @abstractmethod
    def build(self) -> None:
        """Make the elements above the name."""

    @abstractmethod
    def save(self, name: str) -> None:
        """Save the result under a name."""

    async def _save(self) -> None:
        name = str(self._name.value or '')
        if await self.do(self.operator.measure, lambda: self.save(name)):
            show_text(self._said, self.text('frames.saved', name=name, file=self.file().name))

    async def _undo(self) -> None:
        operator = self.operator
        if await self.do(operator.measure, operator.measuring.history.undo):
            show_text(self._said, self.text('frames.undone'))

    def refresh(self) -> None:
        """Show what was measured, and the names that the file has."""
        file = self.file()
        if self._file_changed(file, when_written(file)):
            self.frames = self.read(partial(read_frames, file)) or CellFrames()
            self._name.set_autocomplete([*self.frames.names(self.kind)])

    def show_result(self, label: ui.label, find: Callable[[], str]) -> bool:
        """Show what follows from the points, or what is wrong with them; False if something is."""
        try:
            text, wrong = find(), False
        except RobotsError as error:
            text, wrong = self.text.error(error), True
        show_text(label, text)
        mark(label, 'wrong', on=wrong)
        return not wrong


class TouchedPoints(Part):
    """A row for each point, and buttons that touch the next one and start again."""

    def __init__(self, viewer: Viewer, kind: Kind, line: RefusalLine) -> None:
        super().__init__(viewer, line)
        self._kind, self._changed = kind, Changes()
        text, operator, measuring = viewer.texts, viewer.operator, viewer.operator.measuring
        with ui.element('div').classes('sequence'):
            self._rows = ui.element('div').classes('touched-points')
            with ui.element('div').classes('row-of-buttons'):
                touch = partial(self.do, operator.touch, kind)
                clear = partial(self.do, operator.measure, partial(measuring.clear, kind))
                ActionButton(viewer, Action.TEACH, text('frames.touch'), 'ads_click', touch)
                ActionButton(viewer, Action.TEACH, text('frames.again'), 'restart_alt', clear)

    def refresh(self, names: Sequence[str], details: Sequence[str] = ()) -> None:
        """Show the points by their names, and the details of those that are touched; 'touched' by default."""
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
                icon_button('close', label, partial(self.do, self.operator.measure, remove))
