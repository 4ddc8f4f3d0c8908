"""cell with what users do to it: other robots, wrong input, Ctrl-C, and nodes that die."""

from __future__ import annotations

import io
import os
import re
import signal
from collections.abc import Callable
from pathlib import Path

import pytest
from rich.console import Console

from robots_controller.live_cell.cell_command import parse_options, run_cell
from robots_core.errors import RobotsError

from .bag_checks import read_messages
from .cell_process import CellProcess
from .lockstep_runs import PROGRAMS, LockstepRuns

StartCell = Callable[..., CellProcess]

WRONG_PROGRAMS = {
    'runtime': ('local x = nil\nx.y = 1', 'wrong.lua:2: '),
    'limit': (
        'ptpJointSpaceAngles(0, 10, 45, 0, 45, 0)',
        'A2 = 10 deg is outside its limits [-140, -5] deg',
    ),
}


def test_another_robot_changes_nothing_else(lockstep_runs: LockstepRuns) -> None:
    cell = lockstep_runs.run('bello_bot_tour.lua')
    assert cell.returncode == 0, cell.text
    assert 'every target reached, every limit kept' in cell.text


def test_a_wrong_option_is_reported_in_one_line(start_cell: StartCell) -> None:
    cell = start_cell('--robot', 'no_such_robot')
    assert cell.wait() == 2
    assert len(cell.lines) == 1
    assert cell.lines[0].startswith("error: unknown robot 'no_such_robot'; robots are: ")


@pytest.mark.parametrize(
    ('options', 'message'),
    [
        (('--program', 'no_such.lua'), "^program 'no_such.lua' not found"),
        (('--robot', 'urdf:/no/such.urdf'), '^there is no URDF file /no/such.urdf'),
        (('--once',), '^--once needs a --program'),
    ],
)
def test_every_wrong_option_is_explained(options: tuple[str, ...], message: str) -> None:
    with pytest.raises(RobotsError, match=message):
        run_cell(parse_options(options), Console(file=io.StringIO()))


@pytest.mark.parametrize(
    ('text', 'message'),
    [
        ('wait(1 2)', "wrong.lua:1: ')' expected near '2'"),
        ('wait(0)\nwait(0) // weld', "wrong.lua:2: '//' does not start a remark in Lua"),
    ],
)
def test_a_program_that_is_not_lua_is_reported_before_anything_starts(
    tmp_path: Path, text: str, message: str
) -> None:
    program, out = tmp_path / 'wrong.lua', tmp_path / 'out'
    program.write_text(text + '\n')
    options = parse_options(['--program', str(program), '--record', str(out)])
    with pytest.raises(RobotsError, match=re.escape(message)):
        run_cell(options, Console(file=io.StringIO()))
    assert not out.exists()


@pytest.mark.parametrize('case', WRONG_PROGRAMS)
def test_a_wrong_program_is_reported_and_leads_to_an_error_code(
    lockstep_runs: LockstepRuns, tmp_path: Path, case: str
) -> None:
    text, message = WRONG_PROGRAMS[case]
    program = tmp_path / 'wrong.lua'
    program.write_text(text + '\n')
    cell = lockstep_runs.run_file(program, '--robot', 'kuka_kr210_r2700')
    assert cell.returncode == 1, cell.text
    assert message in cell.text
    assert 'Traceback' not in cell.text


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_and_terminate_stop_all_nodes(start_cell: StartCell, number: signal.Signals) -> None:
    cell = start_cell('--robot', 'bello_bot')
    cell.until_ready()
    pids = cell.node_pids()
    assert len(pids) == 6
    cell.process.send_signal(number)
    assert cell.wait() == 130
    assert not [name for name, pid in pids.items() if Path(f'/proc/{pid}').exists()]
    assert 'Traceback' not in cell.text
    logs = ''.join(file.read_text() for file in cell.out.glob('*/log/*.log'))
    assert 'Traceback' not in logs


def test_a_node_that_died_is_named_with_the_reason(start_cell: StartCell) -> None:
    cell = start_cell('--robot', 'bello_bot')
    cell.until_ready()
    os.kill(cell.node_pids()['drive_node'], signal.SIGKILL)
    assert cell.wait() == 1
    assert 'drive_node killed by SIGKILL' in cell.text


def test_a_planner_killed_in_a_motion_leaves_the_robot_standing_on_its_path(
    start_cell: StartCell,
) -> None:
    cell = start_cell('--robot', 'kuka_kr210_r2700', '--program', str(PROGRAMS / 'welding.lua'))
    cell.until('PTPCARTESIAN to')
    os.kill(cell.node_pids()['planning_node'], signal.SIGKILL)
    cell.until('planning_node killed by SIGKILL')
    assert cell.wait() == 1
    assert 'stopped' in cell.text
    references = read_messages(cell.bag, ['/joint_reference'])['/joint_reference']
    assert not any(references[-1][1].points[0].velocities)


def test_a_second_cell_beside_the_first_ends_with_the_reason(start_cell: StartCell) -> None:
    first = start_cell('--robot', 'bello_bot')
    first.until_ready()
    second = start_cell('--robot', 'kuka_kr210_r2700')
    assert second.wait() == 1
    assert 'another cell is running' in second.text
    assert len(first.node_pids()) == 6
