"""HeldProgramView: the call stack and the variables of a held program."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from nicegui import run, ui

from robots_controller.interpreter.debugger import CallStack, Variable
from robots_controller.pendant.page.elements import Changes
from robots_controller.pendant.page.viewer import Part, Viewer
from robots_controller.pendant.pendant_state import PendantState
from robots_controller.program.run_state import RunState
from robots_core.errors import RobotsError


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
