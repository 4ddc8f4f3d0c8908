"""ProgramPanel: choose a robot program, run it, and see where it is."""

from __future__ import annotations

from functools import partial
from html import escape
from pathlib import Path
from typing import Final

from nicegui import ui
from pygments import lex
from pygments.formatters import HtmlFormatter
from pygments.lexers import LuaLexer
from pygments.token import Token

from robots_controller.pendant.held_button import RUN_KEY
from robots_controller.pendant.page.teach_row import TeachRow
from robots_controller.pendant.page.viewer import ActionButton, RefusalLine, Viewer
from robots_controller.pendant.pendant_state import PendantState
from robots_controller.pendant.permissions import Action
from robots_controller.pendant.programs import program_file, program_files, read_program
from robots_core.errors import RobotsError
from robots_core.operating_modes import MODES

SHOWN_PRINTS: Final = 100
BUTTONS: Final = (
    (Action.RUN, 'run', 'play_arrow'),
    (Action.PAUSE, 'pause', 'pause'),
    (Action.RESUME, 'resume', 'skip_next'),
    (Action.END, 'end', 'stop'),
    (Action.REWIND, 'rewind', 'replay'),
)
HELD: Final = (Action.RUN, Action.RESUME)
"""What the button that is held does, in modes in which run is held."""


class ProgramPanel:
    """The programs of a folder, buttons, the text with its running line, and what was printed.

    Args:
        viewer: Its page.
        folder: Of the programs.
    """

    def __init__(self, viewer: Viewer, folder: Path) -> None:
        self._viewer, self._folder, text = viewer, folder, viewer.texts
        self._shown: tuple[str, str, float] | None = None  # path, file and when that was written
        self._cursor = 0  # the line after which motions are inserted
        self._marks: tuple[int, int, bool] = (0, 0, False)
        self._printed = -1
        with ui.element('div').classes('panel program-panel'):
            with ui.element('div').classes('row-of-buttons'):
                self._choice = (
                    ui.select(program_files(folder), with_input=True, on_change=self._open)
                    .props(f'dense outlined options-dense label="{text("program.choose")}"')
                    .classes('wide')
                )
                self._choice.on('focus', lambda: self._choice.set_options(program_files(folder)))
            with ui.element('div').classes('row-of-buttons'):
                with (
                    ui.element('button')
                    .classes('hold')
                    .props(f'type=button data-press="{RUN_KEY}"') as self._hold
                ):
                    ui.icon('play_arrow')
                    ui.label(text('program.hold'))
                    ui.tooltip(text('program.hold_hint'))
                self._buttons = {
                    action: ActionButton(
                        viewer, action, text(f'program.{key}'), icon, partial(self._act, action)
                    )
                    for action, key, icon in BUTTONS
                }
            self.line = RefusalLine()
            self._error = ui.label().classes('refusal')
            self._source = ui.html('', sanitize=False).classes('source').props('id=source')
            ui.on('pendant_cursor', lambda event: self._put_cursor(int(event.args)))
            self._teach = TeachRow(viewer, self.line, lambda: (self._file, self._cursor), self._put_cursor)
            ui.label(text('program.printed')).classes('caption')
            self._prints = ui.html('', sanitize=False).classes('prints')

    async def _open(self) -> None:
        viewer, name = self._viewer, self._choice.value
        path = str(self._folder / name) if name else ''
        if path and path != viewer.operator.state.program.path:
            await viewer.do(self.line, lambda: viewer.operator.open_program(viewer.id, path))

    async def _act(self, action: Action) -> None:
        viewer = self._viewer
        await viewer.do(self.line, lambda: viewer.operator.act(viewer.id, action))

    # -- what is shown ------------------------------------------------------------------------------------

    def refresh(self, state: PendantState) -> None:
        """Show a state."""
        held = state.mode is not None and MODES[state.mode].held
        self._hold.set_visibility(held)
        blocked = bool(self._viewer.reason(Action.HOLD_RUN))
        self._hold.classes(add='blocked' if blocked else '', remove='' if blocked else 'blocked')
        for action, button in self._buttons.items():
            button.refresh()
            if action in HELD:
                button.element.set_visibility(not held)
        program = state.program
        self._error.set_text(program.error)
        self._error.set_visibility(bool(program.error))
        self._show_source(state)
        self._teach.refresh(state)
        line = program.line if program.file == self._file else 0
        motion = program.motion_line if program.motion_file == self._file else 0
        marks = line, motion, bool(program.error)
        if marks != self._marks:
            self._marks = marks
            ui.run_javascript(f'pendant.mark({line}, {motion}, {str(marks[2]).lower()})')
        self._show_prints()

    @property
    def _file(self) -> str:
        return self._shown[1] if self._shown else ''

    def _show_source(self, state: PendantState) -> None:
        program = state.program
        file = program.file or Path(program.path).name
        shown = program.path, file, _written(Path(program.path), file)
        if shown == self._shown:
            return
        if self._shown is None or shown[:2] != self._shown[:2]:
            self._cursor = 0
        self._shown, self._marks = shown, (0, 0, False)
        text = self._viewer.texts
        if not program.path:
            self._source.set_content(escape(text('program.none', folder=self._folder)))
            return
        names = self._choice.options
        name = str(Path(program.path).relative_to(self._folder)) if self._is_listed(program.path) else ''
        self._choice.set_value(name if name in names else None)
        try:
            self._source.set_content(_lines(read_program(program.path, file)))
            self._cursor = self._cursor or self._source.content.count('data-line=')
            ui.run_javascript(f'pendant.cursor({self._cursor})')
        except RobotsError:
            self._source.set_content(escape(text('program.unreadable', file=file)))

    def _put_cursor(self, line: int) -> None:
        self._cursor = line
        ui.run_javascript(f'pendant.cursor({line})')

    def _is_listed(self, path: str) -> bool:
        return Path(path).is_relative_to(self._folder)

    def _show_prints(self) -> None:
        prints = list(self._viewer.operator.prints)[-SHOWN_PRINTS:]
        newest = prints[-1][0] if prints else 0
        if newest != self._printed:
            self._printed = newest
            lines = [f'<div>{escape(one)}</div>' for _, one in prints]
            # Turned around by the style, so that the newest stays in view.
            nothing = f'<div class="hint">{escape(self._viewer.texts("program.nothing_printed"))}</div>'
            self._prints.set_content(''.join(reversed(lines)) or nothing)


def _written(program: Path, file: str) -> float:
    """When a file was written; 0 for none."""
    path = program_file(program, file)
    return path.stat().st_mtime if path.is_file() else 0.0


def _lines(text: str) -> str:
    """A Lua program as HTML, a div for each line."""
    formatter = HtmlFormatter(nowrap=True)
    lines: list[list[str]] = [[]]
    for kind, value in lex(text, LuaLexer(stripnl=False)):
        for number, part in enumerate(value.split('\n')):
            if number:
                lines.append([])
            if part:
                style = formatter._get_css_class(kind) if kind is not Token.Text else ''  # noqa: SLF001
                lines[-1].append(f'<span class="{style}">{escape(part)}</span>')
    if not lines[-1]:
        lines.pop()
    return ''.join(f'<div data-line="{i}">{"".join(parts)}</div>' for i, parts in enumerate(lines, 1))
