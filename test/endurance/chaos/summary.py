"""The table of many faults, and which goals they meet."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Final

import numpy as np

from robots_controller.report.tables import ReportTable, Row
from robots_controller.terminal_table import Kind

from .judgement import ON_PATH, OUTPUTS_SAFE, REACTION, FaultFigures

COLUMNS: Final[tuple[tuple[str, Kind], ...]] = (
    ('in', 'text'),
    ('node', 'text'),
    ('was', 'text'),
    ('times', 'number'),
    ('in motion', 'number'),
    ('stands after s', 'number'),
    ('braking s', 'number'),
    ('later than goal s', 'number'),
    ('off path mm', 'number'),
    ('outputs safe after s', 'number'),
    ('broken', 'number'),
    ('usable after s', 'number'),
    ('goals missed', 'text'),
)


@dataclass(frozen=True)
class Fault:
    """A trial with its figures.

    Attributes:
        surroundings: Where.
        node: What was killed or frozen.
        killed: Killed.
        figures: What it did.
    """

    surroundings: str
    node: str
    killed: bool
    figures: FaultFigures


def missed_goals(figures: FaultFigures) -> list[str]:
    """Goals that a fault does not meet."""
    missed = []
    if figures.stops and not figures.late <= 0.0:
        missed.append('stands')
    if figures.on_path and figures.deviation > ON_PATH:
        missed.append('path')
    if not np.isnan(figures.outputs_safe) and figures.outputs_safe > OUTPUTS_SAFE:
        missed.append('outputs')
    if figures.problems:
        missed.append('limits')
    if not figures.usable:
        missed.append('usable')
    return missed


def summary(faults: Sequence[Fault]) -> ReportTable:
    """A row for each node, killed and frozen, in each surroundings: medians and worst values."""

    def key(fault: Fault) -> tuple[str, str, bool]:
        return fault.surroundings, fault.node, not fault.killed

    rows = []
    for (surroundings, node, frozen), group in groupby(sorted(faults, key=key), key=key):
        figures = [fault.figures for fault in group]
        missed = sorted({goal for each in figures for goal in missed_goals(each)})
        rows.append(
            Row(
                (
                    surroundings,
                    f'`{node}`',
                    'frozen' if frozen else 'killed',
                    str(len(figures)),
                    str(sum(each.stops for each in figures)) if any(each.stops for each in figures) else '-',
                    _spread(figures, lambda each: each.stands),
                    _spread(figures, lambda each: each.braking),
                    _spread(figures, lambda each: each.late),
                    _spread(figures, lambda each: 1e3 * each.deviation),
                    _spread(figures, lambda each: each.outputs_safe),
                    str(sum(bool(each.problems) for each in figures)),
                    _spread(figures, lambda each: each.usable_after if each.usable else np.inf),
                    ', '.join(missed) or 'none',
                ),
                bad=bool(missed),
                trends={len(COLUMNS) - 1: 'worse' if missed else 'better'},
            )
        )
    title = (
        f'Median and worst of faults. Goals: stands at most {REACTION:g} s after the watchdog and its '
        f'braking, within {1e3 * ON_PATH:g} mm of its path with drives and controller, outputs safe within '
        f'{OUTPUTS_SAFE:g} s, no limit broken, no motion that nobody commanded, usable by reset, open '
        f'and run'
    )
    return ReportTable(title, COLUMNS, tuple(rows))


def closing_line(faults: Sequence[Fault]) -> str:
    """One line for all."""
    missed = sum(1 for fault in faults if missed_goals(fault.figures))
    return f'{len(faults)} faults, {missed} that miss a goal'


def _spread(figures: Sequence[FaultFigures], value: Callable[[FaultFigures], float]) -> str:
    """Median and worst of what there is."""
    values = np.array([value(each) for each in figures])
    values = values[~np.isnan(values)]
    if not values.size:
        return '-'
    return ' / '.join(_number(each) for each in (float(np.median(values)), float(values.max())))


def _number(value: float) -> str:
    return 'never' if value == np.inf else f'{value:.2f}'
