"""The files for VS Code fit each other, VS Code's rules and the debug adapter."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from robots_controller.program.run_state import RunState

from .debug_editor import DEADLINE, TOKEN, DebuggedProgram

ROOT = Path(__file__).parents[2]
CODE = ROOT / '.vscode'
TYPES = {'string': str, 'boolean': bool, 'number': (int, float)}
# What VS Code adds to the attributes of every debug type (contributes.debuggers in its API reference).
OWN_ATTRIBUTES = {'name': str, 'type': str, 'request': str, 'debugServer': int}


def read(path: Path) -> Any:
    """JSON with comments, as VS Code takes it."""
    return json.loads(re.sub(r'^\s*//.*$', '', path.read_text(), flags=re.MULTILINE))


MANIFEST = read(CODE / 'extensions' / 'robots-lua' / 'package.json')
(DEBUGGER,) = MANIFEST['contributes']['debuggers']
CONFIGURATIONS = read(CODE / 'launch.json')['configurations']


def test_the_extension_is_one_that_vs_code_installs_from_a_workspace():
    assert {'name', 'publisher', 'version', 'engines'} <= MANIFEST.keys()
    assert re.fullmatch(r'[a-z0-9-]+', MANIFEST['name'])
    assert re.fullmatch(r'\d+\.\d+\.\d+', MANIFEST['version'])
    # Extensions in .vscode/extensions came with 1.89; nothing to run means that no `main` is needed.
    assert MANIFEST['engines'] == {'vscode': '^1.89.0'}
    assert 'main' not in MANIFEST
    assert DEBUGGER['languages'] == ['lua']
    assert MANIFEST['contributes']['breakpoints'] == [{'language': 'lua'}]


def test_configurations_are_valid_for_the_debug_type():
    assert read(CODE / 'launch.json')['version'] == '0.2.0'
    assert {one['request'] for one in CONFIGURATIONS} == DEBUGGER['configurationAttributes'].keys()
    for one in CONFIGURATIONS:
        assert one['type'] == DEBUGGER['type']
        schema = DEBUGGER['configurationAttributes'][one['request']]
        assert {'name', 'type', 'request', *schema.get('required', ())} <= one.keys()
        types = OWN_ATTRIBUTES | {key: TYPES[value['type']] for key, value in schema['properties'].items()}
        for key, value in one.items():
            assert isinstance(value, types[key]), key  # type: ignore[arg-type]


def test_everybody_names_the_same_port():
    (port,) = {one['debugServer'] for one in CONFIGURATIONS}
    for file in (CODE / 'launch.json', ROOT / 'docs' / 'how_to' / 'debugging.md'):
        assert re.findall(r'--debug-port (\d+)', file.read_text()) == [str(port)]


def test_the_language_server_gets_the_same_settings_from_either_folder():
    alone, inside = read(ROOT / 'programs' / '.luarc.json'), read(CODE / 'settings.json')
    del alone['$schema']
    folders = alone.pop('workspace.library')
    assert inside.pop('Lua.workspace.library') == [f'programs/{folder}' for folder in folders]
    assert inside == {f'Lua.{key}': value for key, value in alone.items()}
    assert all((ROOT / 'programs' / folder / 'robot_functions.lua').is_file() for folder in folders)


class Session(DebuggedProgram):
    """A program with its server, and VS Code as it begins a session."""

    def begin(self, request: str) -> None:
        (configuration,) = (one for one in CONFIGURATIONS if one['request'] == request)
        inputs = {'${file}': str(self.path), '${input:token}': TOKEN}
        values = {key: inputs.get(str(value), value) for key, value in configuration.items()}
        self.editor.do(
            'initialize',
            clientID='vscode',
            clientName='Visual Studio Code',
            adapterID=DEBUGGER['type'],
            pathFormat='path',
            linesStartAt1=True,
            columnsStartAt1=True,
            supportsVariableType=True,
            supportsRunInTerminalRequest=True,
            locale='en',
        )
        self.editor.do(request, **values, __sessionId='a1')
        self.editor.wait_for('initialized')
        self.editor.do(
            'setBreakpoints',
            source={'name': 'test.lua', 'path': str(self.path)},
            lines=[2],
            breakpoints=[{'line': 2}],
            sourceModified=False,
        )
        self.editor.do('setExceptionBreakpoints', filters=[])
        self.editor.do('configurationDone')


@pytest.fixture
def session(tmp_path: Path) -> Iterator[Session]:
    one = Session(tmp_path, 'local x = 1\nprint(x)\n')
    yield one
    one.close()


def test_launch_runs_the_file_to_its_breakpoint_and_its_end(session: Session):
    session.begin('launch')
    assert session.editor.wait_for('stopped')['reason'] == 'breakpoint'
    session.editor.do('continue', threadId=1)
    assert session.editor.wait_for('output')['output'] == '1\n'
    session.editor.wait_for('terminated')
    session.editor.do('disconnect', restart=False)
    assert session.program.run_state is RunState.FINISHED


def test_attach_finds_the_running_program_and_leaves_it_running(session: Session):
    session.path.write_text('while not getDigitalInput(1) do\n  wait(0)\nend\n')
    session.program.open(session.path)
    session.program.run()
    session.begin('attach')
    assert session.editor.wait_for('stopped')['reason'] == 'breakpoint'
    session.editor.do('disconnect', restart=False)
    assert session.program.run_state is RunState.RUNNING
    session.program.digital_inputs = [1]
    assert session.program.join(DEADLINE)
    assert session.program.run_state is RunState.FINISHED
