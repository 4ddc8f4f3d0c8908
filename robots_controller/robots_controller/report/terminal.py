"""The report in a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from robots_controller.report.motion_columns import SUMMARY, VERDICT, Column
from robots_controller.report.run_report import RunReport

BAR_WIDTH: Final = 24
SOURCE_WIDTH: Final = 46


def show_report(report: RunReport, console: Console) -> None:
    """Print times by line, figures by motion and the sums."""
    run = report.run
    console.print(f'[bold]{escape(report.title)}[/]  {escape(run.source)}', highlight=False)
    console.print(_line_table(report))
    show_verdict(report, console, SUMMARY)
    for text in summary(report):
        console.print(text, highlight=False)


def show_verdict(report: RunReport, console: Console, columns: Sequence[Column] = VERDICT) -> None:
    """Print figures by motion, what went wrong, and a closing line."""
    if report.motions:
        console.print(_motion_table(report, columns))
    for text in report.problems:
        console.print(f'[bold red]{escape(text)}[/]', highlight=False)
    late = float(report.run.late.max())
    if late > 0.0:
        console.print(
            f'[yellow]the machine was busy: references came up to {1e3 * late:.0f} ms late[/]',
            highlight=False,
        )
    colour = 'green' if report.ok else 'red'
    console.print(f'[bold {colour}]program {report.run.program_state.lower()}[/]{_praise(report)}')


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


def source_table() -> Table:
    """A table of the lines of a program, with the columns of number and text."""
    table = Table(box=SIMPLE_HEAD, header_style='bold', pad_edge=False)
    table.add_column('line', justify='right', no_wrap=True)
    table.add_column('', no_wrap=True, max_width=SOURCE_WIDTH, overflow='ellipsis')
    return table


def _praise(report: RunReport) -> str:
    if not report.ok:
        return ''
    count = len(report.motions)
    early = sum(item.motion.ended_early for item in report.motions)
    motions = f': {count} motion{"" if count == 1 else "s"}, '
    others = f'{early} ended by the program, every other target reached' if early else 'every target reached'
    return f'{motions}{others}, every limit kept'


def _line_table(report: RunReport) -> Table:
    table = source_table()
    for name in ('visits', 'moving', 'waiting', 'I/O', 'total s'):
        table.add_column(name, justify='right', no_wrap=True)
    table.add_column('', no_wrap=True)
    longest = max((line.total for line in report.lines), default=0.0)
    for line in report.lines:
        times = (f'{value:.2f}' if value else '' for value in (line.moving, line.waiting, line.io))
        filled = round(BAR_WIDTH * line.total / longest) if longest else 0
        bar = f'[cyan]{"━" * filled}[/]'
        source = escape(line.source)
        table.add_row(report.place(line), source, str(line.visits), *times, f'{line.total:.2f}', bar)
    return table


def _motion_table(report: RunReport, columns: Sequence[Column]) -> Table:
    table = Table(box=SIMPLE_HEAD, header_style='bold', pad_edge=False, collapse_padding=True)
    table.add_column('line', justify='right', no_wrap=True)
    for column in columns:
        table.add_column(_halves(column.name), justify='left' if column.words else 'right', no_wrap=True)
    for item in report.motions:
        table.add_row(report.place(item.motion), *(column.text(item) for column in columns))
    return table


def _halves(name: str) -> str:
    """A name on two lines, as even as words permit."""
    cuts = [place for place, letter in enumerate(name) if letter == ' ']
    if not cuts:
        return name
    cut = min(cuts, key=lambda place: abs(2 * place - len(name)))
    return f'{name[:cut]}\n{name[cut + 1 :]}'
