"""Figures of long runs, on messages and sizes that are made up, and their page."""

from __future__ import annotations

import os
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from chaos.surroundings import InCell
from robots_controller.interpreter.lua_source import check_syntax, read_source
from soak.__main__ import PROGRAMS
from soak.figures import (
    LARGEST_SLOPE,
    LATE,
    MEANINGFUL,
    PERIOD,
    LoopFigures,
    MemoryFigures,
    SoakFigures,
    loop_figures,
    memory_figures,
)
from soak.page import soak_page
from soak.processes import memory_of
from soak.summary import closing_line, loop_table, memory_table

COUNT = 100_000
HOUR = 3600.0  # s


def loop(late: np.ndarray | None = None) -> LoopFigures:
    late = np.full(COUNT, 1e-4) if late is None else late
    return LoopFigures('joint_reference', PERIOD * np.arange(late.size), late, np.empty(0))


def memory(slope: float, name: str = 'planning_node') -> MemoryFigures:
    """Grows by 50 MB while it warms up, then steadily."""
    time = np.linspace(0.0, HOUR, 361)
    return MemoryFigures(name, time, 100.0 + 50.0 * np.minimum(1.0, time / 300.0) + slope * time / HOUR)


def figures(**changes: object) -> SoakFigures:
    made = SoakFigures(
        duration=HOUR,
        runs=90,
        jogs=89,
        inputs=1234,
        problems=(),
        loops=(loop(),),
        memory=(memory(0.5), memory(0.0, 'drive_node')),
        recorded=512.0,
        machine='a <machine>',
    )
    return replace(made, **changes)  # type: ignore[arg-type]


def test_percentiles_are_those_of_all_messages() -> None:
    late = 1e-6 * np.arange(1, COUNT + 1)
    median, p99, p999, p9999 = loop(late).percentiles
    assert median == pytest.approx(0.05, rel=1e-4)
    assert p99 == pytest.approx(0.099, rel=1e-4)
    assert p999 == pytest.approx(0.0999, rel=1e-4)
    assert p9999 == pytest.approx(0.09999, rel=1e-4)
    assert loop(late).worst == pytest.approx(0.1)


def test_periods_are_missed_that_come_too_late_and_few_are_within_the_goal() -> None:
    late = np.full(COUNT, 1e-4)
    late[:10] = LATE + 1e-4
    assert loop(late).missed == 10
    assert figures(loops=(loop(late),)).missed_goals == ()
    late[10] = LATE + 1e-4
    (missed,) = figures(loops=(loop(late),)).missed_goals
    assert missed.startswith('joint_reference: 11 of 100000 messages came more than 2 ms late')


def test_gaps_are_where_messages_are_missing() -> None:
    kept = np.delete(PERIOD * np.arange(100), [10, 50, 51])
    kept = np.append(kept, kept[-1] + 5 * PERIOD * np.arange(1, 10))  # at rest
    moved = np.arange(kept.size) < 96
    loop = loop_figures('joint_states', kept, 1e-3 * ~moved, moved)
    np.testing.assert_allclose(loop.gaps, [2 * PERIOD, 3 * PERIOD])
    assert loop.late.size == loop.due.size == 96
    assert loop.worst == 0.0


def test_memory_is_looked_at_after_the_warm_up() -> None:
    assert memory(0.0).slope == pytest.approx(0.0, abs=1e-9)
    assert memory(7.0).slope == pytest.approx(7.0)
    growing = figures(memory=(memory(LARGEST_SLOPE + 0.1),))
    assert growing.missed_goals == ('planning_node grows by 2.10 MB in an hour, the goal is 2 MB',)
    assert figures(memory=(memory(LARGEST_SLOPE + 0.1, 'cell'),)).missed_goals == ()
    assert replace(growing, duration=0.9 * MEANINGFUL).missed_goals == ()


def test_processes_are_listed_by_size_also_those_that_came_later() -> None:
    samples = [(0.0, {'a': 1.0}), (1.0, {'a': 1.0, 'b': 5.0}), (2.0, {'b': 6.0})]
    found = memory_figures(samples)
    assert [one.name for one in found] == ['b', 'a']
    np.testing.assert_array_equal(found[0].time, [1.0, 2.0])


def test_the_memory_of_this_process_is_read() -> None:
    assert 1.0 < memory_of(os.getpid())['cell'] < 1e5


def test_the_tables_show_every_loop_and_process() -> None:
    bad = figures(loops=(loop(np.full(1000, 0.003)),), memory=(memory(9.0), memory(0.0, 'drive_node')))
    (row,) = loop_table(bad).rows
    assert row.cells[:2] == ('`joint_reference`', '1000')
    assert row.bad
    assert [(row.cells[0], row.cells[3], row.bad) for row in memory_table(bad).rows] == [
        ('`planning_node`', '+9.00', True),
        ('`drive_node`', '+0.00', False),
    ]
    assert closing_line(bad).endswith('2 goals missed')
    assert closing_line(figures()).startswith('60.0 minutes: 90 runs of the program, jogged 89 times')


def test_the_page_needs_nothing_else_and_shows_what_went_wrong() -> None:
    text = soak_page(figures(problems=('cell <died>',)))
    assert 'cell &lt;died&gt;' in text
    assert 'a &lt;machine&gt;' in text
    assert text.count('<svg') == 3
    assert not re.findall(r'(?:src|href)=', text)
    assert 'NaN' not in text
    assert 'nan' not in text


def test_a_run_that_failed_at_once_has_a_page_too() -> None:
    nothing = LoopFigures('joint_reference', np.empty(0), np.empty(0), np.empty(0))
    assert 'not started' in soak_page(figures(problems=('not started',), loops=(nothing,), memory=()))


def test_the_program_and_the_plc_are_valid(tmp_path: Path) -> None:
    cell = InCell(PROGRAMS / 'shift.lua', {}, tmp_path, io_map=PROGRAMS / 'plc.yaml')
    check_syntax(read_source(PROGRAMS / 'shift.lua'))
    assert {'io_bridge_node', 'collision_node'} <= set(cell.nodes)
