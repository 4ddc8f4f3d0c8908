"""Breakpoints, steps, what a held program looks like, and subprograms."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any

import pytest

from robots_controller.interpreter.debugger import Variable, breakpoints_by_file, call_stack
from robots_controller.program.run_state import RunState
from robots_core.errors import InvalidInputError, ProgramError

from .lua_host import DEADLINE, LuaHost

PROGRAM = """\
local function seam(n)
  local length = n * 2
  wait(0)
  return length
end
count = 1
local total = seam(3)
count = count + 1
print(total)
"""


class DebugHost(LuaHost):
    """A host that waits for holds."""

    def __init__(self, folder: Path, **options: Any) -> None:
        self.held = threading.Semaphore(0)
        super().__init__(folder, held_changed=self._held_changed, **options)

    def _held_changed(self) -> None:
        if self.program.call_stack.frames:
            self.held.release()

    def wait_for_hold(self) -> tuple[str, int]:
        assert self.held.acquire(timeout=DEADLINE)
        assert self.program.run_state is RunState.PAUSED
        return self.program.hold_reason, self.program.call_stack.frames[0].line

    def open(self, text: str) -> None:
        self.program.open(self.write(text))


def named(variables: tuple[Variable, ...]) -> dict[str, str]:
    return {variable.name: variable.value for variable in variables}


def test_breakpoint_holds_before_its_line_with_stack_and_variables(tmp_path: Path):
    host = DebugHost(tmp_path)
    host.open(PROGRAM)
    host.program.debugger.set_breakpoints('test.lua', [3])
    host.program.run()
    assert host.wait_for_hold() == ('breakpoint', 3)
    stack = host.program.call_stack
    assert str(stack) == "test.lua:3: in function 'seam'\ntest.lua:7: in the program"
    assert named(stack.frames[0].scopes['Locals']) == {'n': '3', 'length': '6'}
    assert named(stack.frames[1].scopes['Locals']) == {'seam': 'function of line 1'}
    assert named(stack.globals) == {'count': '1'}
    assert host.program.line == 3
    assert host.program.resume()
    assert host.program.join(DEADLINE)
    assert host.printed == ['6']
    assert host.program.hold_reason == ''
    assert host.program.call_stack.frames == ()


@pytest.mark.parametrize(
    ('step', 'lines'),
    [
        ('in', [5, 6, 7, 2, 3, 4, 8, 9]),
        ('over', [5, 6, 7, 8, 9]),  # Lua counts the making of a function to its end
    ],
)
def test_steps_go_line_by_line(tmp_path: Path, step: Any, lines: list[int]):
    host = DebugHost(tmp_path)
    host.open(PROGRAM)
    host.program.run(hold=True)
    assert host.wait_for_hold() == ('entry', lines[0])
    for line in lines[1:]:
        assert host.program.step(step)
        assert host.wait_for_hold() == ('step', line)
    assert host.program.step(step)
    assert host.program.join(DEADLINE)
    assert host.program.run_state is RunState.FINISHED


def test_step_out_ends_in_the_caller(tmp_path: Path):
    host = DebugHost(tmp_path)
    host.open(PROGRAM)
    host.program.debugger.set_breakpoints('test.lua', [2])
    host.program.run()
    host.wait_for_hold()
    host.program.step('out')
    assert host.wait_for_hold() == ('step', 8)
    host.program.resume()
    assert host.program.join(DEADLINE)


def test_step_of_a_motion_ends_with_it(tmp_path: Path):
    move = 'ptpJointSpaceAngles(0, 0, 0, 0, 0, 0)'
    host = DebugHost(tmp_path)
    host.open(f'wait(0)\n{move}\nwait(0)\n{move}\nwait(0)')
    host.program.run(hold=True)
    assert host.wait_for_hold() == ('entry', 1)
    for number, line in ((1, 3), (2, 5)):
        host.program.step('motion')
        reason, _ = host.wait_for_hold()
        assert (reason, len(host.commands)) == ('step', number)
        assert host.program.call_stack.frames[0].line == line
    host.program.resume()
    assert host.program.join(DEADLINE)


@pytest.mark.parametrize(
    'text', ['while true do end', 'wait(1000)', 'coroutine.wrap(function() while true do end end)()']
)
def test_paused_program_shows_where_it_is(tmp_path: Path, text: str):
    host = DebugHost(tmp_path)
    host.start(f"local x = 5\nprint('on')\n{text}")
    host.wait_for_print()
    assert host.program.pause()
    assert host.wait_for_hold() == ('pause', 3)
    host.program.stop()
    assert host.program.join(DEADLINE)


def test_breakpoint_may_come_while_the_program_runs(tmp_path: Path):
    host = DebugHost(tmp_path)
    host.start("print('on')\nlocal n = 0\nwhile true do\n n = n + 1\nend")
    host.wait_for_print()
    host.program.debugger.set_breakpoints('test.lua', [4])
    assert host.wait_for_hold() == ('breakpoint', 4)
    host.program.debugger.set_breakpoints('test.lua', [])
    host.program.resume()
    assert not host.program.join(0.05)
    host.program.stop()
    assert host.program.join(DEADLINE)


def test_breakpoint_in_a_coroutine_and_in_pcall(tmp_path: Path):
    host = DebugHost(tmp_path)
    host.open(
        'local f = coroutine.wrap(function()\n wait(0)\nend)\npcall(f)\npcall(function()\n wait(0)\nend)'
    )
    host.program.debugger.set_breakpoints('test.lua', [2, 6])
    host.program.run()
    for line in (2, 6):
        assert host.wait_for_hold() == ('breakpoint', line)
        host.program.resume()
    assert host.program.join(DEADLINE)


def test_held_program_is_stopped(tmp_path: Path):
    host = DebugHost(tmp_path)
    host.open(PROGRAM)
    host.program.run(hold=True)
    host.wait_for_hold()
    host.program.stop()
    assert host.program.join(DEADLINE)
    assert host.program.run_state is RunState.STOPPED
    assert not host.program.step('in')


def test_variables_of_every_type_are_shown_without_their_metamethods(tmp_path: Path):
    host = DebugHost(tmp_path)
    host.open("""\
local bad = setmetatable({a = 1, {true}}, {__index = error, __len = error, __tostring = error})
local s, b, n, f, c = ('x'):rep(1000), true, nil, print, coroutine.create(print)
local x = 1
local x = 2.5
local deep = {{{{{}}}}}
deep[1][1][1][1][1] = deep
wait(0)""")
    host.program.debugger.set_breakpoints('test.lua', [7])
    host.program.run()
    host.wait_for_hold()
    shown = {v.name: v for v in host.program.call_stack.frames[0].scopes['Locals']}
    assert shown['bad'].value == 'table with 1 values'
    assert named(shown['bad'].entries) == {'[1]': 'table with 1 values', 'a': '1'}
    assert shown['s'].value == f"'{'x' * 200}...'"
    assert (shown['b'].value, shown['n'].value, shown['x'].value) == ('true', 'nil', '2.5')
    assert (shown['f'].value, shown['c'].value) == ('function of the robot', 'coroutine')
    host.program.resume()
    assert host.program.join(DEADLINE)
    assert host.finished == [None]


def test_a_breakpoint_holds_once_per_line_wherever_instructions_are_counted(tmp_path: Path):
    host = DebugHost(tmp_path)
    # From where the count begins, one of the lines is at the place where it ends.
    lines = 400
    host.open('\n'.join(['local x = 1', *(lines * ['x = x * x + x // 3 - x'])]))
    host.program.debugger.set_breakpoints('test.lua', range(2, lines + 2))
    host.program.run()
    held = []
    while host.program.run_state is not RunState.FINISHED:
        host.wait_for_hold()
        held.append(host.program.call_stack.frames[0].line)
        host.program.resume()
        if len(held) == lines:
            assert host.program.join(DEADLINE)
    assert held == list(range(2, lines + 2))


def test_deep_recursion_is_paused_and_goes_on(tmp_path: Path):
    host = DebugHost(tmp_path)
    host.start(
        "print('on') local function f(n) if n > 0 then return 1 + f(n - 1) end while true do end end f(1e5)"
    )
    host.wait_for_print()
    host.program.pause()
    host.wait_for_hold()
    assert len(host.program.call_stack.frames) == 20
    host.program.stop()
    assert host.program.join(DEADLINE)


# -- subprograms --------------------------------------------------------------------------------------


def test_subprogram_runs_with_arguments_results_and_the_same_globals(tmp_path: Path):
    host = LuaHost(tmp_path)
    (tmp_path / 'sub').mkdir()
    host.write('local a, b = ... shared = a + b return a * b, "text"', 'sub/pick.lua')
    assert host.run("print(call('sub/pick.lua', 3, 4)) print(shared, call('sub/pick', 1, 1))") is None
    assert host.printed == ['12\ttext', '7\t1\ttext']


def test_error_in_a_subprogram_names_its_file_and_line(tmp_path: Path):
    host = LuaHost(tmp_path)
    host.write('\nwait(-1)', 'part.lua')
    error = host.fails("\n\ncall('part')")
    assert str(error).startswith('part.lua:2: wait: time = -1 s')
    assert error.details['source'] == host.program.source_line(2) == 'wait(-1)'
    assert (host.program.line_file, host.program.line) == ('part.lua', 2)
    host.write('wait(0)', 'part.lua')
    assert host.fails("call('part')\nwait(-1)").file == host.program.line_file == 'test.lua'
    assert error.details['stack'] == 'part.lua:2: in the program\ntest.lua:3: in the program'


@pytest.mark.parametrize(
    ('name', 'message'),
    [
        ('a\\0b', 'has a null character'),
        ('../outside', "'../outside' leads out of the folder of test.lua"),
        ('/etc/passwd', "'/etc/passwd' leads out of the folder of test.lua"),
        ('missing', 'there is no program'),
        ('broken', 'broken.lua:2: '),
    ],
)
def test_subprogram_that_cannot_be_run_is_explained(tmp_path: Path, name: str, message: str):
    host = LuaHost(tmp_path)
    host.write('wait(0)\nthen', 'broken.lua')
    error = host.fails(f"call('{name}')")
    assert str(error).startswith('test.lua:1: call: ')
    assert message in str(error)


def test_subprogram_without_end_of_calls_fails_and_the_next_program_runs(tmp_path: Path):
    host = LuaHost(tmp_path)
    host.write("call('again')", 'again.lua')
    assert 'call: subprograms call each other more than 100 deep' in str(host.fails("call('again')"))
    assert host.run('wait(0)') is None


def test_breakpoint_in_a_subprogram(tmp_path: Path):
    host = DebugHost(tmp_path)
    host.write('local a = ...\nwait(a)', 'pick.lua')
    host.program.debugger.set_breakpoints('pick.lua', [2])
    host.start("call('pick', 0)")
    assert host.wait_for_hold() == ('breakpoint', 2)
    assert (host.program.line_file, host.program.source_line(2)) == ('pick.lua', 'wait(a)')
    assert [(f.chunk, f.line) for f in host.program.call_stack.frames] == [('pick.lua', 2), ('test.lua', 1)]
    host.program.resume()
    assert host.program.join(DEADLINE)


# -- breakpoints and records --------------------------------------------------------------------------


def test_breakpoints_are_file_and_line():
    assert breakpoints_by_file(['', 'a.lua:3', 'a.lua:1', 'sub/b.lua:2']) == {
        'a.lua': {1, 3},
        'sub/b.lua': {2},
    }
    for text in ('a.lua', 'a.lua:0', ':1', 'a.lua:x'):
        with pytest.raises(InvalidInputError, match='no breakpoint'):
            breakpoints_by_file([text])


def test_records_of_nothing_are_no_stack():
    assert call_stack([]).frames == ()


def test_program_cannot_run_twice_while_held(tmp_path: Path):
    host = DebugHost(tmp_path)
    host.open(PROGRAM)
    host.program.run(hold=True)
    host.wait_for_hold()
    with pytest.raises(ProgramError, match='is running'):
        host.program.run()
    host.program.stop()
    assert host.program.join(DEADLINE)
