"""Where the cases of a study run: on all cores of this machine, or on the workers of a Dask scheduler."""

import multiprocessing
import os
import signal
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from typing import Any

from robots_controller.study.run_case import Row, failed_row, run_case
from robots_controller.study.study_case import StudyCase
from robots_core.errors import NoAnswerError

CONNECT_TIMEOUT = 10.0  # s

Result = tuple[StudyCase, Row | None]


def run_locally(cases: Sequence[StudyCase], *, workers: int = 0) -> Iterator[Result]:
    """Run cases in processes of this machine, by default one for each core; results as they come.

    A process that dies takes others with it: cases that were under way are run again one by one, and the one
    that dies again is a row with that reason.
    """
    again: list[StudyCase] = []
    with worker_pool(workers or os.cpu_count() or 1) as pool:
        waiting: dict[Future[Row | None], StudyCase] = {}
        try:
            waiting = {pool.submit(run_case, case): case for case in cases}
            for future in as_completed(waiting):
                try:
                    yield waiting[future], future.result()
                except BrokenProcessPool:
                    again.append(waiting[future])
        except BrokenProcessPool:  # it broke while cases were still handed in
            again = [case for case in cases if case not in waiting.values()]
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
    for case in again:
        with worker_pool(1) as pool:
            try:
                yield case, pool.submit(run_case, case).result()
            except BrokenProcessPool:
                yield case, failed_row(case, 'its process died: out of memory, or killed?')


def run_on_scheduler(cases: Sequence[StudyCase], address: str) -> Iterator[Result]:
    """Run cases on the workers of a Dask scheduler (tcp://host:port), results as they come.

    Each case carries its files. The workers need this package and the robots' plugins.

    Raises:
        RobotsError: no scheduler answers there.
    """
    import distributed  # noqa: PLC0415  # starts threads

    try:
        client: Any = distributed.Client(  # type: ignore[no-untyped-call]
            address, timeout=CONNECT_TIMEOUT, set_as_default=False
        )
    except (OSError, ValueError, TimeoutError) as error:
        raise NoAnswerError(f'no Dask scheduler answers at {address!r}: {error}') from error
    with client:
        futures = client.map(run_case, cases, key=[case.key for case in cases], pure=False, retries=1)
        found = {future.key: case for future, case in zip(futures, cases, strict=True)}
        for future in distributed.as_completed(futures, loop=client.loop):  # type: ignore[no-untyped-call]
            case, death = found[future.key], future.exception()
            yield case, future.result() if death is None else failed_row(case, f'its worker died: {death}')


def worker_pool(workers: int) -> ProcessPoolExecutor:
    """Processes that leave Ctrl-C to this one, which ends them."""
    # A fork would take over the threads' locks of this process, and not the threads.
    context = multiprocessing.get_context('spawn')
    return ProcessPoolExecutor(
        workers, mp_context=context, initializer=signal.signal, initargs=(signal.SIGINT, signal.SIG_IGN)
    )
