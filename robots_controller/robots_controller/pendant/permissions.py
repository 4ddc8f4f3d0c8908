"""Permissions: what may be pressed on the operator's page, and why not.

The nodes decide; this is what they would answer, so that the page can say it before a button is pressed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, Final

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


@dataclass(frozen=True)
class Reason:
    """Why something may not be pressed.

    Attributes:
        key: Of its text, below `reasons`.
        values: What the text names.
    """

    key: str
    values: Mapping[str, Any] = field(default_factory=dict)


class NotPermittedError(CommandRefusedError):
    """The operator's page does not permit an action in the present state of the cell.

    Args:
        reason: Why.
    """

    code = 'R406'
    remedy = 'Take control, or change the operating mode, as the reason at the button says.'

    def __init__(self, reason: Reason) -> None:
        super().__init__(reason.key, **{key: str(value) for key, value in reason.values.items()})
        self.reason = reason


Rule = Callable[[PendantState], str]
"""The key of a reason, or '' for none."""


def _missing(state: PendantState) -> str:
    return 'lost' if state.lost else ''


def _stopped(state: PendantState) -> str:
    return 'fault' if state.fault else ''


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
    return lambda state: '' if state.program.state in states else otherwise


def _held(state: PendantState) -> str:
    held = state.mode is not None and MODES[state.mode].held
    return 'hold_needed' if held and not state.run_enabled else ''


def _not_held(state: PendantState) -> str:
    return '' if state.mode is not None and MODES[state.mode].held else 'no_hold_needed'


def _manual(state: PendantState) -> str:
    return '' if state.mode in (OperatingMode.T1, OperatingMode.T2) else 'not_manual'


def _steps(state: PendantState) -> str:
    return '' if state.mode is not None and MODES[state.mode].held else 'no_steps'


def _not_running(state: PendantState) -> str:
    return 'running' if state.program.state is RunState.RUNNING else ''


def _editable(state: PendantState) -> str:
    if state.program.state is RunState.IDLE:  # as one that could not be opened
        return '' if state.program.path else 'no_program'
    return '' if state.program.state in STARTABLE else 'not_ended'


def _pausable(state: PendantState) -> str:
    return '' if state.program.state is RunState.RUNNING or state.program.waits_for_run else 'not_running'


_RUNNABLE: Final = (_missing, _stopped, _commander(Commander.PROGRAM))
_UNDER_WAY: Final = _program(RunState.RUNNING, RunState.PAUSED, otherwise='not_running')

RULES: Final[Mapping[Action, tuple[Rule, ...]]] = {
    Action.JOG: (_missing, _stopped, _commander(Commander.PENDANT)),
    Action.MOVE: (_missing, _stopped, _commander(Commander.PENDANT), _steps),
    Action.TEACH: (_missing, _not_running),
    Action.EDIT: (_missing, _editable),
    Action.OPEN: (_missing, _program(RunState.IDLE, *STARTABLE, otherwise='under_way')),
    Action.RUN: (*_RUNNABLE, _program(*STARTABLE, otherwise='not_startable'), _held),
    Action.HOLD_RUN: (
        *_RUNNABLE,
        _program(*STARTABLE, RunState.RUNNING, RunState.PAUSED, otherwise='not_startable'),
        _not_held,
    ),
    Action.STEP: (
        *_RUNNABLE,
        _program(RunState.OPENED, RunState.RUNNING, RunState.PAUSED, otherwise='not_paused'),
    ),
    Action.BREAK: (_missing,),
    Action.PAUSE: (_missing, _pausable),
    Action.RESUME: (*_RUNNABLE, _program(RunState.PAUSED, otherwise='not_paused'), _held),
    Action.END: (_missing, _UNDER_WAY),
    Action.REWIND: (_missing, _program(*STARTABLE, otherwise='not_ended')),
    Action.RESET: (_missing, lambda state: '' if state.fault else 'no_fault'),
    Action.MODE: (_missing, _not_running),
    Action.OVERRIDE: (),
    Action.SWITCH: (_missing, _manual),
}
"""In their order: the first reason is shown."""


def refusal(action: Action, state: PendantState) -> Reason | None:
    """Why an action is not permitted now; None if it is."""
    for rule in RULES[action]:
        if key := rule(state):
            return Reason(key, state.values)
    return None
