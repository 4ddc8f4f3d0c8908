"""study: simulate a program over a grid of robots, drives, speeds and parameters."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from robots_controller.cell_arguments import EXIT_FAILED, EXIT_OK, exit_code
from robots_controller.study.run_case import FIGURES, Row
from robots_controller.study.study_file import read_study
from robots_core.errors import RobotsError

MOST_ROWS = 40  # shown in the terminal
SHOWN = ('cycle_time', 'energy', 'velocity_use', 'torque_use')
LIBRARIES = {'pyarrow', 'distributed'}  # of requirements-study.txt


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a study.

    Returns:
        0 if all cases succeeded, 1 if some failed, 2 for a bad study, 130 after Ctrl-C.
    """
    parser = argparse.ArgumentParser(prog='study', description=__doc__)
    parser.add_argument('study', type=Path, metavar='FILE', help='YAML file with the grid')
    parser.add_argument(
        '-o',
        '--output',
        type=Path,
        metavar='FOLDER',
        help='folder for the results; out/<name of the file> by default',
    )
    parser.add_argument(
        '--scheduler',
        default='',
        metavar='ADDRESS',
        help='run on the workers of the Dask scheduler at this address',
    )
    parser.add_argument(
        '--workers',
        type=int,
        default=0,
        help='number of processes on this machine; one for each core by default',
    )
    options = parser.parse_args(arguments)
    return exit_code(lambda console: _study(options, console))


def _study(options: argparse.Namespace, console: Console) -> int:
    folder = options.output or Path('out') / options.study.stem
    columns = (TextColumn('cases'), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    try:
        from robots_controller.study.run_study import run_study  # noqa: PLC0415  # needs their libraries

        study = read_study(options.study)
        with Progress(*columns, console=console, transient=True) as progress:
            task = progress.add_task('cases', total=None)
            rows = run_study(
                study,
                folder,
                scheduler=options.scheduler,
                workers=max(0, options.workers),
                on_progress=lambda done, count: progress.update(task, completed=done, total=count),
            )
    except ModuleNotFoundError as error:
        if error.name not in LIBRARIES:
            raise
        raise RobotsError(
            f'studies need {error.name}, which is not installed: make study-requirements, '
            f'or pip install -r requirements-study.txt'
        ) from error
    except KeyboardInterrupt:
        console.print(f'interrupted; the same command goes on. So far: {folder}/results.csv')
        raise
    _show(rows, console)
    console.print(f'{folder}/results.csv, {folder}/results.parquet')
    return EXIT_OK if all(row['ok'] for row in rows) else EXIT_FAILED


def _show(rows: list[Row], console: Console) -> None:
    table = Table(box=SIMPLE_HEAD, header_style='bold', pad_edge=False)
    settings = [name for name in rows[0] if name not in FIGURES] if rows else []
    for name in settings:
        table.add_column(name, no_wrap=True)
    for name in SHOWN:
        table.add_column(name.replace('_', '\n'), justify='right', no_wrap=True)
    table.add_column('reason', overflow='fold')
    for row in rows[:MOST_ROWS]:
        reason = f'[red]{escape(row["reason"])}[/]' if row['reason'] else ''
        table.add_row(*(str(row[n]) for n in settings), *(f'{row[n]:.4g}' for n in SHOWN), reason)
    console.print(table)
    failed = sum(not row['ok'] for row in rows)
    more = f', the first {MOST_ROWS} shown' if len(rows) > MOST_ROWS else ''
    console.print(f'{len(rows)} cases, {failed} failed{more}')


if __name__ == '__main__':
    sys.exit(main())
