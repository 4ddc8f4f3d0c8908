"""The report in a terminal."""

from __future__ import annotations

import math
from pathlib import Path

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from robots_controller.report.line_times import LineTime
from robots_controller.report.motion_figures import MotionFigures
from robots_controller.report.recorded_motion import RecordedMotion
from robots_controller.report.run_report import RunReport

BAR_WIDTH = 24
SOURCE_WIDTH = 46


def show_report(report: RunReport, console: Console) -> None:
    """Print times by line, figures by motion and the sums."""
    run = report.run
    console.print(f'[bold]{escape(report.title)}[/]  {escape(run.source)}', highlight=False)
    if run.problem:
        console.print(f'[yellow]{escape(run.problem)}[/]', highlight=False)
    files = {line.file for line in report.lines}
    console.print(_line_table(report, files))
    if report.motions:
        console.print(_motion_table(report.motions, files))
    for motion in run.motions:
        if not motion.ok:
            console.print(f'[bold red]line {motion.line}: {escape(motion.message)}[/]', highlight=False)
    if run.program_error:
        console.print(f'[bold red]{escape(run.program_error)}[/]', highlight=False)
    for text in summary(report):
        console.print(text, highlight=False)


def summary(report: RunReport) -> tuple[str, ...]:
    """The sums, a line each."""
    run, times = report.run, report.times
    split = ', '.join(f'{name} {value:.2f} s' for name, value in times.items())
    lines = [f'cycle time {run.duration:.2f} s: {split}; program {run.program_state.lower()}']
    lines.append(
        f'mechanical energy {report.energy.sum() / 1e3:.2f} kJ, '
        f'by {"the torques of the drives" if report.signals.measured else "inverse dynamics"}'
    )
    if report.clearance is not None:
        lines.append(f'smallest distance {report.clearance.describe()}')
    return tuple(lines)


def _line_table(report: RunReport, files: set[str]) -> Table:
    table = Table(box=SIMPLE_HEAD, header_style='bold', pad_edge=False)
    table.add_column('line', justify='right', no_wrap=True)
    table.add_column('', no_wrap=True, max_width=SOURCE_WIDTH, overflow='ellipsis')
    for name in ('visits', 'moving', 'waiting', 'I/O', 'total s'):
        table.add_column(name, justify='right', no_wrap=True)
    table.add_column('', no_wrap=True)
    longest = max((line.total for line in report.lines), default=0.0)
    for line in report.lines:
        where = place(line, files)
        times = (f'{value:.2f}' if value else '' for value in (line.moving, line.waiting, line.io))
        filled = round(BAR_WIDTH * line.total / longest) if longest else 0
        bar = f'[cyan]{"━" * filled}[/]'
        table.add_row(where, escape(line.source), str(line.visits), *times, f'{line.total:.2f}', bar)
    return table


def _motion_table(motions: tuple[MotionFigures, ...], files: set[str]) -> Table:
    table = Table(box=SIMPLE_HEAD, header_style='bold', pad_edge=False)
    names = ('line', 'planned\ns', 'real\ns', 'way\nm', 'off path\nmm', 'lag\nmm', 'missed\nmm', 'energy\nkJ')
    for name in names:
        table.add_column(name, justify='right', no_wrap=True)
    table.add_column('decided by', no_wrap=True)
    for item in motions:
        table.add_row(
            place(item.motion, files),
            number(item.planned, 2),
            number(item.duration, 2),
            number(item.length, 2),
            number(1e3 * item.path_deviation, 3),
            number(1e3 * item.lag, 2),
            number(1e3 * item.missed, 3),
            number(item.energy / 1e3, 2),
            item.deciding.describe(),
        )
    return table


def place(item: LineTime | RecordedMotion, files: set[str]) -> str:
    """The line's number, with its file where there are several; '' for none."""
    if not item.line:
        return ''
    several = len([file for file in files if file]) > 1
    return f'{Path(item.file).name}:{item.line}' if several else str(item.line)


def number(value: float, digits: int) -> str:
    """A number for a table; '-' for what is not known."""
    return '-' if math.isnan(value) else f'{value:.{digits}f}'
