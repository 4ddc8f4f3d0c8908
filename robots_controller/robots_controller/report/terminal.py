"""The report in a terminal."""

from collections.abc import Sequence

from rich.console import Console
from rich.markup import escape

from robots_controller.report.motion_columns import SUMMARY, VERDICT, Column
from robots_controller.report.run_report import RunReport
from robots_controller.report.tables import line_table, motion_table


def show_report(report: RunReport, console: Console) -> None:
    """Print times by line, figures by motion and the sums."""
    run = report.run
    console.print(f'[bold]{escape(report.title)}[/]  {escape(run.source)}', highlight=False)
    line_table(report).show(console)
    show_verdict(report, console, SUMMARY)
    for text in summary(report):
        console.print(text, highlight=False)


def show_verdict(report: RunReport, console: Console, columns: Sequence[Column] = VERDICT) -> None:
    """Print figures by motion, what went wrong, and a closing line."""
    if report.motions:
        motion_table(report, columns).show(console)
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
    lines = [f'cycle time {run.duration:.2f} s: {split}']
    lines.append(
        f'mechanical energy {report.energy.sum() / 1e3:.2f} kJ, '
        f'by {"the torques of the drives" if report.signals.measured else "inverse dynamics"}'
    )
    if report.clearance is not None:
        lines.append(f'smallest distance {report.clearance.describe()}')
    return tuple(lines)


def _praise(report: RunReport) -> str:
    if not report.ok:
        return ''
    count = len(report.motions)
    early = sum(item.motion.ended_early for item in report.motions)
    motions = f': {count} motion{"" if count == 1 else "s"}, '
    others = f'{early} ended by the program, every other target reached' if early else 'every target reached'
    return f'{motions}{others}, every limit kept'
