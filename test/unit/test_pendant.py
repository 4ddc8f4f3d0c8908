"""What an operator's page may command, and what it shows; without a browser and without ROS."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pendant_desk import JOG, ME, READY, Desk
from robots_controller.io.io_image import Channel
from robots_controller.pendant.control_desk import ControlDesk
from robots_controller.pendant.jog.held_button import MOVE_KEY, RUN_KEY
from robots_controller.pendant.jog.jog_command import COMPONENTS, JogCommand
from robots_controller.pendant.jog.press import DEADLINE
from robots_controller.pendant.pendant_operator import SERVICES
from robots_controller.pendant.pendant_state import JogSpeeds, PendantState, ShownProgram
from robots_controller.pendant.permissions import Action, NotPermittedError, refusal
from robots_controller.pendant.texts import LANGUAGES, read_texts
from robots_controller.program.run_state import RunState
from robots_core import Pose, load_robot_model
from robots_core.blocks.following.guide import Guide
from robots_core.cell_interface.operating_modes import Commander, OperatingMode
from robots_core.errors import InvalidInputError, ProgramError, RobotsError
from robots_planning.motion_settings import MotionSettings, frame_numbers

OTHER = 'other'
OUTPUT, INPUT = Channel('digital', 'output', 3), Channel('digital', 'input', 2)


def with_program(state: RunState, **changes: Any) -> PendantState:
    return replace(READY, program=ShownProgram('/p/a.lua', state, 'a.lua'), **changes)


def reason(action: Action, state: PendantState) -> str:
    found = refusal(action, state)
    return '' if found is None else found.key


# -- what is held --------------------------------------------------------------------------------------------


def test_an_axis_is_jogged_with_each_sign_and_stops_when_it_is_released() -> None:
    desk = Desk()
    for _ in range(3):
        assert desk.hold(speed=0.5) is None
    assert len(desk.cell.calls) == 3
    expected = np.zeros(desk.robot.num_axes)
    expected[0] = 0.5 * 0.1 * desk.robot.axes_data.velocity[0]
    np.testing.assert_allclose(desk.cell.commanded(), expected)
    desk.operator.release(ME)
    assert not desk.cell.commanded().any()
    desk.operator.release(ME)
    assert len(desk.cell.calls) == 4


def test_without_signs_nothing_is_commanded_and_late_ones_move_nothing() -> None:
    desk = Desk()
    desk.hold()
    desk.hold(after=DEADLINE + 1e-3)
    assert not desk.cell.commanded().any()
    count = len(desk.cell.calls)
    for _ in range(5):  # what was kept somewhere on the way
        desk.hold(after=0.0)
    desk.operator.release(ME)
    assert len(desk.cell.calls) == count
    desk.hold(2)
    assert desk.cell.commanded().any()


@pytest.mark.parametrize('end', ['release', 'give_back_control'])
def test_what_is_held_ends_with_the_connection(end: str) -> None:
    desk = Desk()
    desk.hold(key='tool 2 -')
    assert desk.cell.commanded()[2] < 0.0
    getattr(desk.operator, end)(ME)
    assert not desk.cell.commanded().any()
    assert desk.operator.desk.holder == (ME if end == 'release' else '')


def test_what_is_held_ends_when_the_state_does_not_permit_it_any_more() -> None:
    desk = Desk()
    desk.hold()
    desk.operator.state = replace(READY, fault='emergency stop')
    with pytest.raises(NotPermittedError, match='fault'):
        desk.hold()
    assert not desk.cell.commanded().any()
    desk.operator.state = READY
    count = len(desk.cell.calls)
    assert desk.hold() is None
    assert len(desk.cell.calls) == count


def test_the_tool_is_jogged_in_frames_of_its_own() -> None:
    desk = Desk(replace(READY, jog_speeds=JogSpeeds(0.1, 0.2)))
    desk.hold(key='tool 0 +')
    assert (desk.cell.commanded()[0], desk.cell.last[2]) == (0.2, 'tool')
    desk.hold(2, key='base 5 -', speed=0.1)
    assert desk.cell.commanded()[5] == pytest.approx(-0.05)
    assert desk.cell.last[2] == 'base'


@pytest.mark.parametrize(
    ('key', 'speed', 'error'),
    [
        ('axes 5 +', 1.0, r"jog index = 5 must be in \[0, 4\] for 'axes'"),
        ('tool 6 +', 1.0, r'jog index = 6 must be in \[0, 5\]'),
        ('world 0 +', 1.0, r"'world 0 \+' is unknown; valid is a frame \(axes, tool, base, taught\)"),
        ('axes 0', 1.0, 'is unknown'),
        ('axes 0 + +', 1.0, 'is unknown'),
        ('', 1.0, 'is unknown'),
        (JOG, 0.0, r'jog speed = 0 must be in \(0, 1\]'),
        (JOG, float('nan'), 'jog speed = nan'),
    ],
)
def test_odd_presses_are_refused(key: str, speed: float, error: str) -> None:
    desk = Desk()
    with pytest.raises(InvalidInputError, match=error):
        desk.hold(key=key, speed=speed)
    assert not any(np.any(call[1]) for call in desk.cell.calls)


def test_every_direction_has_its_button() -> None:
    speeds = JogSpeeds()
    for index, sign in product(range(COMPONENTS), '+-'):
        twist = JogCommand.from_key(f'base {index} {sign}', 1.0, 7).twist(speeds)
        assert np.flatnonzero(twist).tolist() == [index]
        assert (twist[index] > 0.0) == (sign == '+')


@pytest.mark.parametrize('name', ['', 'P1'])
def test_a_tool_is_jogged_along_a_taught_frame(tmp_path: Path, name: str) -> None:
    desk = Desk()
    points = tmp_path / 'part.points.yaml'
    turned = Pose.from_angles([0.5, 0.0, 0.8], [0.4, -0.3, 1.2], 'zyx')
    base = MotionSettings(base=frame_numbers(turned))
    program = ShownProgram(str(tmp_path / 'part.lua'), points_file=str(points))
    desk.operator.state = replace(READY, program=program, settings=base)
    desk.operator.teaching.teach(points, 'P1', np.array(desk.robot.home))
    pose = desk.operator.jog_frames()[name]
    expected = Pose(*desk.robot.direct_kinematics(desk.robot.home)) if name else turned
    np.testing.assert_allclose(pose.T, expected.T, atol=1e-12)
    for index in range(COMPONENTS):
        desk.hold(index, f'taught {index} +', taught=pose.T)
        command, twist, frame = desk.cell.last
        assert (command, frame) == ('jog_tool', 'base')
        seen = np.reshape(twist, (2, 3)) @ expected.T  # along the frame's own axes
        assert np.flatnonzero(np.abs(seen.ravel()) > 1e-12).tolist() == [index]


def test_a_broken_points_file_is_told_with_its_line(tmp_path: Path) -> None:
    desk = Desk()
    points = tmp_path / 'part.points.yaml'
    points.write_text('points:\n  P1: {q: [0,\n')
    desk.operator.state = replace(READY, program=ShownProgram('part.lua', points_file=str(points)))
    with pytest.raises(ProgramError, match=r'part\.points\.yaml:3:'):
        desk.operator.jog_frames()


def test_run_is_held_and_starts_the_program_once() -> None:
    desk = Desk(with_program(RunState.OPENED))
    assert desk.hold(key=RUN_KEY) is None
    assert desk.cell.last == ('hold_run', True)
    desk.operator.state = with_program(RunState.OPENED, run_enabled=True)
    assert desk.hold(key=RUN_KEY) is Action.RUN
    desk.operator.state = with_program(RunState.FINISHED, run_enabled=True)
    assert desk.hold(key=RUN_KEY) is None
    desk.operator.release(ME)
    assert desk.cell.last == ('hold_run', False)


@pytest.mark.parametrize(('hold', 'action'), [('pause', Action.RESUME), ('release', None)])
def test_holding_run_resumes_what_was_paused_by_a_button(hold: str, action: Action | None) -> None:
    state = with_program(RunState.PAUSED, run_enabled=True)
    desk = Desk(replace(state, program=replace(state.program, hold=hold)))
    assert desk.hold(key=RUN_KEY) is action


# -- steps and targets ---------------------------------------------------------------------------------------


def moves(desk: Desk) -> list[str]:
    """What was commanded, without signs that follow each other."""
    names = [call[0] + ('' if call[0] != 'hold_run' else f' {call[1]}') for call in desk.cell.calls]
    return [name for i, name in enumerate(names) if name != 'reference' and names[i - 1 : i] != [name]]


def standing_desk() -> Desk:
    robot = load_robot_model('cello_bot')
    q = np.array(robot.home)
    desk = Desk(replace(READY, q=q, tool=Pose(*robot.direct_kinematics(q))))
    desk.cell.reference = lambda: None  # type: ignore[attr-defined]
    return desk


def test_a_step_is_commanded_once_and_run_held_until_it_has_ended() -> None:
    desk = standing_desk()
    for _ in range(3):
        assert desk.hold(step=0.001) is None
    assert moves(desk) == ['begin_move', 'hold_run True']
    command, done = desk.cell.calls[0][1:]
    assert command.q[0] == pytest.approx(desk.robot.home[0] + 0.001)
    done(None)
    count = len(desk.cell.calls)
    desk.hold(step=0.001)
    desk.operator.release(ME)
    assert moves(desk)[-2:] == ['hold_run False', 'end_move']
    assert len(desk.cell.calls) == count
    desk.hold(2, step=0.001)
    assert moves(desk)[-2:] == ['begin_move', 'hold_run True']


def test_a_release_ends_a_step_and_its_late_end_is_no_failure() -> None:
    desk = standing_desk()
    desk.hold(step=0.001)
    desk.operator.release(ME)
    assert moves(desk) == ['begin_move', 'hold_run True', 'hold_run False', 'end_move']
    desk.cell.calls[0][2](RobotsError('stopped'))
    assert desk.operator.held.failure is None


def test_what_refuses_a_step_is_kept_for_its_viewer() -> None:
    desk = standing_desk()
    desk.hold(step=0.001)
    error = RobotsError('out of reach')
    desk.cell.calls[0][2](error)
    assert desk.operator.held.failure == (ME, error)
    assert moves(desk)[-1] == 'end_move'


def test_a_target_is_moved_to_after_its_preview() -> None:
    desk = standing_desk()
    with pytest.raises(NotPermittedError, match='no_preview'):
        desk.hold(key=MOVE_KEY)
    goal = np.array(desk.robot.home)
    goal[0] += 0.05
    found = desk.operator.preview(ME, 'joints', goal.tolist(), 0.5)
    assert found.duration > 0.0
    np.testing.assert_allclose(desk.cell.last[1], goal)
    for time, q in ((0.0, desk.robot.home), (found.duration, goal)):
        desk.operator.play_preview(ME, time)
        np.testing.assert_allclose(desk.cell.last[1], q)
    count = len(desk.cell.calls)
    desk.operator.play_preview(OTHER, 0.0)
    assert len(desk.cell.calls) == count
    desk.hold(2, key=MOVE_KEY)
    assert moves(desk)[-2:] == ['begin_move', 'hold_run True']
    desk.operator.give_back_control(ME)
    assert desk.cell.last == ('show_ghost', None)


@pytest.mark.parametrize('step', [-0.1, 0.6, float('nan')])
def test_odd_steps_are_refused(step: float) -> None:
    desk = standing_desk()
    with pytest.raises(InvalidInputError, match=r'step = .* must be above 0, at most 0\.5'):
        desk.hold(step=step)
    assert desk.cell.calls == []


# -- who operates --------------------------------------------------------------------------------------------


def test_one_viewer_operates_and_another_one_takes_over_on_purpose() -> None:
    desk = Desk()
    desk.hold()
    with pytest.raises(NotPermittedError, match='controlled'):
        desk.operator.hold(OTHER, 1, JOG)
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
    desk.operator.hold(OTHER, 1, JOG)
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


# -- what is pressed once ------------------------------------------------------------------------------------


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
    assert desk.cell.last == ('set_mode', OperatingMode.AUTOMATIC)


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
            reasons.add(found.key)
            for code in LANGUAGES:
                assert '{' not in read_texts(code).error(NotPermittedError(found))
    known = {key.removeprefix('reasons.') for key in read_texts('en').texts if key.startswith('reasons.')}
    raised = {'controlled', 'not_in_control', 'no_preview', 'no_position', 'no_program', 'moving'}
    assert reasons | raised | {'no_torque', 'none_recorded'} == known
