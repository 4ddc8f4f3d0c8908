"""Whatever a program is: the node answers every service in time, and the next program runs."""

from __future__ import annotations

import os
import random
import string
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters, SetParameters
from rclpy.parameter import Parameter
from std_srvs.srv import SetBool, Trigger

from bench import Bench
from counted_cases import count_cases
from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS
from robots_controller.nodes.lua_program_node import LuaProgramNode

ROBOT = 'kuka_kr210_r2700'
RUN_TIME = 0.1  # s that a program that does not end has before it is stopped
# Deadlines for a slow and busy machine: what hangs takes for ever.
END_TIME = 240.0  # s from the stop to the end
FAIL_TIME = 240.0  # s until a program has used up its memory
SEED = int(os.environ.get('FUZZ_SEED', '20240607'))  # the same programs in every run

# Each continues until it is stopped.
ENDLESS = {
    'deep recursion in pcall': 'local function f() pcall(f) f() end while true do pcall(f) end',
    'huge strings in pcall': "while true do pcall(string.rep, 'x', 1 << 40) pcall(string.rep, 'x', 5e7) end",
    'huge format': "while true do pcall(string.format, ('%s'):rep(50), table.unpack({}, 1, 50)) end",
    'catastrophic pattern': "return ('a'):rep(10000):find(('.-'):rep(30) .. 'b')",
    'catastrophic gsub': "return ('a'):rep(200000):gsub('(a*)*b', '%1')",
    'balanced pattern': "return ('('):rep(1e6):find('%b()%b()%b()x')",
    'coroutine bomb': """
        local function bomb() while true do coroutine.wrap(bomb)() end end
        while true do pcall(bomb) end""",
    'sort with a mad order': 'local t = {} for i = 1, 1e6 do t[i] = i end table.sort(t, print)',
    'concat of a million': "local t = {} for i = 1, 1e6 do t[i] = 'x' end while true do table.concat(t) end",
    'unpack in a loop': 'local t = {} while true do pcall(table.unpack, t, 1, 1e6) end',
    'prints without end': "while true do print(('x'):rep(1000)) end",
    'huge print': "print(('x'):rep(2e7)) while true do end",
    'outputs without end': 'while true do setDigitalOutput(1, 1) setDigitalOutput(1, 0) end',
    'handlers without end': 'while true do onDigitalInput(1, true, function() end) end',
    'pulses without end': 'while true do for i = 1, 32 do pulseDigitalOutput(i, 0.001) end end',
    'large table as argument': """
        local t = {} for i = 1, 1e6 do t[i] = i end
        while true do pcall(ptpCartesianSpace, t) end""",
    'every function with huge strings': """
        local s, all = ('\\xff'):rep(2e7), {}
        for _, f in pairs(_G) do if type(f) == 'function' then all[#all + 1] = f end end
        while true do
          for _, f in ipairs(all) do pcall(f, s, s) pcall(f, {[s] = 1}) pcall(f, 1, 1, s) end
        end""",
    'prints that are no text': "local s = ('\\xff'):rep(2e7) while true do print(s) end",
    'table that holds itself': 'local t = {} t[1] = t t.t = t while true do pcall(setTool, t) end',
    'error in tostring': 'error(setmetatable({}, {__tostring = function() while true do end end}))',
    'string metamethods': "while true do pcall(function() return ('x') + 1 end) end",
    'long integer loops': 'for i = math.mininteger, math.maxinteger do end',
    'goto': '::again:: goto again',
    'closing forever': """
        local meta = {__close = function() while true do end end}
        while true do local x <close> = setmetatable({}, meta) end""",
    'metamethod chains': """
        local t = setmetatable({}, {})
        for i = 1, 1e5 do t = setmetatable({}, {__index = t}) end
        while true do pcall(function() return t.x end) end""",
    'collecting garbage': 'while true do local t = {} for i = 1, 1e5 do t[i] = {i} end end',
}

# Each fails by itself, for this reason.
FAILING = {
    'deep recursion': ('local function f(n) return 1 + f(n + 1) end f(0)', 'stack overflow'),
    'huge string': ("local s = 'x' while true do s = s .. s end", 'not enough memory'),
    'huge table': ('local t = {} while true do t[#t + 1] = {} end', 'not enough memory'),
    'coroutines kept': (
        'local t = {} while true do t[#t + 1] = coroutine.create(print) end',
        'not enough memory',
    ),
    'nested tables as arguments': (
        'local t = {} for i = 1, 1e5 do t = {t} end ptpCartesianSpace(t)',
        'ptpCartesianSpace: a table is nested too deeply',
    ),
    'subprogram that calls itself': ("call('test')", 'call: subprograms call each other more than 100 deep'),
    'print of half the memory': ("print(('x'):rep(5e7))", 'not enough memory'),
    'error of half the memory': ("error(('x'):rep(5e7))", 'not enough memory'),
    'long error': ("error(('x'):rep(2e7), 0)", 'xxxxxxxxxx'),
    'long error that is no text': ("error(('\\xff'):rep(2e7), 0)", '\ufffd'),
    'long name': (f'local {"f" * 400_000} {"f" * 400_000}()', 'attempt to call a nil value'),
}


def set_parameter(name: str, value: bool) -> SetParameters.Request:  # noqa: FBT001
    return SetParameters.Request(parameters=[Parameter(name, value=value).to_parameter_msg()])


REQUESTS: dict[str, Any] = {
    **dict.fromkeys(
        ('open', 'run', 'pause', 'resume', 'step', 'stop', 'reset', 'get_command_state', 'get_call_stack'),
        Trigger.Request(),
    ),
    'get_io': GetParameters.Request(names=['digital_input.1', 'analog_output.1']),
    'set_io': set_parameter('digital_input.1', True),
    'list_io': ListParameters.Request(),
    'describe_io': DescribeParameters.Request(names=['digital_output.1']),
    'digital_input_1/set': SetBool.Request(data=False),
}
TYPES = {
    Trigger.Request: Trigger,
    GetParameters.Request: GetParameters,
    SetParameters.Request: SetParameters,
    ListParameters.Request: ListParameters,
    DescribeParameters.Request: DescribeParameters,
    SetBool.Request: SetBool,
}
WATCHING = ('get_command_state', 'get_io', 'set_io', 'list_io', 'describe_io', 'digital_input_1/set')


class ServicesBench(Bench):
    """The node under test, of which every service is called while a program runs."""

    def __init__(self, runner: Any, folder: Path) -> None:
        super().__init__(runner, 'caller')
        self.path = folder / 'test.lua'
        self.node = self.start_node(
            LuaProgramNode,
            robot_model=ROBOT,
            program=str(self.path),
            planner_timeout=0.1,
            channel_services=True,
        )

    def ask(self, name: str) -> Any:
        request = REQUESTS[name]
        return self.call(f'lua_program_node/{name}', request, TYPES[type(request)])

    def state(self) -> str:
        return str(self.node._program.run_state)

    @property
    def error(self) -> str:
        return str(self.node._program.error)

    def run_program(self, data: bytes, run_time: float = RUN_TIME) -> str:
        """Open and run a program, and ask for everything meanwhile; its state then, '' if it is not Lua."""
        self.path.write_bytes(data)
        if not self.ask('open').success:
            return ''
        assert self.ask('run').success
        end = time.monotonic() + run_time
        while self.state() == 'RUNNING' and time.monotonic() < end:
            for name in WATCHING:
                self.ask(name)
        return self.state()

    def end_program(self) -> None:
        """Hold the program, inspect it, let it continue, and stop it."""
        if self.ask('pause').success:
            self.ask('get_call_stack')
            self.ask('step')
            self.ask('resume')
        self.ask('stop')
        end = time.monotonic() + END_TIME
        while self.state() in ('RUNNING', 'PAUSED'):
            self.ask('get_command_state')
            assert time.monotonic() < end, 'the program does not end'
        assert 'internal error' not in self.error
        assert self.ask('reset').success

    def try_program(self, data: bytes) -> bool:
        """Run a program and end it; whether it is Lua."""
        count_cases('Lua')
        state = self.run_program(data)
        if state:
            self.end_program()
        return bool(state)

    def next_program_runs(self) -> None:
        self.path.write_text('setDigitalOutput(1, 1) setDigitalOutput(1, 0)')
        assert self.ask('open').success
        assert self.ask('run').success
        assert self.node._program.join(END_TIME)
        assert self.state() == 'FINISHED'


@pytest.fixture
def bench(ros_nodes: Any, tmp_path: Path) -> ServicesBench:
    return ServicesBench(ros_nodes, tmp_path)


@contextmanager
def about(kind: str) -> Iterator[None]:
    try:
        yield
    except AssertionError as error:
        raise AssertionError(f'{kind}: {error}') from error


def test_programs_without_end(bench: ServicesBench):
    for kind, text in ENDLESS.items():
        with about(kind):
            assert bench.run_program(text.encode()) == 'RUNNING', bench.error
            bench.end_program()
            assert bench.error == 'None'
            bench.next_program_runs()


def test_programs_that_go_too_far(bench: ServicesBench):
    for kind, (text, reason) in FAILING.items():
        with about(kind):
            assert bench.run_program(text.encode(), run_time=FAIL_TIME) == 'FAILED'
            assert reason in bench.error[:200]
            bench.next_program_runs()


def test_random_bytes(bench: ServicesBench):
    rng = random.Random(SEED)  # noqa: S311  # the same programs in every run
    ran = [bench.try_program(rng.randbytes(size * 3)) for size in range(60)]
    assert sum(ran) == 1  # nothing at all is a program
    ran = [bench.try_program(''.join(rng.choices(string.printable, k=60)).encode()) for _ in range(30)]
    assert not any(ran)
    bench.next_program_runs()


def random_program(rng: random.Random, depth: int = 0) -> str:
    """Random statements that Lua mostly accepts, with our functions and much nonsense."""
    names = [
        *LUA_FUNCTIONS,
        'pcall',
        'error',
        'tostring',
        'string.rep',
        'string.find',
        'table.unpack',
        'x',
        'y',
    ]
    values = [
        *('0', '1', '-1', '1e300', '0/0', "'text'", "('a'):rep(1000)", 'nil', 'true', '{}', '{on_path = {}}'),
        *('{1, 2, 3, 4, 5, 6}', '{blend = 0.1}', 'print', 'x', 'y', 'function() return x end', '...'),
    ]

    def call() -> str:
        return f'{rng.choice(names)}({", ".join(rng.choices(values, k=rng.randint(0, 7)))})'

    lines = []
    for _ in range(rng.randint(1, 5)):
        kind = rng.randint(0, 9) if depth < 3 else 0
        inner = '' if kind == 0 else random_program(rng, depth + 1)
        lines.append(
            [
                f'pcall(function(...) {call()} end)',
                f'pcall(function(...) {inner} end)',
                f'while {rng.choice(values[:12])} do {inner} if x then break end end',
                f'for i = 1, {rng.choice(["3", "1e9"])} do {inner} end',
                f'x = {rng.choice(values[:12])} {inner}',
                f'local y = {rng.choice(values[:12])} {inner}',
                f'coroutine.wrap(function(...) {inner} end)(1)',
                f'if {call()} then {inner} end',
                f'onDigitalInput({rng.randint(1, 3)}, true, function(...) {inner} end)',
                f'y = select(2, pcall(function(...) return {call()} end))',
            ][kind]
        )
    return '\n'.join(lines)


def test_random_programs(bench: ServicesBench):
    rng = random.Random(SEED)  # noqa: S311  # the same programs in every run
    ran = [bench.try_program(random_program(rng).encode()) for _ in range(40)]
    assert all(ran)
    bench.next_program_runs()
