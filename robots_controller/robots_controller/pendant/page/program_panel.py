"""ProgramPanel: choose a robot program, run it, and see where it is."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from html import escape
from pathlib import Path
from typing import Any, Final

from nicegui import background_tasks, run, ui
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import LuaLexer

from robots_controller.interpreter.debugger import CallStack, Variable
from robots_controller.pendant.jog.held_button import RUN_KEY, STEP_KEY
from robots_controller.pendant.page.elements import Changes, Choice, held_button, mark, show_hint, show_text
from robots_controller.pendant.page.program_editor import ProgramEditor
from robots_controller.pendant.page.teach_row import TeachRow
from robots_controller.pendant.page.viewer import ActionButton, Part, RefusalLine, Viewer
from robots_controller.pendant.pendant_state import PendantState
from robots_controller.pendant.permissions import Action
from robots_controller.pendant.programs import program_file, program_files, read_program
from robots_controller.program.run_state import RunState
from robots_controller.program_check.program_check import ProgramProblem
from robots_core.errors import RobotsError
from robots_core.files.user_file import when_written

SHOWN_PRINTS: Final = 100
BUTTONS: Final = (
    (Action.RUN, 'play_arrow'),
    (Action.PAUSE, 'pause'),
    (Action.RESUME, 'skip_next'),
    (Action.END, 'stop'),
    (Action.REWIND, 'replay'),
)
VIEWS: Final = ('printed', 'teach', 'variables')
STEPS: Final = {'over': 'redo', 'in': 'south_east', 'out': 'north_east', 'motion': 'route'}
HELD: Final = (Action.RUN, Action.RESUME)
"""What the button that is held does, in modes in which run is held."""


class HeldProgramView(Part):
    """Levels of the program, innermost first, each with its variables; tables can be opened."""

    def __init__(self, viewer: Viewer) -> None:
        super().__init__(viewer)
        self._changed = Changes()
        self._asking = False
        with ui.element('div').classes('variables') as self.element:
            self._hint = ui.label(viewer.texts('held.none')).classes('hint')
            self._tree = ui.tree([], label_key='label').props('dense no-connectors')

    async def refresh(self, state: PendantState) -> None:
        """Ask for the variables, if the program is held elsewhere than before."""
        program = state.program
        held = program.state is RunState.PAUSED
        shown = (program.path, program.file, program.line, program.hold) if held else ()
        if self._asking or not self._changed(*shown):
            return
        stack = None
        if held:
            self._asking = True
            try:
                stack = await run.io_bound(self.operator.call_stack)
            except RobotsError as error:  # the state of the program is shown elsewhere
                self._hint.set_text(self.text.error(error))
            finally:
                self._asking = False
        self._show(stack)

    def _show(self, stack: CallStack | None) -> None:
        self._hint.set_visibility(stack is None)
        nodes = [] if stack is None else list(_levels(stack, self.text('held.globals')))
        self._tree.props['nodes'] = nodes
        self._tree.update()
        if nodes:
            self._tree.expand([nodes[0]['id']])


class ProgramPanel(Part):
    """The programs of a folder, buttons, the text with its running line, and what was printed."""

    def __init__(self, viewer: Viewer) -> None:
        super().__init__(viewer)
        self._folder, text = viewer.folder, viewer.texts
        self._shown: tuple[str, str, int, bool] | None = None  # path, file, when it was written, open
        self._cursor = 0  # the line after which motions are inserted
        self._marked = Changes()
        self._printed = Changes()
        self._problems: Sequence[ProgramProblem] = ()
        with ui.element('div').classes('panel program-panel'):
            with ui.element('div').classes('row-of-buttons'):
                self._choice = (
                    Choice(program_files(self._folder), label=text('program.choose'), with_input=True)
                    .when_chosen(self._open)
                    .when_opened(lambda: program_files(self._folder))
                    .classes('wide')
                )
                ActionButton(viewer, Action.EDIT, text('edit.edit'), 'edit', self._begin_edit)
            with ui.element('div').classes('row-of-buttons'):
                self._hold = held_button(RUN_KEY, 'play_arrow', text('program.hold'))
                show_hint(self._hold, text('program.hold_hint'))
                self._buttons = {
                    action: ActionButton(
                        viewer,
                        action,
                        text(f'program.{action}'),
                        icon,
                        partial(self.do, viewer.operator.act, action),
                    )
                    for action, icon in BUTTONS
                }
            with ui.element('div').classes('row-of-buttons steps') as self._steps:
                for step, icon in STEPS.items():
                    held_button(f'{STEP_KEY}{step}', icon, text(f'step.{step}')).classes('step')
            self.line = RefusalLine()
            self._error = ui.label().classes('refusal')
            with ui.element('div').classes('row-of-buttons changed') as self._changed:
                self._change = ui.label().classes('hint warned')
                ActionButton(viewer, Action.OPEN, text('program.open_again'), 'refresh', self._open_again)
            self._source = ui.html('', sanitize=False).classes('source').props('id=source')
            self._editor = ProgramEditor(viewer, self.line, self._end_edit)
            ui.on('pendant_cursor', lambda event: self._put_cursor(int(event.args)))
            toggle = viewer.operator.toggle_breakpoint
            ui.on('pendant_breakpoint', lambda event: self.do(toggle, self._file, int(event.args)))
            self._found = ui.element('div').classes('findings')
            self._found.set_visibility(False)
            with ui.tabs().props('dense no-caps inline-label align=left').classes('subtabs') as tabs:
                for name in VIEWS:
                    ui.tab(name, text(f'program.{name}'))
            with ui.tab_panels(tabs, value=VIEWS[0], animated=False).classes('subpanels').props('keep-alive'):
                with ui.tab_panel(VIEWS[0]):
                    self._prints = ui.html('', sanitize=False).classes('prints')
                with ui.tab_panel(VIEWS[1]):
                    self._teach = TeachRow(
                        viewer, self.line, lambda: (self._file, self._cursor), self._put_cursor
                    )
                with ui.tab_panel(VIEWS[2]):
                    self._held = HeldProgramView(viewer)

    async def _open(self, name: str | None) -> None:
        path = str(self._folder / name) if name else ''
        program = self.operator.state.program
        if not path or (path == program.path and program.state is not RunState.IDLE):
            return
        if not await self.do(self.operator.open_program, path):
            self._show_choice(program.path)  # so that the same one can be chosen again

    async def _open_again(self) -> None:
        await self.do(self.operator.open_program, self.operator.state.program.path)

    # -- what is shown ------------------------------------------------------------------------------------

    def refresh(self, state: PendantState) -> None:
        """Show a state."""
        held = state.run_is_held
        self._hold.set_visibility(held)
        mark(self._hold, 'blocked', on=bool(self.viewer.reason(Action.HOLD_RUN)))
        for action in HELD:
            self._buttons[action].element.set_visibility(not held)
        program = state.program
        show_text(self._error, program.error)
        self._show_source(state)
        self._show_change(state)
        self._teach.refresh(state)
        background_tasks.create(self._held.refresh(state))
        mark(self._steps, 'blocked', on=bool(self.viewer.reason(Action.STEP)))
        marks = {
            'line': program.line if program.file == self._file else 0,
            'motion': program.motion_line if program.motion_file == self._file else 0,
            'failed': bool(program.error),
            'cursor': self._cursor,
            'breakpoints': sorted(state.breakpoints.get(self._file, ())),
            'findings': {one.line: one.reason for one in self._problems if one.file == self._file},
        }
        if self._marked(text := json.dumps(marks)):
            ui.run_javascript(f'pendant.mark({text})')
        self._show_prints()

    @property
    def _file(self) -> str:
        return self._shown[1] if self._shown else ''

    def _show_source(self, state: PendantState) -> None:
        program = state.program
        file = program.file or Path(program.path).name
        open_ = program.state is not RunState.IDLE
        shown = program.path, file, when_written(program_file(Path(program.path), file)), open_
        if shown == self._shown:
            return
        if self._shown is None or shown[:2] != self._shown[:2]:
            self._cursor, self._problems = 0, ()
            self._found.set_visibility(False)
        self._shown = shown
        self._marked.forget()
        if self._editor.open and not program.path:
            self._editor.close()
        if not program.path:
            self._source.set_content(_note(self.text('program.none', folder=self._folder)))
            return
        self._show_choice(program.path if open_ else '')  # so that the same one can be chosen again
        try:
            self._source.set_content(_lines(read_program(program.path, file)))
            self._cursor = self._cursor or self._source.content.count('data-line=')
        except RobotsError:
            self._source.set_content(_note(self.text('program.unreadable', file=file)))

    def _show_change(self, state: PendantState) -> None:
        """Say that what runs is not what is shown."""
        program = state.program
        file = Path(program.path).name
        self._changed.set_visibility(program.written not in (0, when_written(program.path)))
        self._change.set_text(self.text('program.changed', file=file))

    def _show_choice(self, path: str) -> None:
        listed = Path(path).is_relative_to(self._folder)
        name = str(Path(path).relative_to(self._folder)) if listed else ''
        self._choice.set_value(name if name in self._choice.options else None)

    def _put_cursor(self, line: int) -> None:
        self._cursor = line

    def _begin_edit(self) -> None:
        reason = self.viewer.reason(Action.EDIT)
        path = self.operator.state.program.path
        self.line.show(reason)
        if reason or self._editor.open:
            return
        file = self._file or Path(path).name
        if (text := self.read(partial(read_program, path, file))) is not None:
            self._editor.edit(file, text, self._cursor)
            self._source.set_visibility(False)

    def _end_edit(self, problems: Sequence[ProgramProblem] | None) -> None:
        self._source.set_visibility(True)
        self._marked.forget()
        if problems is None:
            return
        self._problems = problems
        self._found.clear()
        self._found.set_visibility(True)
        with self._found:
            if not problems:
                ui.label(self.text('edit.good')).classes('good')
            for one in problems:
                ui.label(str(one)).classes('finding').on('click', partial(self._put_cursor, one.line))

    def _show_prints(self) -> None:
        prints = list(self.operator.prints)[-SHOWN_PRINTS:]
        if self._printed(prints):
            lines = [f'<div>{escape(one)}</div>' for one in prints]
            # Turned around by the style, so that the newest stays in view.
            nothing = f'<div class="hint">{escape(self.text("program.nothing_printed"))}</div>'
            self._prints.set_content(''.join(reversed(lines)) or nothing)


def _note(text: str) -> str:
    """Wrapped, unlike lines of a program."""
    return f'<p class="note">{escape(text)}</p>'


def _lines(text: str) -> str:
    """A Lua program as HTML, a div for each line."""
    html = highlight(text, LuaLexer(stripnl=False), HtmlFormatter(nowrap=True)).removesuffix('\n')
    return ''.join(f'<div data-line="{i}">{line}</div>' for i, line in enumerate(html.split('\n'), 1))


def _levels(stack: CallStack, title: str) -> Iterator[dict[str, Any]]:
    for number, frame in enumerate(stack.frames):
        variables = [variable for scope in frame.scopes.values() for variable in scope]
        label = f'{frame.chunk}:{frame.line}  {frame.name}'
        yield {'id': f'{number}', 'label': label, 'children': list(_rows(variables, f'{number}'))}
    if stack.globals:
        yield {'id': 'globals', 'label': title, 'children': list(_rows(stack.globals, 'globals'))}


def _rows(variables: Iterable[Variable], above: str) -> Iterator[dict[str, Any]]:
    for number, one in enumerate(variables):
        id_ = f'{above}.{number}'
        label = f'{one.name} = {one.value}'
        yield {'id': id_, 'label': label, 'children': list(_rows(one.entries, id_))}
