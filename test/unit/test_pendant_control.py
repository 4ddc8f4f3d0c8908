"""Who operates a robot, and what may be pressed."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest

from pendant_desk import JOG, ME, READY, Desk
from robots_controller.io.io_image import Channel
from robots_controller.pendant.jog.held_button import Sign
from robots_controller.pendant.pendant_operator import SERVICES, ControlDesk
from robots_controller.pendant.pendant_state import PendantState, ShownProgram
from robots_controller.pendant.permissions import Action, NotPermittedError, refusal
from robots_controller.pendant.texts import LANGUAGES, read_texts
from robots_controller.program.run_state import RunState
from robots_core.blocks.following.guide import Guide
from robots_core.cell_interface.operating_modes import Commander, OperatingMode
from robots_core.errors import InvalidInputError, RobotsError

OTHER = 'other'
OUTPUT = Channel('digital', 'output', 3)
INPUT = Channel('digital', 'input', 2)
WAITING_FOR_RUN = ShownProgram('/p/a.lua', RunState.PAUSED, 'a.lua', hold='release')


def with_program(state: RunState, **changes: Any) -> PendantState:
    return replace(READY, program=ShownProgram('/p/a.lua', state, 'a.lua'), **changes)


def reason(action: Action, state: PendantState) -> str:
    found = refusal(action, state)
    return '' if found is None else found.message


def test_one_viewer_operates_and_another_one_takes_over_on_purpose() -> None:
    desk = Desk()
    desk.hold()
    with pytest.raises(NotPermittedError, match='controlled'):
        desk.operator.hold(Sign(OTHER, 1, JOG))
    with pytest.raises(NotPermittedError, match='controlled'):
        desk.operator.take_control(OTHER)
    assert desk.cell.commanded().any()
    told: list[str] = []
    desk.operator.desk.log = told.append
    desk.operator.take_control(OTHER, address='192.168.0.7', from_other=True)
    assert told == ['the page at 192.168.0.7 operates the robot']
    assert not desk.cell.commanded().any()
    with pytest.raises(NotPermittedError, match='controlled'):
        desk.hold(2)
    desk.operator.hold(Sign(OTHER, 1, JOG))
    assert desk.cell.commanded().any()


def test_anyone_stops_and_the_rest_needs_control() -> None:
    desk = Desk(with_program(RunState.RUNNING))
    desk.operator.give_back_control(ME)
    refused = [
        lambda: desk.operator.act(OTHER, Action.PAUSE),
        lambda: desk.operator.open_program(OTHER, '/p/b.lua'),
        lambda: desk.operator.set_mode(OTHER, 'T2'),
        lambda: desk.operator.set_override(OTHER, 0.5),
        lambda: desk.operator.set_output(OTHER, OUTPUT, 1.0),
        lambda: desk.operator.force_input(OTHER, INPUT, None),
    ]
    for command in refused:
        with pytest.raises(NotPermittedError, match='not_in_control'):
            command()
    assert desk.cell.calls == []
    desk.operator.stop()
    assert desk.cell.calls == [('stop',)]


def test_a_stop_ends_what_is_held() -> None:
    desk = Desk()
    desk.hold()
    desk.operator.stop()
    assert [call[0] for call in desk.cell.calls] == ['jog_axes', 'jog_axes', 'stop']
    assert not np.any(desk.cell.calls[1][1])


def test_control_is_given_back_by_its_holder_alone() -> None:
    desk = ControlDesk()
    desk.take(ME)
    desk.give_back(OTHER)
    assert desk.holder == ME
    desk.give_back(ME)
    desk.take(OTHER)
    desk.check(OTHER)


def test_what_is_permitted_is_commanded() -> None:
    desk = Desk(with_program(RunState.PAUSED, run_enabled=True))
    operator = desk.operator
    operator.act(ME, Action.RESUME)
    assert desk.cell.last == ('call', 'lua_program_node/resume')
    operator.set_override(ME, 0.3)
    assert desk.cell.last == ('set_override', 0.3)
    operator.set_output(ME, OUTPUT, 1.0)
    assert desk.cell.last == ('set_io', OUTPUT, 1.0)
    operator.force_input(ME, INPUT, None)
    assert desk.cell.last == ('force', INPUT, None)
    operator.state = with_program(RunState.FINISHED)
    operator.open_program(ME, '/p/b.lua')
    assert desk.cell.last == ('open_program', '/p/b.lua')
    operator.set_mode(ME, 'AUTOMATIC')
    assert desk.cell.last == ('set_parameters', 'controller_node', 'AUTOMATIC')


def test_odd_values_are_refused() -> None:
    desk = Desk()
    with pytest.raises(InvalidInputError, match=r'override = 1.5 must be in \[0, 1\]'):
        desk.operator.set_override(ME, 1.5)
    with pytest.raises(InvalidInputError, match='digital output 3 is 2; valid are 0 and 1'):
        desk.operator.set_output(ME, OUTPUT, 2.0)
    with pytest.raises(RobotsError, match="unknown operating mode 'T9'"):
        desk.operator.set_mode(ME, 'T9')
    assert desk.cell.calls == []


AUTOMATIC = replace(READY, mode=OperatingMode.AUTOMATIC)
GUIDED = replace(AUTOMATIC, guide=Guide.PERSON, commander=Commander.PROGRAM)


@pytest.mark.parametrize(
    ('action', 'state', 'expected'),
    [
        (Action.JOG, READY, ''),
        (Action.JOG, PendantState(), 'lost'),
        (Action.JOG, AUTOMATIC, 'mode_excludes_pendant'),
        (Action.JOG, GUIDED, ''),
        (Action.JOG, replace(READY, fault='collision'), 'fault'),
        (Action.JOG, replace(READY, commander=Commander.PROGRAM), 'commanded'),
        (Action.MOVE, READY, ''),
        (Action.MOVE, AUTOMATIC, 'mode_excludes_pendant'),
        (Action.MOVE, GUIDED, 'no_steps'),
        (Action.RUN, with_program(RunState.OPENED, mode=OperatingMode.AUTOMATIC), ''),
        (Action.RUN, with_program(RunState.OPENED), 'hold_needed'),
        (Action.RUN, with_program(RunState.OPENED, mode=OperatingMode.REMOTE), 'mode_excludes_program'),
        (Action.RUN, AUTOMATIC, 'not_startable'),
        (Action.TEACH, with_program(RunState.PAUSED), ''),
        (Action.TEACH, with_program(RunState.RUNNING), 'running'),
        (Action.EDIT, with_program(RunState.PAUSED), 'not_ended'),
        (Action.EDIT, with_program(RunState.FAILED), ''),
        (Action.HOLD_RUN, with_program(RunState.OPENED, mode=OperatingMode.AUTOMATIC), 'no_hold_needed'),
        (Action.PAUSE, with_program(RunState.RUNNING), ''),
        (Action.PAUSE, with_program(RunState.PAUSED), 'not_running'),
        (Action.PAUSE, replace(READY, program=WAITING_FOR_RUN), ''),
        (Action.RESUME, with_program(RunState.FINISHED), 'not_paused'),
        (Action.END, with_program(RunState.PAUSED), ''),
        (Action.REWIND, with_program(RunState.RUNNING), 'not_ended'),
        (Action.OPEN, with_program(RunState.PAUSED), 'under_way'),
        (Action.RESET, READY, 'no_fault'),
        (Action.MODE, with_program(RunState.RUNNING), 'running'),
        (Action.SWITCH, READY, ''),
        (Action.SWITCH, AUTOMATIC, 'not_manual'),
    ],
)
def test_what_may_be_pressed(action: Action, state: PendantState, expected: str) -> None:
    assert reason(action, state) == expected


def test_what_nodes_are_asked_for_is_an_action() -> None:
    assert set(SERVICES) < set(Action)


def test_every_reason_has_its_text() -> None:
    reasons = set()
    states = [
        replace(state, mode=mode, commander=commander, fault=fault, lost=lost)
        for state in (with_program(one) for one in RunState)
        for mode in (None, *OperatingMode)
        for commander in Commander
        for fault, lost in (('', ()), ('fault', ()), ('', ('planning_node',)))
    ]
    for action, state in product(Action, states):
        if (found := refusal(action, state)) is not None:
            reasons.add(found.message)
            for code in LANGUAGES:
                assert '{' not in read_texts(code).error(found)
    known = {key.removeprefix('reasons.') for key in read_texts('en').texts if key.startswith('reasons.')}
    raised = {'controlled', 'not_in_control', 'no_preview', 'no_position', 'no_program', 'moving'}
    assert reasons | raised | {'no_torque', 'none_recorded'} == known
