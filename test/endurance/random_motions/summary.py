"""The table of many random motions: a row per robot."""

from collections import Counter
from collections.abc import Sequence
from itertools import groupby
from typing import Final

from robots_controller.report.tables import ReportTable, Row
from robots_controller.terminal_table import Kind

from .motion_run import MotionFigures

# Percent of a limit are shown with as many digits as tell 1 from what only rounding makes of it.
PLAN: Final = ('velocity', 'acceleration', 'jerk', 'torque', 'speed')
REFERENCES: Final = ('reference velocity', 'reference acceleration', 'reference frame speed')
SHORT: Final = {'speed': 'tool speed'}


def summary(found: Sequence[MotionFigures]) -> ReportTable:
    """Motions, refusals and the worst ratio to each limit by robot, and of all."""
    names: list[tuple[str, Kind]] = [('robot', 'text'), ('motions', 'number'), ('refused', 'text')]
    names += [(SHORT.get(name, name), 'number') for name in (*PLAN, *REFERENCES)]
    ordered = sorted(found, key=lambda figures: figures.robot)
    groups = [(name, list(group)) for name, group in groupby(ordered, key=lambda figures: figures.robot)]
    rows = [_row(f'`{name}`', group) for name, group in groups]
    if len(groups) > 1:
        rows.append(_row('all', ordered))
    title = 'Worst values as parts of their limits, of plans at 10 kHz and of references at their period'
    return ReportTable(title, (*names, ('broken', 'number')), tuple(rows))


def closing_line(found: Sequence[MotionFigures]) -> str:
    """One line for all."""
    planned = [figures for figures in found if not figures.refused and figures.uses]
    bad = sum(1 for figures in found if figures.problems)
    hours = sum(figures.duration for figures in planned) / 3600.0
    return (
        f'{len(found)} motions, {len(planned)} planned and followed ({hours:.1f} hours of motion), '
        f'{bad} with a broken limit or an error that is no RobotsError'
    )


def worst(found: Sequence[MotionFigures], quantity: str) -> float | None:
    """Largest ratio to a limit; None if no motion has that limit."""
    return max((figures.uses[quantity] for figures in found if quantity in figures.uses), default=None)


def _row(name: str, found: Sequence[MotionFigures]) -> Row:
    refused = Counter(figures.refused for figures in found if figures.refused)
    bad = sum(1 for figures in found if figures.problems)
    cells = [name, str(len(found))]
    cells.append(', '.join(f'{count} {reason}' for reason, count in refused.most_common()))
    for quantity in (*PLAN, *REFERENCES):
        ratio = worst(found, quantity)
        cells.append('-' if ratio is None else f'{ratio:.7f}')
    cells.append(str(bad))
    return Row(tuple(cells), bad=bad > 0, trends={len(cells) - 1: 'worse'} if bad else {})
