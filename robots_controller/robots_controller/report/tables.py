"""The tables of reports, as data that terminal and page show."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from rich.console import Console
from rich.markup import escape

from robots_controller.report.comparison import NOTICED, LineChange, RunComparison
from robots_controller.report.line_times import ACTIVITIES, LineTime
from robots_controller.report.motion_columns import KIND, NOTHING, Column
from robots_controller.report.run_report import RunReport
from robots_controller.terminal_table import Columns, TerminalTable

BAR_WIDTH: Final = 24
COLOURS: Final = {'worse': 'red', 'better': 'green'}

LINE: Final[Columns] = (('line', 'number'), ('', 'code'))


@dataclass(frozen=True)
class Row:
    """A row of a table.

    Attributes:
        cells: Its texts.
        spans: The times that it is about, s.
        bar: Times of moving, waiting, I/O, s.
        bad: It reports a fault.
        trends: 'worse' or 'better' by number of a cell.
    """

    cells: tuple[str, ...]
    spans: tuple[tuple[float, float], ...] = ()
    bar: tuple[float, ...] = ()
    bad: bool = False
    trends: Mapping[int, str] = field(default_factory=dict)


@dataclass(frozen=True)
class ReportTable:
    """A table; its first columns, `keys` of them, say what a row is about."""

    title: str
    columns: Columns
    rows: tuple[Row, ...]
    keys: int = 1

    def show(self, console: Console) -> None:
        """Print it in a terminal."""
        longest = max((sum(row.bar) for row in self.rows), default=0.0) or 1.0
        rows = []
        for row in self.rows:
            cells = [
                f'[{COLOURS[row.trends[place]]}]{text}[/]' if place in row.trends else escape(text)
                for place, text in enumerate(row.cells)
            ]
            if row.bar:
                cells[-1] = f'[cyan]{"━" * round(BAR_WIDTH * sum(row.bar) / longest)}[/]'
            rows.append(cells)
        TerminalTable(self.columns, rows, keys=self.keys).show(console)


def line_table(report: RunReport) -> ReportTable:
    """Cycle time by line."""
    names: Columns = tuple((name, 'number') for name in ('visits', *ACTIVITIES.values(), 'total s'))
    rows = [
        Row(
            (
                report.place(line),
                line.source,
                str(line.visits),
                *(f'{t:.2f}' if t >= NOTICED else '' for t in (line.moving, line.waiting, line.io)),
                f'{line.total:.2f}',
                '',
            ),
            spans=_spans(report, line),
            bar=(line.moving, line.waiting, line.io),
        )
        for line in report.lines
    ]
    return ReportTable('Cycle time by line', (*LINE, *names, ('', 'bar')), tuple(rows), len(LINE))


def motion_table(report: RunReport, columns: Sequence[Column]) -> ReportTable:
    """Figures by motion."""
    columns = [
        column
        for column in columns
        if not column.optional or any(column.text(item) != NOTHING for item in report.motions)
    ]
    named: Columns = tuple((column.name, 'text' if column.words else 'number') for column in columns)
    rows = [
        Row(
            (report.place(item.motion), *(column.text(item) for column in columns)),
            spans=((item.motion.start, item.motion.end),) if item.motion.moved else (),
            bad=not item.ok,
        )
        for item in report.motions
    ]
    keys = 2 if KIND in columns[:1] else 1
    return ReportTable('Motions', (('line', 'number'), *named), tuple(rows), keys)


def change_table(comparison: RunComparison) -> ReportTable:
    """What changed, line by line."""
    rows = []
    for change in comparison.changes:
        line, after = change.line, change.after
        rows.append(
            Row(
                (
                    str(line.line or ''),
                    line.source,
                    _seconds(change.before),
                    _seconds(after),
                    f'{change.difference:+.2f}' if trend(change.difference) else '',
                    _decided(change),
                    '',
                ),
                spans=() if after is None else _spans(comparison.after, after),
                bar=(0.0,) if after is None else (after.moving, after.waiting, after.io),
                trends={4: trend(change.difference)} if trend(change.difference) else {},
            )
        )
    names: Columns = (('A s', 'number'), ('B s', 'number'), ('change s', 'number'))
    columns = (*LINE, *names, ('decided by', 'text'), ('', 'bar'))
    return ReportTable('Cycle time by line', columns, tuple(rows), len(LINE))


def largest_table(comparison: RunComparison) -> ReportTable:
    """What changed, largest first."""
    rows = [
        Row(
            (
                str(change.line.line or ''),
                change.line.source,
                f'{change.difference:+.2f}',
                change.activity,
                change.decided_before,
                change.decided_after,
            ),
            trends={2: trend(change.difference)},
        )
        for change in comparison.largest
    ]
    names: Columns = (('decided in A by', 'text'), ('in B by', 'text'))
    columns = (*LINE, ('change s', 'number'), ('in', 'text'), *names)
    return ReportTable('What changed, largest first' if rows else 'No line changed', columns, tuple(rows))


def trend(difference: float) -> str:
    """'worse', 'better', or '' for what is too little."""
    if abs(difference) < NOTICED:
        return ''
    return 'worse' if difference > 0.0 else 'better'


def _spans(report: RunReport, line: LineTime) -> tuple[tuple[float, float], ...]:
    here = line.file, line.line
    return tuple((span.start, span.end) for span in report.spans if (span.file, span.line) == here)


def _decided(change: LineChange) -> str:
    before, after = change.decided_before, change.decided_after
    return after if before == after or not before else f'{before} -> {after or "-"}'


def _seconds(line: LineTime | None) -> str:
    return '-' if line is None else f'{line.total:.2f}'
