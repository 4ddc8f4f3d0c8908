"""run_study: all cases of a study that have no result yet."""

from collections.abc import Callable
from pathlib import Path

from robots_controller.study.case_runners import run_locally, run_on_scheduler
from robots_controller.study.run_case import Row
from robots_controller.study.study_file import Study
from robots_controller.study.study_results import StudyResults


def run_study(
    study: Study,
    folder: Path | str,
    *,
    scheduler: str = '',
    workers: int = 0,
    on_progress: Callable[[int, int], None] | None = None,
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
    report = on_progress or (lambda _done, _all: None)
    report(done, len(cases))
    try:
        if left:
            found = run_on_scheduler(left, scheduler) if scheduler else run_locally(left, workers=workers)
            for case, row in found:
                if row is not None:
                    results.add(case, row)
                    done += 1
                    report(done, len(cases))
    finally:
        results.write(cases)
    return results.rows(cases)
