"""The debug adapter, driven over its socket as an editor does."""

from __future__ import annotations

import contextlib
import io
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cell_double import CellDouble
from robots_controller.editor.debug_adapter import DebugAdapter, read_messages
from robots_controller.editor.debug_adapter_server import DebugAdapterServer
from robots_controller.interpreter.lua_program import LuaProgram
from robots_controller.program.run_state import RunState
from robots_core.errors import InvalidInputError, RobotsError

from .debug_editor import DEADLINE, TOKEN, DebuggedProgram, Editor

PROGRAM = """\
local function seam(n)
  local length = n * 2
  wait(0)
  return length
end

-- the seams
local list = {10, {deep = 'x'}}
local total = seam(3)
print(total)
"""


class Setup(DebuggedProgram):
    """A program, its server, and an editor."""

    def launch(self, *lines: int, **options: object) -> None:
        editor = self.editor
        assert editor.do('initialize', adapterID='robots')['supportsConfigurationDoneRequest']
        editor.do('launch', program=str(self.path), token=TOKEN, **options)
        editor.wait_for('initialized')
        answer = editor.do(
            'setBreakpoints', source={'path': str(self.path)}, breakpoints=[{'line': line} for line in lines]
        )
        assert all(item['verified'] for item in answer['breakpoints'])
        editor.do('configurationDone')


@pytest.fixture
def setup(tmp_path: Path) -> Iterator[Setup]:
    one = Setup(tmp_path, PROGRAM)
    yield one
    one.close()


def variables(editor: Editor, reference: int) -> dict[str, dict[str, Any]]:
    return {item['name']: item for item in editor.do('variables', variablesReference=reference)['variables']}


def test_session_of_an_editor(setup: Setup):
    editor = setup.editor
    setup.launch(3)
    stopped = editor.wait_for('stopped')
    assert (stopped['reason'], stopped['allThreadsStopped']) == ('breakpoint', True)
    (thread,) = editor.do('threads')['threads']
    assert thread == {'id': stopped['threadId'], 'name': 'test.lua'}

    frames = editor.do('stackTrace', threadId=thread['id'])['stackFrames']
    assert [(frame['line'], frame['name']) for frame in frames] == [
        (3, "in function 'seam'"),
        (9, 'in the program'),
    ]
    assert frames[0]['source']['path'] == str(setup.path)

    inner, outer = (
        {scope['name']: scope for scope in editor.do('scopes', frameId=frame['id'])['scopes']}
        for frame in frames
    )
    local = variables(editor, inner['Locals']['variablesReference'])
    assert {name: item['value'] for name, item in local.items()} == {'n': '3', 'length': '6'}
    listed = variables(editor, outer['Locals']['variablesReference'])['list']
    entries = variables(editor, listed['variablesReference'])
    assert entries['[1]']['value'] == '10'
    assert variables(editor, entries['[2]']['variablesReference'])['deep']['value'] == "'x'"
    assert editor.do('evaluate', expression='length', frameId=frames[0]['id'])['result'] == '6'

    editor.do('next', threadId=thread['id'])
    assert editor.wait_for('stopped')['reason'] == 'step'
    assert editor.do('stackTrace', threadId=1)['stackFrames'][0]['line'] == 4
    editor.do('stepOut', threadId=thread['id'])
    assert editor.wait_for('stopped')['reason'] == 'step'
    assert editor.do('stackTrace', threadId=1)['stackFrames'][0]['line'] == 10
    editor.do('continue', threadId=thread['id'])
    assert editor.wait_for('output') == {'category': 'stdout', 'output': '6\n', 'line': 10}
    assert editor.wait_for('exited') == {'exitCode': 0}
    editor.wait_for('terminated')
    editor.do('disconnect')
    assert setup.program.run_state is RunState.FINISHED


def test_stop_on_entry_and_step_in(setup: Setup):
    editor = setup.editor
    setup.launch(stopOnEntry=True)
    assert editor.wait_for('stopped')['reason'] == 'entry'
    lines = []
    for _ in range(3):
        editor.do('stepIn', threadId=1)
        editor.wait_for('stopped')
        lines.append(editor.do('stackTrace', threadId=1)['stackFrames'][0]['line'])
    assert lines == [8, 9, 2]


def test_breakpoint_on_a_line_without_code_moves_to_the_next(setup: Setup):
    editor = setup.editor
    editor.do('attach', token=TOKEN)
    answer = editor.do(
        'setBreakpoints', source={'path': str(setup.path)}, breakpoints=[{'line': 6}, {'line': 99}]
    )
    assert [(item['line'], item['verified']) for item in answer['breakpoints']] == [(8, True), (99, False)]


def test_pause_of_an_endless_program_and_disconnect_stops_it(setup: Setup):
    setup.path.write_text("print('on')\nwhile true do end")
    editor = setup.editor
    setup.launch()
    editor.wait_for('output')
    editor.do('pause', threadId=1)
    assert editor.wait_for('stopped')['reason'] == 'pause'
    editor.do('disconnect')
    assert setup.program.join(DEADLINE)
    assert setup.program.run_state is RunState.STOPPED


def test_a_held_program_stays_held_when_its_editor_vanishes_and_the_next_one_attaches(setup: Setup):
    setup.launch(3)
    setup.editor.wait_for('stopped')
    setup.editor.close()
    editor = setup.editor = Editor(setup.server.port)
    editor.do('initialize')
    editor.do('attach', token=TOKEN)
    editor.do('configurationDone')
    assert editor.wait_for('stopped')['reason'] == 'breakpoint'
    assert setup.program.run_state is RunState.PAUSED
    editor.do('disconnect')  # that held nothing
    assert setup.program.run_state is RunState.PAUSED


def test_disconnecting_lets_go_what_the_editor_held_and_nothing_else(setup: Setup):
    setup.path.write_text('while true do end')
    setup.program.open(setup.path)
    setup.program.run()
    editor = setup.editor
    editor.do('attach', token=TOKEN)
    editor.do('pause')
    editor.do('disconnect')
    assert setup.program.run_state is RunState.RUNNING
    setup.program.pause()
    editor = Editor(setup.server.port)
    editor.do('attach', token=TOKEN)
    editor.do('disconnect')
    assert setup.program.run_state is RunState.PAUSED
    editor.close()


@pytest.mark.parametrize(
    'command', ['threads', 'setBreakpoints', 'configurationDone', 'continue', 'pause', 'terminate']
)
def test_nothing_is_done_without_the_token(setup: Setup, command: str):
    setup.editor.do('initialize')
    response = setup.editor.ask(command)
    assert not response['success']
    assert response['message'] == f'{command} comes after launch or attach with the token'


@pytest.mark.parametrize('command', ['launch', 'attach'])
@pytest.mark.parametrize('arguments', [{}, {'token': ''}, {'token': TOKEN[:-1]}, {'token': [TOKEN]}])
def test_a_wrong_token_ends_the_session(setup: Setup, command: str, arguments: dict[str, object]):
    response = setup.editor.ask(command, program=str(setup.path), **arguments)
    assert 'the token is wrong' in response['message']
    assert setup.editor.stream.read() == b''
    assert setup.program.path is None


def test_programs_elsewhere_are_not_launched(setup: Setup, tmp_path_factory: pytest.TempPathFactory):
    other = tmp_path_factory.mktemp('elsewhere') / 'test.lua'
    other.write_text(PROGRAM)
    response = setup.editor.ask('launch', program=str(other), token=TOKEN)
    assert response['message'] == f'{other} is not below {setup.path.parent}, where programs are launched'
    (setup.path.parent / 'link.lua').symlink_to(other)
    response = setup.editor.ask('launch', program=str(setup.path.parent / 'link.lua'), token=TOKEN)
    assert not response['success']
    assert setup.program.path is None


def test_failure_of_the_program_is_reported(setup: Setup):
    setup.path.write_text('wait(-1)')
    setup.launch()
    output = setup.editor.wait_for('output')
    assert output['category'] == 'stderr'
    assert output['output'].startswith('test.lua:1: wait: time = -1 s')
    assert setup.editor.wait_for('exited') == {'exitCode': 1}


@pytest.mark.parametrize(
    ('command', 'arguments', 'message'),
    [
        ('launch', {'program': 'missing.lua'}, 'missing.lua'),
        ('launch', {}, 'program'),
        ('teleport', {}, "'teleport' is not known here"),
        ('continue', {'threadId': 1}, 'not held'),
        ('pause', {'threadId': 1}, 'no program is running'),
        ('scopes', {'frameId': 7}, 'index out of range'),
        ('variables', {'variablesReference': 3}, 'index out of range'),
    ],
)
def test_wrong_requests_are_answered_and_the_session_goes_on(
    setup: Setup, command: str, arguments: dict[str, object], message: str
):
    setup.editor.do('attach', token=TOKEN)
    response = setup.editor.ask(command, **arguments, token=TOKEN)
    assert not response['success']
    assert message in response['message']
    assert setup.editor.do('threads')


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8) | st.just('/dev/zero'),
    lambda values: (
        st.lists(values, max_size=3)
        | st.dictionaries(
            st.sampled_from(('source', 'path', 'line', 'breakpoints', 'frameId', 'startFrame', 'expression')),
            values,
            max_size=4,
        )
    ),
    max_leaves=6,
)
HELD = ('stackTrace', 'scopes', 'variables', 'evaluate', 'continue', 'next', 'stepOut')
COMMANDS = ('setBreakpoints', 'pause', 'threads', 'initialize', *HELD)


@given(commands=st.lists(st.tuples(st.sampled_from(COMMANDS) | st.text(max_size=9), JSON), max_size=20))
def test_no_request_ends_a_session(tmp_path_factory: pytest.TempPathFactory, commands: list[tuple[str, Any]]):
    sent: list[dict[str, Any]] = []
    program = LuaProgram(6, CellDouble())
    folder = tmp_path_factory.getbasetemp()
    adapter = DebugAdapter(program, sent.append, token=TOKEN, folder=folder)
    adapter.handle({'command': 'attach', 'arguments': {'token': TOKEN}})
    for number, (command, arguments) in enumerate(commands, 1):
        adapter.admitted = True
        adapter.handle({'seq': number, 'command': command, 'arguments': arguments})
        (answer,) = (one for one in sent if one['type'] == 'response' and one['request_seq'] == number)
        json.dumps(answer)
        assert answer['success'] or answer['message']


NONSENSE = [
    b'POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\n\r\n{}',
    b'GET / HTTP/1.1\r\n\r\n',
    b'Content-Length: 200000\r\n\r\n' + 200_000 * b'[',
    b'Content-Length: 99999999\r\n\r\n',
    b'\r\n\r\n',
    *(b'Content-Length: %d\r\n\r\n%b' % (len(data), data) for data in (b'{', b'[]', b'{"type": 1}', b'\xff')),
]


@pytest.mark.parametrize('data', NONSENSE, ids=lambda data: data[:30])
def test_nonsense_ends_the_connection_and_the_next_editor_is_served(setup: Setup, data: bytes):
    setup.editor.socket.sendall(data)
    assert setup.editor.stream.read() == b''
    editor = setup.editor = Editor(setup.server.port)
    editor.do('initialize')


@given(data=st.binary(max_size=200))
def test_any_bytes_are_messages_or_an_error(data: bytes):
    for prefix in (b'', b'Content-Length: %d\r\n\r\n' % len(data)):
        with contextlib.suppress(InvalidInputError):
            assert all(isinstance(message, dict) for message in read_messages(io.BytesIO(prefix + data)))


def test_port_that_is_taken_is_an_error(setup: Setup):
    with pytest.raises(RobotsError, match=f'port {setup.server.port} is not free'):
        DebugAdapterServer(setup.program, token=TOKEN, folder=setup.path.parent, port=setup.server.port)
