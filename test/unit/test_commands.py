"""The commands: one table, options that are checked at once, and the same exit codes everywhere."""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
from importlib.metadata import entry_points
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from robots_controller.commands.command_table import TOOLS
from robots_controller.commands.error_catalogue import error_catalogue
from robots_controller.commands.robot_commands import SMALL, list_robots
from robots_controller.commands.robot_picture import BRAILLE, robot_picture
from robots_controller.commands.robots import COMMANDS, run
from robots_controller.terminal_table import TerminalTable
from robots_core.errors import OptionError
from robots_core.exit_codes import ExitCode
from robots_core.robot_choice import load_robot_model

ROOT = Path(__file__).parents[2]
PROGRAM = str(ROOT / 'programs' / 'welding.lua')
TOO_LONG = 5000 * 'a'  # for any file system
URDF = """<robot name="two"><link name="a"/><link name="b"/><link name="c"/>
<joint name="j1" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" velocity="1" effort="0"/></joint>
<joint name="j2" type="prismatic"><parent link="b"/><child link="c"/><origin xyz="0.5 0 0"/>
<axis xyz="1 0 0"/>
<limit lower="0" upper="0.3" velocity="1" effort="10"/></joint></robot>
"""


def test_every_tool_has_its_executable() -> None:
    installed = {
        point.name: point.load()
        for point in entry_points(group='console_scripts')
        if point.value.startswith('robots_controller.commands.')
    }
    assert installed.pop('robots').__module__ == 'robots_controller.commands.robots'
    assert installed == {command.name: command.main for command in TOOLS}


@pytest.mark.parametrize(
    ('words', 'wanted'),
    [
        (['cell', '--rate', '-5'], "--rate: '-5' is not valid; valid is a number above 0, in Hz"),
        (['cell', '--port', '99999'], 'valid is a whole number in 0..65535'),
        (['cell', '--namespace', 'my robot'], 'for example /my_robot'),
        (['cell', '--watchdog', 'nan'], 'valid is a number of at least 0, in s'),
        (['cell', '--scene', 'no.yaml'], "--scene: scene 'no.yaml' not found"),
        (['cell', '--record', PROGRAM], 'is a file'),
        (['cell', '--drive', 'idela'], "invalid choice: 'idela'"),
        (['cell', '--payload', '-5,0,0,0.1'], '--payload: '),
        (['simulate', PROGRAM, '--report', '/nope/x.html'], "cannot be written: no folder '/nope'"),
        (['simulate', PROGRAM, '--report', '/'], "'/' is a folder"),
        (['simulate', PROGRAM, '--bag', '/'], "'/' exists"),
        (['simulate', PROGRAM, '--patience', '0'], 'a number above 0, in s'),
        (['simulate', PROGRAM, '--drvie', 'ideal'], "did you mean '--drive'?"),
        (['simulate'], 'required: program'),
        (['simulate', TOO_LONG], 'not found; programs are Lua files'),
        (['simulate', PROGRAM, '--scene', TOO_LONG], 'not found'),
        (['simulate', PROGRAM, '--bag', TOO_LONG], 'cannot be used: File name too long'),
        (['report', TOO_LONG], 'does not exist; a bag is a folder'),
        (['check_program', PROGRAM, '--combinations', '0'], 'a whole number of at least 1'),
        (['report', 'no_bag'], "'no_bag' does not exist; a bag is a folder"),
        (['report', '.', '-o', '/nope/x.html'], "no folder '/nope'"),
        (['study', PROGRAM, '--workers', 'two'], 'a whole number of at least 0'),
        (['check_bag', '.'], 'required: --against'),
        (['replay_bag', '.', '--rate', '0'], 'a number above 0'),
        (['show', 'ur5'], "did you mean 'ur5e'?"),
        (['simulat'], "there is no command 'simulat'; did you mean 'simulate'?"),
    ],
)
def test_wrong_options_are_refused_at_once(
    words: list[str],
    wanted: str,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(words) == ExitCode.BAD_INPUT
    out, errors = capsys.readouterr()
    assert out == ''
    assert errors.startswith('error: ')
    assert errors.count('\n') == 1
    assert wanted in errors
    assert not list(tmp_path.iterdir())


def completed(line: str) -> list[str]:
    environment = os.environ | {
        '_ARGCOMPLETE': '1',
        '_ARGCOMPLETE_IFS': '\n',
        'COMP_LINE': line,
        'COMP_POINT': str(len(line)),
        '_ARGCOMPLETE_STDOUT_FILENAME': '/dev/stdout',
    }
    program = 'from robots_controller.commands.robots import main; main()'
    shown = subprocess.run(
        [sys.executable, '-c', program], env=environment, capture_output=True, text=True, check=True
    )
    return [word.strip() for word in shown.stdout.split('\n')]


def test_a_shell_completes_commands_options_and_robots() -> None:
    assert set(completed('robots s')) == {'show', 'simulate', 'study'}
    assert completed('robots simulate x --dri') == ['--drive']
    assert completed('robots show kuka_lbr') == ['kuka_lbr_iiwa14']


def test_completing_loads_nothing_that_takes_long() -> None:
    program = (
        'import sys; from robots_controller.commands.robots import _parser; _parser();'
        "print(*{'numpy', 'rich', 'rclpy', 'numba'} & set(sys.modules))"
    )
    loaded = subprocess.run([sys.executable, '-P', '-c', program], capture_output=True, text=True, check=True)
    assert loaded.stdout.split() == []


def test_robots_are_shown_and_checked(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / 'two.urdf'
    file.write_text(URDF)
    assert run(['check', str(file)]) == ExitCode.OK
    shown = capsys.readouterr().out
    assert 'two, 2 axes' in shown
    assert 'effort' in shown
    assert 'usable, with 1 substitution; option strict=true refuses them' in shown
    assert run(['check', f'{file}?strict=true']) == ExitCode.BAD_INPUT
    assert run(['check', 'two']) == ExitCode.BAD_INPUT
    assert 'robots show takes the names of installed robots' in capsys.readouterr().err
    assert run(['show', f'urdf:{file}', '--json']) == ExitCode.OK
    facts = json.loads(capsys.readouterr().out)
    assert (facts['axes'], facts['payload'], facts['closed_form']) == (2, None, False)
    assert facts['reach'] == pytest.approx(0.8)


def test_a_list_in_a_terminal_has_pictures_and_in_a_pipe_it_has_none() -> None:
    def shown(*, terminal: bool) -> str:
        file = StringIO()
        console = Console(file=file, force_terminal=terminal, width=80, color_system=None)
        assert list_robots(argparse.Namespace(json=False), console) == ExitCode.OK
        return file.getvalue()

    text = shown(terminal=True)
    assert robot_picture(load_robot_model('ur5e'), *SMALL).splitlines()[0] in text
    assert max(map(len, text.splitlines())) <= 80
    assert not any(BRAILLE <= ord(character) < BRAILLE + 256 for character in shown(terminal=False))


@pytest.mark.parametrize('width', [40, 60, 80, 140])
def test_tables_fit_into_their_terminal_and_lose_nothing(width: int) -> None:
    text = StringIO()
    names = [f'a long name {number}' for number in range(12)]
    rows = [
        ['first', *(f'cell{number}' for number in range(11))],
        ['second', *(f'{number}' for number in range(11))],
    ]
    columns = [(name, 'number') for name in names]
    TerminalTable(columns, rows).show(Console(file=text, width=width))
    lines = text.getvalue().splitlines()
    assert max(map(len, lines)) <= width
    for number in range(11):
        assert f'cell{number}' in text.getvalue()


def test_a_table_without_rows_has_its_columns() -> None:
    text = StringIO()
    TerminalTable([('case', 'text'), ('duration', 'number')], []).show(Console(file=text, width=80))
    assert text.getvalue().split()[:2] == ['case', 'duration']


def test_every_command_that_prints_a_table_has_json() -> None:
    tables = {
        'list',
        'show',
        'check',
        'measure',
        'cell',
        'simulate',
        'check_program',
        'report',
        'study',
        'check_bag',
    }
    assert {command.name for command in COMMANDS.values() if command.json} == tables


def test_options_are_refused_by_an_error_of_the_project() -> None:
    with pytest.raises(OptionError, match='cell --help lists all options'):
        COMMANDS['cell'].parser().parse_all(['--rate', 'fast'])


def test_every_kind_of_error_has_a_code_and_a_remedy_of_its_own() -> None:
    catalogue = error_catalogue()
    names = {kind.__name__: kind for kind in catalogue.values()}
    bases = {'RobotsError', *names}
    for file in ROOT.glob('robots_*/robots_*/**/*.py'):
        text = file.read_text()
        for name, base in re.findall(r'^class ([A-Z]\w*)\((\w+)', text, re.MULTILINE):
            assert base not in bases or name in names, f'{name} in {file} is not in the catalogue'
        assert 'raise RobotsError(' not in text, f'{file}: an error without a kind'
    for code, kind in catalogue.items():
        assert re.fullmatch(r'R[1-4]\d\d', code)
        assert {'code', 'remedy'} <= vars(kind).keys(), kind
    assert len({kind.remedy for kind in catalogue.values()}) == len(names)


def test_an_error_names_its_code_and_explain_what_to_do(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(['cell', '--rate', '0']) == ExitCode.BAD_INPUT
    assert capsys.readouterr().err.endswith(' [R101]\n')
    assert run(['explain', 'r101']) == ExitCode.OK
    assert OptionError.remedy in capsys.readouterr().out
    assert run(['explain', 'R1']) == ExitCode.BAD_INPUT


def test_a_bag_is_found_below_its_folder(tmp_path: Path) -> None:
    for name in ('one/bag', 'two/bag', 'two/other'):
        (tmp_path / name).mkdir(parents=True)
        (tmp_path / name / 'metadata.yaml').touch()
    parse = COMMANDS['report'].parser().parse_all
    assert parse([str(tmp_path / 'one')]).bag == tmp_path / 'one' / 'bag'
    assert parse([str(tmp_path / 'one' / 'bag')]).bag == tmp_path / 'one' / 'bag'
    with pytest.raises(OptionError, match=r'are 2 bags; name one of .*two/bag, .*two/other'):
        parse([str(tmp_path / 'two')])


def test_a_simulation_prints_its_figures_as_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program = tmp_path / 'part.lua'
    program.write_text('-- Robot: bello_bot\nptpJointSpaceAngles(5, 0, 0, 40, 0, 0, 0)\nwait(0.1)\n')
    words = ['simulate', str(program), '--drive', 'ideal', '--bag', str(tmp_path / 'bag'), '--json']
    assert run(words) == ExitCode.OK
    figures = json.loads(capsys.readouterr().out)
    assert figures['ok']
    (motion,) = figures['motions']
    assert (motion['line'], motion['reference_off_line']) == (2, None)
    assert 0.0 < motion['duration'] < figures['cycle_time']
    assert run(['report', str(tmp_path), '--json']) == ExitCode.OK
    again = json.loads(capsys.readouterr().out)
    assert again['motions'] == figures['motions']
    assert run(['report', str(tmp_path), str(tmp_path), '--json']) == ExitCode.OK
    assert json.loads(capsys.readouterr().out)['difference'] == 0.0


def test_a_simulation_ends_with_the_patience_of_who_asked_for_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    program = tmp_path / 'part.lua'
    program.write_text('-- Robot: bello_bot\nwhile true do wait(0.01) end\n')
    assert run(['simulate', str(program), '--drive', 'ideal', '--patience', '0.3']) == ExitCode.FAILED
    shown = capsys.readouterr().out
    assert 'part.lua:2: it has not ended within the patience of 0.3 s' in shown
    assert shown.splitlines()[-1] == 'program failed'
