"""ProgramEditor: a robot program is edited in place, with completion, help and findings at their lines."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from functools import cache

from nicegui import ui

from robots_controller.interpreter.functions.lua_function import Argument, LuaFunction
from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS
from robots_controller.pendant.page.elements import text_button
from robots_controller.pendant.page.viewer import ActionButton, Part, RefusalLine, Viewer
from robots_controller.pendant.permissions import Action
from robots_controller.program_check.program_check import ProgramProblem


class ProgramEditor(Part):
    """An editor that opens with a text, and closes when it is saved or given up.

    `closed` gets what is wrong with the program that was saved; None if nothing was saved.
    """

    def __init__(
        self,
        viewer: Viewer,
        line: RefusalLine,
        closed: Callable[[Sequence[ProgramProblem] | None], None],
    ) -> None:
        super().__init__(viewer, line)
        self._closed, text = closed, viewer.texts
        self._file, self._before = '', ''
        with ui.element('div').classes('editor') as self.element:
            self._place = ui.element('div').classes('text')
            with ui.element('div').classes('row-of-buttons'):
                ActionButton(viewer, Action.EDIT, text('edit.save'), 'save', self._save)
                text_button(text('edit.discard'), 'close', self.close)
        self._code: ui.codemirror | None = None
        self.element.set_visibility(False)

    @property
    def open(self) -> bool:
        """A program is edited."""
        return self._code is not None

    def edit(self, file: str, text: str, line: int) -> None:
        """Open with the text of a file, at a line."""
        self._file, self._before = file, text
        self._place.clear()
        with self._place:
            self._code = ui.codemirror(text.replace('\r\n', '\n'), language='Lua', indent='  ').props(
                f'aria-label="{file}"'
            )
        functions = json.dumps(_completions(self.operator.robot.num_axes))
        ui.run_javascript(f'pendant.complete({self._code.id}, {functions})')
        if line:
            self._code.reveal_line(line)
        self.element.set_visibility(True)

    async def _save(self) -> None:
        if self._code is None:
            return
        text = str(self._code.value)
        after = text.replace('\n', '\r\n') if '\r\n' in self._before else text
        save = self.operator.save_program
        if saved := await self.do(save, self._file, self._before, after):
            self._leave()
            self._closed(saved[0])

    def close(self) -> None:
        """Give up what was not saved."""
        self._leave()
        self._closed(None)

    def _leave(self) -> None:
        self._code = None
        self._place.clear()
        self.element.set_visibility(False)


@cache
def _completions(num_axes: int) -> tuple[dict[str, str], ...]:
    """Names, arguments and meanings of all functions, from the table that `lua_meta` is made of."""
    return tuple(
        {'label': function.name, 'detail': _arguments(function, num_axes), 'info': _info(function)}
        for function in LUA_FUNCTIONS.values()
    )


def _arguments(function: LuaFunction, num_axes: int) -> str:
    names = [name for argument in function.arguments for name in _names(argument, num_axes)]
    return f'({", ".join([*names, *(["options"] if function.options else [])])})'


def _names(argument: Argument, num_axes: int) -> list[str]:
    if argument.per_axis:
        return [f'{argument.name}{index}' for index in range(1, num_axes + 1)]
    name = f'{argument.name}...' if argument.repeated else argument.name
    return [f'[{name}]' if argument.optional else name]


def _info(function: LuaFunction) -> str:
    rows = [
        f'{argument.name}: {argument.meaning}' + (f' ({argument.unit})' if argument.unit else '')
        for argument in function.arguments
    ]
    return '\n'.join([function.doc, *rows, *([f'→ {function.result}'] if function.result else [])])
