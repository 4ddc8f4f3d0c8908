"""Guide: what the sequences that measure tools, bases and payloads have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from pathlib import Path
from typing import ClassVar

from nicegui import ui

from robots_controller.pendant.page.elements import Changes, mark, show_text
from robots_controller.pendant.page.viewer import ActionButton, Part, RefusalLine, Viewer
from robots_controller.pendant.permissions import Action
from robots_controller.program.files.cell_frames import CellFrames, FrameKind, read_frames
from robots_core.errors import RobotsError
from robots_core.files.user_file import when_written


class Guide(Part, ABC):
    """A guide through one sequence, and the name under which the frames file gets its result.

    Args:
        line: Says why something is refused.
        file: Gives the frames file.
    """

    name: ClassVar[str]
    """Of its texts."""
    kind: ClassVar[FrameKind]
    """What is saved."""

    def __init__(self, viewer: Viewer, line: RefusalLine, file: Callable[[], Path]) -> None:
        super().__init__(viewer)
        self.line, self.file = line, file
        self.frames = CellFrames()
        """Of the file."""
        self.changed = Changes()
        """Of what `show_result` depends on."""
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
        if await self.viewer.do(self.line, self.operator.measure, lambda: self.save(name)):
            show_text(self._said, self.text('frames.saved', name=name, file=self.file().name))

    async def _undo(self) -> None:
        operator = self.operator
        if await self.viewer.do(self.line, operator.measure, operator.measuring.history.undo):
            show_text(self._said, self.text('frames.undone'))

    def refresh(self) -> None:
        """Show what was measured, and the names that the file has."""
        file = self.file()
        if self._file_changed(file, when_written(file)):
            self.frames = self._read(file)
            self._name.set_autocomplete([*self.frames.names(self.kind)])

    def _read(self, file: Path) -> CellFrames:
        try:
            return read_frames(file)
        except RobotsError as error:
            self.line.show(self.text.error(error))
            return CellFrames()


def show_result(label: ui.label, text: str, *, wrong: bool) -> None:
    """Show what follows from the points, or what is wrong with them."""
    show_text(label, text)
    mark(label, 'wrong', on=wrong)
