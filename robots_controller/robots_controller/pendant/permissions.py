"""Permissions: what may be pressed on the operator's page, and why not.

The nodes decide; this is what they would answer, so that the page can say it before a button is pressed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import StrEnum
from typing import Final

from robots_controller.pendant.pendant_state import STARTABLE, PendantState
from robots_controller.program.run_state import RunState
from robots_core.cell_interface.operating_modes import GUIDING, MODES, Commander, OperatingMode
from robots_core.errors import CommandRefusedError


class Action(StrEnum):
    """What can be pressed; a stop needs no permission."""

    JOG = 'jog'
    MOVE = 'move'
    TEACH = 'teach'
    EDIT = 'edit'
    STEP = 'step'
    BREAK = 'break'
    OPEN = 'open'
    RUN = 'run'
    HOLD_RUN = 'hold_run'
    PAUSE = 'pause'
    RESUME = 'resume'
    END = 'end'
    REWIND = 'rewind'
    RESET = 'reset'
    MODE = 'mode'
    OVERRIDE = 'override'
    SWITCH = 'switch'


class NotPermittedError(CommandRefusedError):
    """The operator's page does not permit an action in the present state of the cell.

    Args:
        key: Of the text of the reason, below `reasons`.
        values: What that text names.
    """

    code = 'R406'
    remedy = 'Take control, or change the operating mode, as the reason at the button says.'

    def __init__(self, key: str, **values: object) -> None:
        super().__init__(key, **{name: str(value) for name, value in values.items()})


Rule = Callable[[PendantState], str]
"""The key of a reason, or '' for none."""


def _need(condition: Callable[[PendantState], bool], otherwise: str) -> Rule:
    return lambda state: '' if condition(state) else otherwise


def _commander(who: Commander) -> Rule:
    def rule(state: PendantState) -> str:
        guided = GUIDING.get(state.guide) is who
        if guided and state.commander in (Commander.PROGRAM, Commander.NOBODY):
            return ''
        if state.mode is not None and who not in MODES[state.mode].commanders:
            return f'mode_excludes_{who.lower()}'
        return '' if state.commander in (who, Commander.NOBODY) else 'commanded'

    return rule


def _program(*states: RunState, otherwise: str) -> Rule:
    return _need(lambda state: state.program.state in states, otherwise)


def _editable(state: PendantState) -> str:
    if state.program.state is RunState.IDLE:  # as one that could not be opened
        return '' if state.program.path else 'no_program'
    return '' if state.program.state in STARTABLE else 'not_ended'


_PRESENT: Final = _need(lambda state: not state.lost, 'lost')
_NO_FAULT: Final = _need(lambda state: not state.fault, 'fault')
_ENABLED: Final = _need(lambda state: state.run_enabled or not state.run_is_held, 'hold_needed')
_NO_PROGRAM_RUNS: Final = _need(lambda state: state.program.state is not RunState.RUNNING, 'running')
_JOGS: Final = (_PRESENT, _NO_FAULT, _commander(Commander.PENDANT))
_RUNNABLE: Final = (_PRESENT, _NO_FAULT, _commander(Commander.PROGRAM))

RULES: Final[Mapping[Action, tuple[Rule, ...]]] = {
    Action.JOG: _JOGS,
    Action.MOVE: (*_JOGS, _need(lambda state: state.run_is_held, 'no_steps')),
    Action.TEACH: (_PRESENT, _NO_PROGRAM_RUNS),
    Action.EDIT: (_PRESENT, _editable),
    Action.OPEN: (_PRESENT, _program(RunState.IDLE, *STARTABLE, otherwise='under_way')),
    Action.RUN: (*_RUNNABLE, _program(*STARTABLE, otherwise='not_startable'), _ENABLED),
    Action.HOLD_RUN: (
        *_RUNNABLE,
        _program(*STARTABLE, RunState.RUNNING, RunState.PAUSED, otherwise='not_startable'),
        _need(lambda state: state.run_is_held, 'no_hold_needed'),
    ),
    Action.STEP: (
        *_RUNNABLE,
        _program(RunState.OPENED, RunState.RUNNING, RunState.PAUSED, otherwise='not_paused'),
    ),
    Action.BREAK: (_PRESENT,),
    Action.PAUSE: (
        _PRESENT,
        _need(
            lambda state: state.program.state is RunState.RUNNING or state.program.waits_for_run,
            'not_running',
        ),
    ),
    Action.RESUME: (*_RUNNABLE, _program(RunState.PAUSED, otherwise='not_paused'), _ENABLED),
    Action.END: (_PRESENT, _program(RunState.RUNNING, RunState.PAUSED, otherwise='not_running')),
    Action.REWIND: (_PRESENT, _program(*STARTABLE, otherwise='not_ended')),
    Action.RESET: (_PRESENT, _need(lambda state: bool(state.fault), 'no_fault')),
    Action.MODE: (_PRESENT, _NO_PROGRAM_RUNS),
    Action.OVERRIDE: (),
    Action.SWITCH: (
        _PRESENT,
        _need(lambda state: state.mode in (OperatingMode.T1, OperatingMode.T2), 'not_manual'),
    ),
}
"""In their order: the first reason is shown."""


def refusal(action: Action, state: PendantState) -> NotPermittedError | None:
    """Why an action is not permitted now; None if it is."""
    for rule in RULES[action]:
        if key := rule(state):
            return NotPermittedError(key, **state.values)
    return None
