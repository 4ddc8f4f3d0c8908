"""study: simulate a program over a grid of robots, drives, speeds and parameters."""

import argparse
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from robots_controller.commands.json_output import print_json
from robots_controller.study.run_case import FIGURES, Row
from robots_controller.study.study_file import read_study
from robots_controller.terminal_table import Kind, TerminalTable
from robots_core.errors import InstallationError
from robots_core.exit_codes import ExitCode

MOST_ROWS = 40  # shown in the terminal
SHOWN = {
    'cycle_time': 'cycle time s',
    'energy': 'energy J',
    'velocity_use': 'velocity of limit',
    'torque_use': 'torque of limit',
}
LIBRARIES = {'pyarrow', 'distributed'}  # of requirements-study.txt


def study(options: argparse.Namespace, console: Console) -> int:
    """Run a study.

    Returns:
        An exit code: OK if all cases succeeded.

    Raises:
        RobotsError: a study that is not valid, or a library that is not installed.
    """
    folder = options.output or Path('out') / Path(options.study).stem
    columns = (TextColumn('cases'), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    try:
        from robots_controller.study.run_study import run_study  # noqa: PLC0415  # needs their libraries

        grid = read_study(options.study)
        with Progress(*columns, console=console, transient=True) as progress:
            task = progress.add_task('cases', total=None)
            rows = run_study(
                grid,
                folder,
                scheduler=options.scheduler,
                workers=options.workers,
                on_progress=lambda done, count: progress.update(task, completed=done, total=count),
            )
    except ModuleNotFoundError as error:
        if error.name not in LIBRARIES:
            raise
        raise InstallationError(
            f'studies need {error.name}, which is not installed: make study-requirements, '
            f'or pip install -r requirements-study.txt'
        ) from error
    except KeyboardInterrupt:
        console.print(f'interrupted; the same command goes on. So far: {folder}/results.csv')
        raise
    if options.json:
        print_json(rows)
    else:
        _show(rows, console)
    console.print(f'{folder}/results.csv, {folder}/results.parquet')
    return ExitCode.OK if all(row['ok'] for row in rows) else ExitCode.FAILED


def _show(rows: list[Row], console: Console) -> None:
    settings = [name for name in rows[0] if name not in FIGURES] if rows else []
    columns: list[tuple[str, Kind]] = [(name, 'text') for name in settings]
    columns += [(title, 'number') for title in SHOWN.values()]
    cells = [
        (
            *(escape(str(row[name])) for name in settings),
            *(f'{row[name]:.4g}' for name in SHOWN),
            f'[red]{escape(row["reason"])}[/]' if row['reason'] else '',
        )
        for row in rows[:MOST_ROWS]
    ]
    TerminalTable([*columns, ('reason', 'text')], cells, keys=max(1, len(settings))).show(console)
    failed = sum(not row['ok'] for row in rows)
    more = f', the first {MOST_ROWS} shown' if len(rows) > MOST_ROWS else ''
    console.print(f'{len(rows)} cases, {failed} failed{more}')
