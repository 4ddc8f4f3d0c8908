"""run_study: all cases of a study that have no result yet, and StudyResults, which keeps their rows."""

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final

import pyarrow as pa  # type: ignore[import-untyped]
from pyarrow import csv, parquet

from robots_controller.study.case_runners import run_locally, run_on_scheduler
from robots_controller.study.run_case import FIGURES, Row
from robots_controller.study.study_case import StudyCase
from robots_controller.study.study_file import Study
from robots_core.errors import InvalidInputError
from robots_core.files.user_file import exists, read_text

ROWS: Final = 'rows.jsonl'
MAX_ROWS: Final = 1_000_000_000  # bytes
TABLE: Final = 'results'
_TYPES: Final = {bool: pa.bool_(), str: pa.string(), int: pa.int64(), float: pa.float64()}


class StudyResults:
    """Results of a study in a folder: `rows.jsonl` while it runs, `results.csv` and `results.parquet`.

    Args:
        folder: Made if it does not exist; rows of an earlier run are taken over.

    Raises:
        InvalidInputError: it cannot be made, or its rows are not such.
    """

    def __init__(self, folder: Path | str) -> None:
        self.folder = Path(folder)
        self._rows: dict[str, Row] = {}
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InvalidInputError(f'{folder} cannot hold results: {error.strerror}') from error
        rows = self.folder / ROWS
        text = read_text(rows, 'results of a study', largest=MAX_ROWS) if exists(rows) else ''
        lines = text.split('\n')
        # A line without its end was cut off; its case is simulated again.
        for number, line in enumerate(lines[:-1], 1):
            try:
                item = json.loads(line)
                self._rows[item['key']] = item['row']
            except (ValueError, KeyError, TypeError, RecursionError) as error:
                raise InvalidInputError(
                    f'{self.folder / ROWS}:{number}: no result of a study: {error}'
                ) from error
        if lines[-1]:
            (self.folder / ROWS).write_text('\n'.join([*lines[:-1], '']), encoding='utf-8')

    def __contains__(self, case: StudyCase) -> bool:
        return case.key in self._rows

    def add(self, case: StudyCase, row: Row) -> None:
        """Keep a row, on the disk too."""
        self._rows[case.key] = row
        with (self.folder / ROWS).open('a', encoding='utf-8') as file:
            file.write(json.dumps({'key': case.key, 'row': row}) + '\n')

    def rows(self, cases: Sequence[StudyCase]) -> list[Row]:
        """The rows of those cases that have one, in their order."""
        return [self._rows[case.key] for case in cases if case in self]

    def write(self, cases: Sequence[StudyCase]) -> tuple[Path, Path]:
        """Write the table; returns the paths of CSV and Parquet."""
        table = results_table(self.rows(cases))
        paths = self.folder / f'{TABLE}.csv', self.folder / f'{TABLE}.parquet'
        csv.write_csv(table, paths[0])
        parquet.write_table(table, paths[1])
        return paths


def results_table(rows: Sequence[Row]) -> Any:
    """Rows as a table (pyarrow.Table); a parameter with values of several kinds is text."""
    names = list(dict.fromkeys(name for row in rows for name in row)) or list(FIGURES)
    columns, fields = [], []
    for name in names:
        values = [row.get(name) for row in rows]
        kinds = {type(value) for value in values}
        kind = FIGURES.get(name) or (kinds.pop() if len(kinds) == 1 else str)
        fields.append(pa.field(name, _TYPES[kind]))
        columns.append(pa.array([kind(value) for value in values], type=_TYPES[kind]))
    return pa.Table.from_arrays(columns, schema=pa.schema(fields))


def run_study(
    study: Study,
    folder: Path | str,
    *,
    scheduler: str = '',
    workers: int = 0,
    on_progress: Callable[[int, int], None] = lambda _done, _all: None,
) -> list[Row]:
    """Simulate all cases of a study, and write `results.csv` and `results.parquet`.

    Cases whose result stands in the folder already are not simulated again, so that an interrupted study goes
    on where it was. The table has no times of the machine: it is the same however the cases were run.

    Args:
        study: The grid.
        folder: For the results.
        scheduler: Address of a Dask scheduler whose workers run the cases; '' for this machine's cores.
        workers: Number of processes on this machine; 0 for one for each core.
        on_progress: Called with how many of how many cases have a result.

    Returns:
        A row for each case, in the order of the grid; a case that fails has its reason.

    Raises:
        RobotsError: a file that cannot be read, a folder that cannot be written, or no scheduler.
    """
    cases = study.cases()
    results = StudyResults(folder)
    left = [case for case in cases if case not in results]
    done = len(cases) - len(left)
    on_progress(done, len(cases))
    try:
        if left:
            found = run_on_scheduler(left, scheduler) if scheduler else run_locally(left, workers=workers)
            for case, row in found:
                if row is not None:
                    results.add(case, row)
                    done += 1
                    on_progress(done, len(cases))
    finally:
        results.write(cases)
    return results.rows(cases)
