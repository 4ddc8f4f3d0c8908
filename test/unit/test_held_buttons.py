"""Buttons of an operator that are held: jogging, and running a program."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pendant_desk import JOG, ME, READY, Desk
from robots_controller.pendant.jog.held_button import DEADLINE, RUN_KEY
from robots_controller.pendant.jog.jog_command import COMPONENTS, JogCommand
from robots_controller.pendant.pendant_state import JogSpeeds, PendantState, ShownProgram
from robots_controller.pendant.permissions import Action, NotPermittedError
from robots_controller.program.run_state import RunState
from robots_core import Pose
from robots_core.errors import InvalidInputError, ProgramError
from robots_planning.motion_settings import MotionSettings, frame, frame_numbers


def with_program(state: RunState, **changes: Any) -> PendantState:
    return replace(READY, program=ShownProgram('/p/a.lua', state, 'a.lua'), **changes)


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
    pose = desk.operator.points()[name].pose if name else frame(base.base, 'base')
    expected = Pose(*desk.robot.direct_kinematics(desk.robot.home)) if name else turned
    np.testing.assert_allclose(pose.T, expected.T, atol=1e-12)
    for index in range(COMPONENTS):
        desk.hold(index, f'taught {index} +', taught=pose.T)
        command, twist, axes = desk.cell.last
        assert (command, axes) == ('jog_tool', 'base')
        seen = np.reshape(twist, (2, 3)) @ expected.T  # along the frame's own axes
        assert np.flatnonzero(np.abs(seen.ravel()) > 1e-12).tolist() == [index]


def test_a_broken_points_file_is_reported_with_its_line(tmp_path: Path) -> None:
    desk = Desk()
    points = tmp_path / 'part.points.yaml'
    points.write_text('points:\n  P1: {q: [0,\n')
    desk.operator.state = replace(READY, program=ShownProgram('part.lua', points_file=str(points)))
    with pytest.raises(ProgramError, match=r'part\.points\.yaml:3:'):
        desk.operator.points()


def test_a_sign_that_arrives_after_the_release_begins_nothing() -> None:
    desk = Desk(with_program(RunState.FINISHED, run_enabled=True))
    assert desk.hold(4, key=RUN_KEY) is Action.RUN
    desk.operator.release(ME)
    calls = len(desk.cell.calls)
    assert desk.hold(4, key=RUN_KEY) is None
    assert desk.hold(3) is None
    assert len(desk.cell.calls) == calls
    assert desk.hold(5, key=RUN_KEY) is Action.RUN


def test_a_late_sign_of_the_press_before_does_not_end_the_present_one() -> None:
    desk = Desk()
    desk.hold(1, key='axes 1 +')
    desk.hold(2)
    held = desk.cell.commanded()
    desk.hold(1, key='axes 1 +')
    np.testing.assert_array_equal(desk.cell.commanded(), held)
    desk.hold(2)
    np.testing.assert_array_equal(desk.cell.commanded(), held)


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


def test_a_program_that_ends_while_run_is_held_is_not_started_again() -> None:
    paused = with_program(RunState.PAUSED)
    desk = Desk(replace(paused, program=replace(paused.program, hold='release')))
    assert desk.hold(key=RUN_KEY) is None
    # It has resumed and ended between two signs of the press.
    desk.operator.state = with_program(RunState.FINISHED, run_enabled=True)
    assert desk.hold(key=RUN_KEY) is None


def test_a_program_that_waits_for_run_is_paused_before_its_step() -> None:
    state = with_program(RunState.PAUSED)
    desk = Desk(replace(state, program=replace(state.program, hold='release')))
    signs = [desk.hold(key='step over') for _ in range(2)]
    assert signs == [Action.PAUSE, None]
    assert desk.cell.calls == []  # held run would let it continue
    desk.operator.state = with_program(RunState.PAUSED)
    assert desk.hold(key='step over') is None
    assert desk.cell.last == ('hold_run', True)
    desk.operator.state = with_program(RunState.PAUSED, run_enabled=True)
    assert [desk.hold(key='step over') for _ in range(2)] == [Action.STEP, None]


@pytest.mark.parametrize(('hold', 'action'), [('pause', Action.RESUME), ('release', None)])
def test_holding_run_resumes_what_was_paused_by_a_button(hold: str, action: Action | None) -> None:
    state = with_program(RunState.PAUSED, run_enabled=True)
    desk = Desk(replace(state, program=replace(state.program, hold=hold)))
    assert desk.hold(key=RUN_KEY) is action
