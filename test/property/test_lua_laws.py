"""Whatever a program holds: it runs, or a ProgramError says why not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from cell_double import CellDouble
from counted_cases import count_cases
from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS
from robots_controller.interpreter.lua_program import LuaProgram
from robots_controller.program.motions.motion_command import MotionCommand, OutputChange
from robots_controller.program.run_state import RunState
from robots_core.errors import ProgramError

DEADLINE = 120.0  # s
STOP_TIME = 1.0  # s


class LuaHost:
    """Runs programs; every motion ends at once."""

    def __init__(self, folder: Path) -> None:
        self.commands: list[MotionCommand] = []
        self.outputs: list[OutputChange] = []
        cell = CellDouble(command=self._command, output_changed=self.outputs.append)
        self.program = LuaProgram(6, cell)
        self._path = folder / 'test.lua'

    def _command(self, command: MotionCommand) -> None:
        self.commands.append(command)
        self.program.finish_motion()

    def start(self, data: bytes) -> None:
        self.commands.clear()
        self.outputs.clear()
        self._path.write_bytes(data)
        self.program.open(self._path)
        self.program.run()

    def run(self, text: str) -> ProgramError | None:
        self.start(text.encode())
        assert self.program.join(DEADLINE)
        return self.program.error


# Each example writes its own file anew; the folder may be shared.
SHARED_FOLDER = settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60)
# Waiting any time is tested with a stepped clock; what is halted, continues when the test resumes it.
TAKES_TIME = ('wait', 'pulse', 'followReference', 'jog', 'halt')
ROBOT_FUNCTIONS = sorted(name for name in LUA_FUNCTIONS if not name.startswith(TAKES_TIME))

LITERALS = st.one_of(
    st.floats(allow_nan=False, allow_infinity=False).map(repr),
    st.integers(-(2**63), 2**63 - 1).map(str),
    st.integers(-2, 40).map(str),
    st.sampled_from(
        [
            'nil',
            'true',
            'false',
            '0/0',
            '1/0',
            '-1/0',
            '{}',
            '{1, 2}',
            'print',
            "'1'",
            '""',
            '-0.0',
            'coroutine',
        ]
    ),
    st.text(max_size=5).map(lambda text: '"' + ''.join(f'\\u{{{ord(c):x}}}' for c in text) + '"'),
)


@SHARED_FOLDER
@given(arguments=st.lists(LITERALS, max_size=8), table=st.booleans())
def test_any_arguments_run_or_are_explained(
    tmp_path: Path,
    arguments: list[str],
    table: bool,  # noqa: FBT001
):
    host = LuaHost(tmp_path)
    listed = ', '.join(arguments)
    for function in ROBOT_FUNCTIONS:
        count_cases('Lua')
        error = host.run(f'{function}({{{listed}}})' if table else f'{function}({listed})')
        if error is None:
            assert host.program.run_state is RunState.FINISHED, function
            for command in host.commands:
                targets = [command.q] if command.pose is None else [command.pose.r, command.pose.T]
                assert all(np.isfinite(target).all() for target in targets), function
        else:
            assert error.reason.startswith(f'{function}: ')
            assert error.line == 1, function
            assert host.commands == [], function
            assert host.outputs == [], function


@SHARED_FOLDER
@given(data=st.binary(max_size=200))
def test_random_bytes_run_or_are_refused(tmp_path: Path, data: bytes):
    _run_or_refuse(tmp_path, data)


WORDS = (
    *('if', 'then', 'else', 'end', 'while', 'do', 'for', 'in', 'repeat', 'until', 'function', 'return'),
    *('local', 'goto', 'break', 'and', 'or', 'not', 'nil', 'true', 'false', '=', '==', '~=', '<', '>', '+'),
    *('-', '*', '/', '//', '%', '^', '#', '..', '...', '(', ')', '{', '}', '[', ']', ';', ':', ',', '.'),
    *('x', 'y', 'print', 'pcall', 'error', 'string.rep', 'coroutine.wrap', 'setmetatable', '1', '2', '3.5'),
    *("'a'", '--', 'wait(-1)', '\n'),
)


@SHARED_FOLDER
@given(words=st.lists(st.sampled_from(WORDS), max_size=25))
def test_random_words_of_lua_run_or_are_refused(tmp_path: Path, words: list[str]):
    _run_or_refuse(tmp_path, ' '.join(words).encode())


@SHARED_FOLDER
@given(values=st.lists(st.floats(-720.0, 720.0), min_size=6, max_size=6))
def test_degrees_become_radians(tmp_path: Path, values: list[float]):
    host = LuaHost(tmp_path)
    assert host.run(f'ptpJointSpaceAngles({", ".join(map(repr, values))})') is None
    np.testing.assert_array_equal(host.commands[0].q, np.radians(values))


def _run_or_refuse(folder: Path, data: bytes) -> None:
    count_cases('Lua')
    host = LuaHost(folder)
    try:
        host.start(data)
    except ProgramError as error:
        refusal = error
    else:
        refusal = None
    if refusal is not None:
        assert refusal.file == 'test.lua'
        assert host.program.run_state is RunState.IDLE
        return
    if not host.program.join(STOP_TIME):  # a random program may loop for ever; then it can be stopped
        host.program.stop()
        assert host.program.join(DEADLINE)
        assert host.program.run_state is RunState.STOPPED
        return
    failed = host.program.run_state is RunState.FAILED
    assert failed or host.program.run_state is RunState.FINISHED
    assert failed == isinstance(host.program.error, ProgramError)
