"""Two runs side by side: one HTML file, and a table for the terminal."""

from __future__ import annotations

from typing import Any

import numpy as np
from rich.console import Console
from rich.markup import escape

from robots_controller.report.comparison import NOTICED, LineChange, RunComparison
from robots_controller.report.line_times import time_spans
from robots_controller.report.page.page import columns, figure, page_text
from robots_controller.report.page.page_data import PageArrays, series
from robots_controller.report.page.page_panels import COLOURS, io_panels, spans_panel, speed_panel
from robots_controller.report.page.page_world import world
from robots_controller.report.run_report import RunReport
from robots_controller.report.terminal import source_table

NAMES = ('A', 'B')


def comparison_page(comparison: RunComparison) -> str:
    """The HTML text of a comparison: the first run is A, the second B."""
    arrays = PageArrays()
    runs = list(zip(NAMES, (comparison.before, comparison.after), strict=True))
    data = {
        'title': f'{comparison.after.title}: {comparison.describe()}',
        'subtitle': '; '.join(f'{name}: {report.run.source}' for name, report in runs),
        'problems': [f'{name}: {text}' for name, report in runs for text in report.problems],
        'figures': _figures(comparison),
        'duration': max(report.run.duration for _, report in runs),
        'lines': _lines(comparison),
        'motions': _largest(comparison),
        'panels': [
            spans_panel(runs),
            speed_panel(runs, arrays),
            *_joint_panels(runs, arrays),
            *io_panels(runs, arrays),
        ],
        'world': world((comparison.before, comparison.after), arrays),
    }
    return page_text(data, arrays)


def show_comparison(comparison: RunComparison, console: Console) -> None:
    """Print what changed, line by line."""
    for name, report in zip(NAMES, (comparison.before, comparison.after), strict=True):
        console.print(
            f'[bold]{name}[/]  {escape(report.title)}, {report.run.duration:.2f} s  '
            f'{escape(report.run.source)}',
            highlight=False,
        )
    table = source_table()
    for name in ('A s', 'B s', 'B - A s'):
        table.add_column(name, justify='right', no_wrap=True)
    table.add_column('decided by', overflow='fold')
    for change in comparison.changes:
        colour = {'worse': 'red', 'better': 'green', '': 'dim'}[_trend(change.difference)]
        table.add_row(
            str(change.line.line or ''),
            escape(change.line.source),
            _seconds(change.before),
            _seconds(change.after),
            f'[{colour}]{change.difference:+.2f}[/]',
            _decided(change),
        )
    console.print(table)
    console.print(f'[bold]B is {comparison.describe()}[/]', highlight=False)


def _figures(comparison: RunComparison) -> list[dict[str, str]]:
    before, after = comparison.before, comparison.after

    def pair(label: str, one: float, other: float, unit: str, digits: int = 2) -> dict[str, str]:
        difference = other - one
        part = f' ({100.0 * difference / one:+.1f} %)' if one else ''
        trend = _trend(difference) if abs(difference) >= 0.5 * 10**-digits else ''
        note = f'A {one:.{digits}f} {unit}, {difference:+.{digits}f}{part}'
        return figure(label, f'{other:.{digits}f} {unit}', note, trend)

    found = [pair('cycle time B', before.run.duration, after.run.duration, 's')]
    for key, name in (('moving', 'moving'), ('waiting', 'waiting'), ('io', 'I/O')):
        found.append(pair(name, before.times[key], after.times[key], 's'))
    first, second = (float(report.energy.sum()) / 1e3 for report in (before, after))
    return [*found, pair('energy', first, second, 'kJ')]


def _lines(comparison: RunComparison) -> dict[str, Any]:
    spans = time_spans(comparison.after.run)
    rows = []
    for change in comparison.changes:
        line = change.line
        bar = [0.0, 0.0, 0.0] if change.after is None else [line.moving, line.waiting, line.io]
        here = [] if change.after is None else spans
        rows.append(
            {
                'cells': [
                    str(line.line or ''),
                    line.source,
                    _seconds(change.before),
                    _seconds(change.after),
                    f'{change.difference:+.2f}' if abs(change.difference) >= NOTICED else '',
                    '',
                ],
                'bar': bar,
                'trends': {'4': _trend(change.difference)} if _trend(change.difference) else {},
                'spans': [[s.start, s.end] for s in here if (s.file, s.line) == (line.file, line.line)],
            }
        )
    names = [('line', 'number'), ('', 'code'), ('A s', 'number'), ('B s', 'number'), ('B - A s', 'number')]
    return {'title': 'Cycle time by line', 'columns': columns(*names, ('', 'bar')), 'rows': rows}


def _largest(comparison: RunComparison) -> dict[str, Any]:
    rows = [
        {
            'cells': [
                str(change.line.line or ''),
                change.line.source,
                f'{change.difference:+.2f}',
                change.activity,
                change.decided_before,
                change.decided_after,
            ],
            'trends': {'2': _trend(change.difference)},
        }
        for change in comparison.largest
    ]
    names = [('line', 'number'), ('', 'code'), ('B - A s', 'number'), ('in', 'text')]
    names += [('decided in A by', 'text'), ('in B by', 'text')]
    title = 'What changed, largest first' if rows else 'No line changed'
    return {'title': title, 'columns': columns(*names), 'rows': rows}


def _joint_panels(runs: list[tuple[str, RunReport]], arrays: PageArrays) -> list[dict[str, Any]]:
    """Speeds and torques: the axis that is closest to its limit, of each run."""
    panels = []
    for title, quantity in (('Highest joint speed', 'velocity'), ('Highest torque', 'torque')):
        curves = [
            series(
                arrays,
                name,
                report.run.time,
                100.0 * report.signals.use[quantity].max(axis=1),
                COLOURS[number],
                show=(1.0, 0.0, '%'),
            )
            for number, (name, report) in enumerate(runs)
        ]
        panels.append(
            {'title': title, 'unit': '% of limit', 'kind': 'lines', 'marks': [100.0], 'series': curves}
        )
    powers = [
        series(
            arrays,
            name,
            report.run.time,
            np.maximum(report.signals.power, 0.0).sum(axis=1) / 1e3,
            COLOURS[number],
            show=(1.0, 0.0, 'kW'),
        )
        for number, (name, report) in enumerate(runs)
    ]
    return [*panels, {'title': 'Mechanical power taken up', 'unit': 'kW', 'kind': 'lines', 'series': powers}]


def _decided(change: LineChange) -> str:
    before, after = change.decided_before, change.decided_after
    return after if before == after or not before else f'{before} -> {after or "-"}'


def _trend(difference: float) -> str:
    if abs(difference) < NOTICED:
        return ''
    return 'worse' if difference > 0.0 else 'better'


def _seconds(line: Any) -> str:
    return '-' if line is None else f'{line.total:.2f}'
