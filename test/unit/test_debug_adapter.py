"""The debug adapter, driven over its socket as an editor does."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from robots_controller.editor.debug_adapter_server import DebugAdapterServer
from robots_controller.program.program_state import RunState
from robots_core.errors import RobotsError

from .debug_editor import DEADLINE, DebuggedProgram, Editor

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
        editor.wait_for('initialized')
        editor.do('launch', program=str(self.path), **options)
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
    editor.do('initialize')
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


def test_editor_that_vanishes_leaves_a_program_that_goes_on_and_the_next_one_attaches(setup: Setup):
    setup.launch(3)
    setup.editor.wait_for('stopped')
    setup.editor.close()
    assert setup.program.join(DEADLINE)
    assert setup.program.run_state is RunState.FINISHED
    setup.program.run(hold=True)
    editor = setup.editor = Editor(setup.server.port)
    editor.do('initialize')
    editor.do('attach')
    editor.do('configurationDone')
    assert editor.wait_for('stopped')['reason'] == 'entry'
    editor.do('disconnect')
    assert setup.program.join(DEADLINE)
    assert setup.program.run_state is RunState.FINISHED


def test_failure_of_the_program_is_told(setup: Setup):
    setup.path.write_text('wait(-1)')
    setup.launch()
    output = setup.editor.wait_for('output')
    assert output['category'] == 'stderr'
    assert output['output'].startswith('test.lua:1: wait: time = -1 s')
    assert setup.editor.wait_for('exited') == {'exitCode': 1}


@pytest.mark.parametrize(
    ('command', 'arguments', 'message'),
    [
        ('launch', {'program': 'missing.lua'}, 'there is no program missing.lua'),
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
    response = setup.editor.ask(command, **arguments)
    assert not response['success']
    assert message in response['message']
    assert setup.editor.do('threads')


@pytest.mark.parametrize('data', [b'{', b'[]', b'{"type": "event"}', b'\xff'])
def test_nonsense_ends_the_connection_and_the_next_editor_is_served(setup: Setup, data: bytes):
    setup.editor.send_raw(data)
    assert setup.editor.stream.read() == b''
    editor = setup.editor = Editor(setup.server.port)
    editor.do('initialize')


def test_port_that_is_taken_is_an_error(setup: Setup):
    with pytest.raises(RobotsError, match=f'port {setup.server.port} is not free'):
        DebugAdapterServer(setup.program, port=setup.server.port)
