"""Tasks beside a program, and values that programs keep."""

from __future__ import annotations

from pathlib import Path

import pytest

from .lua_host import DEADLINE, LuaHost
from .simulated_program import outputs, run_text


def test_a_task_goes_on_while_the_program_waits_and_ends_with_it(tmp_path: Path):
    (tmp_path / 'task.lua').write_text("for i = 1, 1000 do print('task', i, ...) wait(0.01) end")
    run = run_text(tmp_path, "startTask('task', 7) wait(0.055) print('end')")
    assert run.ok, run.error
    assert run.printed == (*(f'task\t{i}\t7' for i in range(1, 7)), 'end')
    assert run.duration == pytest.approx(0.055, abs=0.004)


def test_a_task_has_the_globals_of_the_program(tmp_path: Path):
    host = LuaHost(tmp_path)
    text = 'while true do waitDigitalInput(1, true) count = count + 1 waitDigitalInput(1, false) end'
    host.write(text, 'task.lua')
    host.start("count = 0 startTask('task') print('on') waitDigitalInput(2, true) print(count)")
    host.wait_for_print()
    for value in (1, 0, 1, 0):
        host.program.digital_inputs = [value]
    host.program.digital_inputs = [0, 1]
    assert host.program.join(DEADLINE)
    assert host.printed[0] == 'on'
    assert int(host.printed[1]) <= 2


@pytest.mark.parametrize(
    ('task', 'line', 'message'),
    [
        ('\nerror("no way")', 2, 'no way'),
        ('wait(0.01)\nlocal x = nil + 1', 2, 'attempt to perform arithmetic on a nil value'),
        (
            '\nptpJointSpaceAngles(0, 0, 0, 0, 0, 0)',
            2,
            'ptpJointSpaceAngles: not in a task; the main program',
        ),
        ('while true do\nend', 1, 'a task computes without end; it must wait now and then'),
        (
            'local f = coroutine.wrap(function()\nwait(1) end) f()',
            2,
            'wait: a coroutine of a task cannot wait',
        ),
        ('setDigitalOutput(0, 1)', 1, 'index = 0; valid is a whole number'),
    ],
)
def test_a_task_that_fails_ends_the_program_with_its_line(tmp_path: Path, task: str, line: int, message: str):
    host = LuaHost(tmp_path)
    host.write(task, 'task.lua')
    error = host.fails("startTask('task')\nwait(20)")
    assert (error.file, error.line) == ('task.lua', line)
    assert message in error.reason
    assert host.commands == []


def test_a_task_that_only_looks_lets_the_program_go_on(tmp_path: Path):
    (tmp_path / 'task.lua').write_text('while true do setDigitalOutput(2, getDigitalOutput(1)) end')
    run = run_text(tmp_path, "startTask('task') wait(0.1) setDigitalOutput(1, 1) wait(0.1) print('end')")
    assert run.ok, run.error
    (switched, _), (mirrored, _) = outputs(run)
    assert 0.0 <= mirrored - switched <= 0.004 + 1e-9
    assert run.duration == pytest.approx(0.2, abs=0.005)


def test_a_program_whose_task_is_not_there_does_not_start_it(tmp_path: Path):
    LuaHost(tmp_path).refuses("startTask('missing')", 'missing.lua: there is no program')


VALUES = "setPersistent('n', getPersistent('n', 0) + 1) setPersistent('l', {1, 2.5}) setPersistent('s', 'ü')"


def test_values_are_kept_over_runs(tmp_path: Path):
    host = LuaHost(tmp_path)
    assert host.run(VALUES) is None
    assert host.run(f"{VALUES} setPersistent('b', false)") is None
    text = """
        print(getPersistent('n'), getPersistent('s'), getPersistent('b'), getPersistent('l')[2])
        setPersistent('n') print(getPersistent('n'), getPersistent('n', 'none'))"""
    assert host.run(text) is None
    assert host.printed == ['2\tü\tfalse\t2.5', 'nil\tnone']
    assert 'n:' not in (tmp_path / 'test.values.yaml').read_text()


def test_a_simulation_keeps_no_values(tmp_path: Path):
    run = run_text(tmp_path, f"{VALUES} assert(getPersistent('n') == 1)")
    assert run.ok, run.error
    assert not (tmp_path / 'program.values.yaml').exists()


@pytest.mark.parametrize(
    ('text', 'message'),
    [('values: [1]', "has one key 'values'"), ('values: {n: {a: 1}}', "n = {'a': 1}; valid are numbers")],
)
def test_a_file_of_values_that_is_not_valid_is_refused(tmp_path: Path, text: str, message: str):
    (tmp_path / 'test.values.yaml').write_text(text)
    assert message in str(LuaHost(tmp_path).fails("getPersistent('n')"))


def test_a_value_that_cannot_be_kept_is_refused(tmp_path: Path):
    LuaHost(tmp_path).refuses("setPersistent('n', print)", 'value = a function; valid is a finite')
