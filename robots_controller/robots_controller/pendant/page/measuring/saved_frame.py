"""SavedFrame: the name that a measured tool or base gets, and the buttons that save it and take that back."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from nicegui import ui

from robots_controller.pendant.page.viewer import ActionButton, RefusalLine, Viewer
from robots_controller.pendant.permissions import Action
from robots_controller.program.files.cell_frames import FrameKind
from robots_core.errors import RobotsError
from robots_core.files.user_file import when_written


class SavedFrame:
    """A field for the name, with those that the file has, and buttons to save and to undo.

    Args:
        viewer: Its page.
        kind: What is saved.
        line: Says why something is refused.
        file: Gives the frames file.
        save: Saves under a name.
    """

    def __init__(
        self,
        viewer: Viewer,
        kind: FrameKind,
        line: RefusalLine,
        file: Callable[[], Path],
        save: Callable[[str], None],
    ) -> None:
        self._viewer, self._kind, self._line, self._file, self._save = viewer, kind, line, file, save
        self._read: object = None
        text = viewer.texts
        with ui.element('div').classes('row-of-buttons saved-frame'):
            self._name = ui.input(text('frames.name')).props('dense outlined').classes('point')
            self._buttons = [
                ActionButton(viewer, Action.TEACH, text('frames.save'), 'save', self._press_save),
                ActionButton(viewer, Action.TEACH, text('frames.undo'), 'undo', self._press_undo),
            ]
        self._hint = ui.label().classes('hint')
        self._hint.set_visibility(False)

    async def _press_save(self) -> None:
        viewer, name = self._viewer, str(self._name.value or '')

        def work() -> None:
            viewer.operator.check_measuring(viewer.id)
            self._save(name)

        if await viewer.do(self._line, work):
            self._say('saved', name=name, file=self._file().name)

    async def _press_undo(self) -> None:
        viewer = self._viewer

        def work() -> None:
            viewer.operator.check_measuring(viewer.id)
            viewer.operator.measuring.history.undo()

        if await viewer.do(self._line, work):
            self._say('undone')

    def _say(self, key: str, **values: object) -> None:
        self._hint.set_text(self._viewer.texts(f'frames.{key}', **values))
        self._hint.set_visibility(True)

    def refresh(self) -> None:
        """Show the names that the file has."""
        for button in self._buttons:
            button.refresh()
        names = file_names(self._viewer, self._line, self._file(), self._kind, self._read)
        if names is not None:
            self._read, known = names
            self._name.set_autocomplete(list(known))


def file_names(
    viewer: Viewer, line: RefusalLine, file: Path, kind: FrameKind, read: object
) -> tuple[object, tuple[str, ...]] | None:
    """The state of a frames file and its names; None where it is in the state that was read before.

    What is wrong with the file is shown.
    """
    state = str(file), when_written(file)
    if state == read:
        return None
    try:
        return state, viewer.operator.measuring.frames(file).names(kind)
    except RobotsError as error:
        line.show(viewer.texts.error(error))
        return state, ()
