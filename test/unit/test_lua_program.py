"""LuaProgram: table 1 of the paper, and the life of a program."""

from __future__ import annotations

import threading
from pathlib import Path

import numpy as np
import pytest

from cell_double import CellDouble
from robots_controller.interpreter.lua_program import LuaProgram
from robots_controller.program.run_state import RunState
from robots_core.errors import InvalidInputError, ProgramError
from robots_core.pose import Pose
from robots_planning.robot_command_state import RobotCommandState

from .lua_host import DEADLINE, LuaHost

PROGRAMS = Path(__file__).parents[2] / 'programs'
MOVE = 'ptpJointSpaceAngles(0, 0, 0, 0, 0, 0)'


def test_command_states_alternate_between_idle_and_motion(tmp_path: Path):
    states: list[RobotCommandState] = []
    host = LuaHost(tmp_path)
    host.holding = True
    host.start(f'{MOVE}\nptpCartesianSpace(1, 0, 1, 0, 0, 0)\nptpJointSpacePosition(1, 0, 1, 0, 0, 0)')
    for _ in range(3):
        host.wait_for_command()
        states.append(host.program.command_state)
        host.program.finish_motion()
    assert host.program.join(DEADLINE)
    assert states == ['PTPJOINT_JOINT', 'PTPCARTESIAN', 'PTPJOINT_CARTESIAN']
    assert host.program.command_state is RobotCommandState.IDLE
    assert host.program.motion is None


def test_motion_call_returns_when_the_host_says_so(tmp_path: Path):
    host = LuaHost(tmp_path)
    host.holding = True
    host.start(f"{MOVE}\nprint('there')")
    host.wait_for_command()
    assert host.program.motion is host.commands[0]
    assert host.printed == []
    host.program.command_state = RobotCommandState.IDLE
    assert host.program.join(DEADLINE)
    assert host.printed == ['there']


def test_host_that_answers_inside_the_callback(tmp_path: Path):
    program = LuaProgram(6, CellDouble(command=lambda _: program.finish_motion()))
    path = tmp_path / 'p.lua'
    path.write_text(MOVE)
    program.open(path)
    program.run()
    assert program.join(DEADLINE)
    assert program.run_state is RunState.FINISHED


def test_error_raised_by_the_host_fails_the_motion(tmp_path: Path):
    def refuse(_: object) -> None:
        raise ProgramError('not now')

    program = LuaProgram(6, CellDouble(command=refuse))
    path = tmp_path / 'p.lua'
    path.write_text(MOVE)
    program.open(path)
    program.run()
    assert program.join(DEADLINE)
    assert str(program.error) == 'p.lua:1: ptpJointSpaceAngles: not now'
    program.run()
    assert program.join(DEADLINE)
    assert str(program.error) == 'p.lua:1: ptpJointSpaceAngles: not now'


def test_exception_of_a_callback_ends_the_program_and_is_reported(tmp_path: Path):
    ended: list[ProgramError | None] = []

    def broken(*_: object) -> None:
        raise TypeError('a mistake of the host')

    program = LuaProgram(6, CellDouble(printed=broken, ended=ended.append))
    path = tmp_path / 'p.lua'
    path.write_text("while true do pcall(print, 'x') end")
    program.open(path)
    program.run()
    assert program.join(DEADLINE)
    assert program.run_state is RunState.FAILED
    assert isinstance(ended[0], ProgramError)
    assert isinstance(ended[0].__cause__, TypeError)


@pytest.mark.parametrize('text', ['wait(1000)', 'while true do pcall(wait, 1) end', 'while true do end'])
def test_a_program_fails_for_a_reason_from_outside_wherever_it_is(tmp_path: Path, text: str):
    host = LuaHost(tmp_path)
    assert not host.program.fail('too early')
    host.start(f'print("here")\n{text}')
    host.wait_for_print()
    assert host.program.fail('emergency stop')
    assert host.program.join(DEADLINE)
    assert host.program.run_state is RunState.FAILED
    assert str(host.program.error).endswith(': emergency stop')
    assert str(host.program.error).startswith('test.lua:')
    host.start('wait(0)')
    assert host.program.join(DEADLINE)
    assert host.program.run_state is RunState.FINISHED


def test_life_of_a_program(tmp_path: Path):
    host = LuaHost(tmp_path)
    program = host.program
    assert program.run_state is RunState.IDLE
    with pytest.raises(ProgramError, match='no program is open'):
        program.run()
    with pytest.raises(ProgramError, match='no program is open'):
        program.reset()
    host.holding = True
    host.start(MOVE)
    host.wait_for_command()
    assert program.run_state is RunState.RUNNING
    for action in (program.run, program.reset, lambda: program.open(tmp_path / 'test.lua')):
        with pytest.raises(ProgramError, match=r'test\.lua is running; stop it first'):
            action()
    with program.condition:  # it cannot end before the request is refused
        assert program.stop()
        with pytest.raises(ProgramError, match=r'test\.lua is stopping; wait until it has stopped'):
            program.run()
    assert program.join(DEADLINE)
    assert program.run_state is RunState.STOPPED
    for action in (program.run, program.reset):
        with pytest.raises(ProgramError, match='the robot still moves for line 1'):
            action()
    program.finish_motion()
    program.reset()
    assert program.run_state is RunState.OPENED
    assert not program.stop()
    assert not program.pause()
    assert not program.resume()


def test_program_that_failed_runs_again(tmp_path: Path):
    host = LuaHost(tmp_path)
    error = host.fails('\nwelding()')
    assert host.program.error is error
    assert host.program.line == 2
    assert host.program.source_line(2) == 'welding()'
    host.program.run()
    assert host.program.join(DEADLINE)
    assert len(host.finished) == 2
    host.program.reset()
    assert host.program.error is None
    assert host.run("print('fine')") is None


@pytest.mark.parametrize('name', ['broken.lua', 'missing.lua', f'{300 * "long"}.lua', 'null\0.lua'])
def test_after_a_file_that_cannot_be_opened_the_program_before_does_not_run_in_its_place(
    tmp_path: Path, name: str
):
    host = LuaHost(tmp_path)
    assert host.run("print('first')") is None
    host.write('(', 'broken.lua')
    with pytest.raises(ProgramError):
        host.program.open(tmp_path / name)
    assert (host.program.run_state, host.program.path) == (RunState.IDLE, None)
    with pytest.raises(ProgramError, match='no program is open; open one first'):
        host.program.run()


def test_a_program_that_runs_stays_open_whatever_is_opened(tmp_path: Path):
    host = LuaHost(tmp_path)
    host.start("waitDigitalInput(1, 1)\nprint('on')")
    with pytest.raises(ProgramError, match=r'cannot open another program: .* is running; stop it first'):
        host.program.open(host.write('(', 'broken.lua'))
    host.program.io.set_inputs('digital', [1])
    assert host.program.join(DEADLINE)
    assert host.printed == ['on']


def test_paused_program_holds_before_its_next_call(tmp_path: Path):
    host = LuaHost(tmp_path)
    host.holding = True
    host.start(f"{MOVE}\nprint('after')")
    host.wait_for_command()
    assert host.program.pause()
    assert not host.program.pause()
    assert host.program.run_state is RunState.PAUSED
    host.program.finish_motion()
    assert not host.program.join(0.1)  # it holds: it could print within microseconds
    assert host.printed == []
    assert host.program.resume()
    assert host.program.join(DEADLINE)
    assert host.printed == ['after']


def test_computing_program_is_paused_too(tmp_path: Path):
    host = LuaHost(tmp_path)
    host.start("x = 0 print('begin') while x < 3 do x = x + getAnalogInput(1) end")
    host.wait_for_print()
    assert host.program.pause()
    host.program.analog_inputs = [1.0]
    assert not host.program.join(0.1)
    assert host.program.resume()
    assert host.program.join(DEADLINE)
    assert host.program.run_state is RunState.FINISHED


def test_paused_program_is_stopped(tmp_path: Path):
    host = LuaHost(tmp_path)
    host.start("print('begin') while true do end")
    host.wait_for_print()
    host.program.pause()
    assert host.program.stop()
    assert host.program.join(DEADLINE)
    assert host.program.run_state is RunState.STOPPED


def test_inputs_and_outputs_from_many_threads_while_it_runs(tmp_path: Path):
    host = LuaHost(tmp_path)
    host.start("""
        print('begin')
        while not getDigitalInput(32) do
          setAnalogOutput(1, getAnalogInput(1))
          setAnalogOutput(2, getAnalogInput(1))
        end""")
    host.wait_for_print()

    def talk() -> None:
        for value in range(200):
            host.program.analog_inputs = [value, value]
            first, second = host.program.analog_outputs[:2]
            assert first >= 0.0
            assert second >= 0.0
            assert host.program.run_state is RunState.RUNNING

    threads = [threading.Thread(target=talk) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(DEADLINE)
    host.program.digital_inputs = [0] * 31 + [1]
    assert host.program.join(DEADLINE)
    assert host.finished == [None]


def test_lines_are_reported_at_every_change(tmp_path: Path):
    host = LuaHost(tmp_path)
    assert host.run('wait(0) wait(0)\n\nwait(0)\nfor i = 1, 2 do\n wait(0)\nend') is None
    assert host.lines == [1, 3, 5]


def test_number_of_axes_decides_about_joint_angles(tmp_path: Path):
    host = LuaHost(tmp_path)
    host.program.num_axes = 7
    assert 'the robot has 7 axes' in str(host.fails(MOVE))
    np.testing.assert_array_equal(host.program.overrides, np.ones(7))


@pytest.mark.parametrize(
    ('options', 'message'),
    [
        ({'num_axes': 0}, 'num_axes'),
        ({'num_axes': 6, 'digital_size': 0}, 'digital'),
        ({'num_axes': 6, 'orientation_convention': 'abc'}, 'valid are zyx'),
        ({'num_axes': 6, 'prismatic': (True,)}, 'prismatic'),
    ],
)
def test_wrong_options_are_refused(options: dict[str, object], message: str):
    with pytest.raises(InvalidInputError, match=message):
        LuaProgram(cell=CellDouble(), **options)  # type: ignore[arg-type]


def test_welding_program_is_the_papers(tmp_path: Path):
    host = LuaHost(tmp_path)
    text = (PROGRAMS / 'welding.lua').read_text().replace('wait(1)', 'wait(0)')
    assert host.run(text) is None
    assert host.printed == ['Welding Program 1']
    assert [command.function for command in host.commands] == [
        'ptpJointSpaceAngles',
        'ptpCartesianSpace',
        'ptpCartesianSpace',
        'ptpCartesianSpace',
    ]
    np.testing.assert_allclose(np.degrees(host.commands[0].q), [0, -90, 45, 0, 45, 0], atol=1e-12)
    targets = ([0.37, -1.78, 1.21], [0.37, -1.78, 1.18], [0.375, -1.78, 1.21])
    for command, r in zip(host.commands[1:], targets, strict=True):
        assert command.pose is not None
        np.testing.assert_array_equal(command.pose.r, r)
        expected = Pose.from_angles(r, np.radians([-42.03, 117.47, -35.89]))
        np.testing.assert_array_equal(command.pose.T, expected.T)
    assert [(c.index, c.value) for c in host.outputs] == [(1, 1.0), (1, 0.0)]
    assert host.commands[2].line < host.outputs[0].line < host.outputs[1].line < host.commands[3].line
