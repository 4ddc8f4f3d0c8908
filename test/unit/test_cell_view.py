"""What a person reads in the terminal while a cell runs."""

from __future__ import annotations

import io

import numpy as np
import pytest
from rich.console import Console

from robots_controller.live_cell.cell_events import (
    Event,
    MotionCommanded,
    MotionPlanned,
    MotionProgress,
    NodeHealth,
    OutputsChanged,
    ProgramPrint,
    ProgramStatus,
)
from robots_controller.live_cell.cell_view import CellView
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.pose import Pose

POSE = Pose(np.array([1.2, -0.5, 0.75]), np.eye(3))


def shown(*events: Event, terminal: bool = False, width: int = 80) -> list[str]:
    """The lines that events make."""
    console = Console(file=io.StringIO(), force_terminal=terminal, width=width, color_system=None)
    view = CellView(console, ['drive_node'])
    for event in events:
        view.show(event)
    view.close()
    return [line.strip() for line in console.file.getvalue().splitlines()]  # type: ignore[attr-defined]


def running(line: int, source: str, file: str = 'welding.lua') -> ProgramStatus:
    return ProgramStatus('RUNNING', file, line, source, '')


@pytest.mark.parametrize(
    ('kind', 'target', 'expected'),
    [
        ('PTPJOINT_JOINT', np.radians([0.0, -90.0, 45.0]), '(0.00 deg, -90.00 deg, 45.00 deg)'),
        ('PTPJOINT_CARTESIAN', POSE, '(1.200, -0.500, 0.750) m'),
        ('PTPCARTESIAN', POSE, '(1.200, -0.500, 0.750) m'),
        ('PTPCARTESIAN circle', POSE, '(1.200, -0.500, 0.750) m'),
        ('PTPCARTESIAN spline', POSE, '(1.200, -0.500, 0.750) m'),
    ],
)
def test_a_motion_is_a_line_at_its_plan_and_one_at_its_end(
    kind: str, target: np.ndarray | Pose, expected: str
) -> None:
    assert shown(
        MotionCommanded('1.0', kind, target),
        MotionPlanned('1.0', 1.25),
        MotionProgress(0.5),
        MotionResult('1.0', True, 'reached', {'duration': '1.3'}),
    ) == [f'{kind} to {expected} in 1.25 s', 'reached after 1.30 s']


def test_motions_that_run_through_have_a_line_each_and_end_once() -> None:
    lines = shown(
        MotionCommanded('1.0', 'PTPJOINT_CARTESIAN', POSE),
        MotionCommanded('2.0', 'PTPCARTESIAN', POSE),
        MotionPlanned('2.0', 2.5),
        MotionResult('2.0', True, 'reached', {'duration': '2.6'}),
        MotionResult('1.0', True, 'passed', {'duration': '2.6'}),
    )
    place = '(1.200, -0.500, 0.750) m'
    assert lines == [
        f'PTPJOINT_CARTESIAN to {place}, runs through',
        f'PTPCARTESIAN to {place} in 2.50 s',
        'reached after 2.60 s',
    ]


def test_a_motion_that_is_planned_while_another_runs_follows_it() -> None:
    lines = shown(
        MotionCommanded('1.0', 'PTPJOINT_JOINT', np.zeros(2)),
        MotionPlanned('1.0', 1.0),
        MotionCommanded('2.0', 'PTPCARTESIAN', POSE),
        MotionPlanned('2.0', 2.0),
        MotionResult('1.0', True, 'reached', {'duration': '1.0'}),
        MotionResult('2.0', False, 'stopped by somebody', {}),
    )
    assert [line.split()[0] for line in lines] == ['PTPJOINT_JOINT', 'PTPCARTESIAN', 'reached', 'stopped:']
    assert lines[-1] == 'stopped: stopped by somebody'


def test_a_refused_motion_and_a_streamed_reference_are_no_motions_of_the_next_chain() -> None:
    lines = shown(
        MotionCommanded('1.0', 'PTPCARTESIAN', POSE),
        MotionResult('1.0', False, 'out of reach', {}),
        MotionPlanned('7.7', 0.004),
        MotionCommanded('2.0', 'PTPJOINT_JOINT', np.zeros(2)),
        MotionPlanned('2.0', 1.0),
    )
    assert lines == ['stopped: out of reach', 'PTPJOINT_JOINT to (0.00 deg, 0.00 deg) in 1.00 s']


def test_lines_of_the_program_are_reported_once_and_with_the_file_that_they_are_of() -> None:
    lines = shown(
        running(7, 'wait(1)'),
        running(7, 'wait(1)'),
        running(8, 'call("pick")'),
        running(8, 'wait(2)', 'pick.lua'),
        running(9, 'print("on")'),
        ProgramPrint('on [dim]'),
        OutputsChanged('digital', ((1, 1.0),)),
        ProgramStatus('FAILED', 'welding.lua', 9, '', 'welding.lua:9: broken'),
    )
    assert lines == [
        '7   wait(1)',
        '8   call("pick")',
        'in    pick.lua',
        '8   wait(2)',
        'in    welding.lua',
        '9   print("on")',
        'on [dim]',
        'digital output 1 -> 1',
        'welding.lua:9: broken',
    ]


def test_a_narrow_terminal_shows_the_beginning_of_a_line_and_a_log_all_of_it() -> None:
    line = running(7, 'print("' + 60 * 'word ' + '")')
    (short,) = shown(line, terminal=True, width=40)
    assert len(short) <= 40
    assert short.startswith('7   print("word')
    (whole,) = shown(line, width=40)
    assert whole.endswith('word ")')


def test_trouble_of_a_ready_node_is_reported_and_not_repeated_at_once() -> None:
    bad = NodeHealth('drive_node', 1, False, 'axis 2 is hot', '')
    lines = shown(bad, NodeHealth('drive_node', 1, True, '', 'http://here'), bad, bad)
    assert lines == ['ready  drive_node  http://here', 'drive_node: axis 2 is hot']


def test_a_node_that_works_is_ready_whatever_it_misses() -> None:
    """As a bridge at the start of a cell whose PLC is still silent."""
    silent = NodeHealth('drive_node', 1, False, 'plc/inputs has been silent for 0.5 s', '', works=True)
    assert shown(silent) == ['ready  drive_node', 'drive_node: plc/inputs has been silent for 0.5 s']


def test_a_terminal_shows_a_bar_of_the_running_motion_and_leaves_none_behind() -> None:
    console = Console(file=io.StringIO(), force_terminal=True, width=80, color_system=None)
    view = CellView(console, [])
    view.show(MotionCommanded('1.0', 'PTPCARTESIAN circle', POSE))
    view.show(MotionPlanned('1.0', 1.0))
    assert [task.description for task in view._bar.tasks] == ['PTPCARTESIAN circle']
    view.show(MotionCommanded('2.0', 'PTPJOINT_JOINT', np.zeros(2)))
    view.show(MotionPlanned('2.0', 1.0))
    view.show(MotionProgress(0.5))
    assert [(t.description, t.completed) for t in view._bar.tasks] == [('PTPCARTESIAN circle', 0.5)]
    view.show(MotionResult('1.0', True, 'reached', {'duration': '1'}))
    assert [(t.description, t.completed) for t in view._bar.tasks] == [('PTPJOINT_JOINT', 0)]
    view.show(MotionResult('2.0', True, 'reached', {'duration': '1'}))
    assert not view._bar.tasks
    view.close()


def test_sliding_axes_are_in_metres_as_in_programs() -> None:
    console = Console(file=io.StringIO(), width=80, color_system=None)
    view = CellView(console, [], (True, False))
    view.show(MotionCommanded('1.0', 'PTPJOINT_JOINT', np.array([0.25, np.pi])))
    view.show(MotionPlanned('1.0', 1.0))
    assert '(0.250 m, 180.00 deg)' in console.file.getvalue()  # type: ignore[attr-defined]
