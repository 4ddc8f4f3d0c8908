"""A cell works for an hour; how late its loops are, and its memory: make soak DURATION=3600."""

import argparse
import signal
import sys
import tempfile
import threading
import time
from itertools import cycle
from pathlib import Path
from typing import Final

from chaos.surroundings import InCell
from printed_tables import machine, show
from robots_controller.report.page.page import write_page
from robots_core.robot_choice import load_robot_model
from ros_domains import reserved_domain
from waiting import POLL, happens

from .figures import SoakFigures, memory_figures
from .page import soak_page
from .processes import memory_of
from .summary import closing_line, loop_table, memory_table
from .worker import Worker

PROGRAMS: Final = Path(__file__).parent / 'programs'
START_TIME: Final = 600.0  # s
RUN_TIME: Final = 300.0  # s that a program may take
JOG_TIME: Final = 2.0  # s
STANDING_TIME: Final = 10.0  # s within which a robot that was jogged stands
SAMPLES: Final = 360  # of memory in a run, one in 10 s of an hour


class Shift:
    """One run: what is done in turn, what goes wrong, and the samples of memory.

    Args:
        cell: The cell.
        worker: Who works at it.
        duration: s.
    """

    def __init__(self, cell: InCell, worker: Worker, duration: float) -> None:
        self._cell, self._worker, self._duration = cell, worker, duration
        self._end = threading.Event()
        self.runs = self.jogs = 0
        self.problems: list[str] = []
        self.memory: list[tuple[float, dict[str, float]]] = []
        self.began = time.monotonic()

    def work(self) -> None:
        """Run the program, jog, and so on, until the time is over or the cell is of no use any more."""
        if not happens(lambda: self._worker.program_state == 'RUNNING', START_TIME):
            self.problems.append(f'the cell did not run its program within {START_TIME:g} s')
            return
        self._worker.begin()
        self.began = time.monotonic()
        sampler = threading.Thread(target=self._sample, name='memory', daemon=True)
        sampler.start()
        directions = cycle((1.0, -1.0))
        while not self._over and self._run_ended():
            self._jog(next(directions))
            if self._over or not self._start():
                break
        self._end.set()
        sampler.join()
        self.problems += self._restarts()

    @property
    def _over(self) -> bool:
        return time.monotonic() - self.began >= self._duration

    def _run_ended(self) -> bool:
        """The program came to its end; one that is under way when the time is over need not."""
        ended = happens(
            lambda: self._worker.program_state in {'FINISHED', 'FAILED', 'STOPPED'} or self._over, RUN_TIME
        )
        state = self._worker.program_state
        if self._over and state == 'RUNNING':
            return False
        if not ended or state != 'FINISHED':
            self.problems.append(
                f'after {time.monotonic() - self.began:.0f} s the program is {state or "unknown"}: '
                f'{self._worker.program_error}'
            )
            self._worker.call('controller_node/reset')
            return self._cell.cell_pid is not None
        self.runs += 1
        return True

    def _jog(self, direction: float) -> None:
        if not self._turn_to('T1'):
            return
        for axis in (0, 2, 4):
            self._worker.jog(axis, direction, JOG_TIME)
        self.jogs += 1
        self._turn_to('AUTOMATIC')

    def _turn_to(self, mode: str) -> bool:
        """Turn the mode switch as soon as the robot stands; whether it could be turned."""
        end = time.monotonic() + STANDING_TIME
        while problem := self._worker.set_mode(mode):
            if time.monotonic() > end:
                self.problems.append(f'{mode}: {problem}')
                return False
            time.sleep(POLL)
        return True

    def _start(self) -> bool:
        for service in ('lua_program_node/open', 'lua_program_node/run'):
            succeeded, message = self._worker.call(service)
            if not succeeded:
                self.problems.append(f'{service}: {message}')
                return self._cell.cell_pid is not None
        happens(lambda: self._worker.program_state == 'RUNNING', 5.0)
        return True

    def _sample(self) -> None:
        period = max(1.0, self._duration / SAMPLES)
        while not self._end.wait(period):
            pid = self._cell.cell_pid
            if pid is None:
                self.problems.append('the cell has ended')
                return
            self.memory.append((time.monotonic() - self.began, memory_of(pid)))

    def _restarts(self) -> list[str]:
        told = (' is started again in ', ' killed by ', ' ended with exit code ')
        return [line for line in self._cell.output.splitlines() if any(text in line for text in told)]


def main() -> int:
    """Work, print the tables, write the page; returns 1 if a goal was missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('duration', type=float, help='s')
    parser.add_argument('--page', type=Path, default=Path('out/soak.html'), help='file of the page')
    parser.add_argument('--markdown', action='store_true', help='the tables as Markdown')
    options = parser.parse_args()
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # the cell ends with this process
    program, before = PROGRAMS / 'shift.lua', machine()
    with tempfile.TemporaryDirectory(prefix='soak_') as name, reserved_domain() as environment:
        folder = Path(name)
        cell = InCell(
            program, environment, folder, io_map=PROGRAMS / 'plc.yaml', options=('--record', str(folder))
        )
        with Worker(load_robot_model(cell.robot), int(environment['ROS_DOMAIN_ID'])) as worker, cell:
            shift = Shift(cell, worker, options.duration)
            try:
                shift.work()
            except KeyboardInterrupt:
                shift.problems.append('interrupted')
            lasted = time.monotonic() - shift.began
            figures = SoakFigures(
                duration=lasted,
                runs=shift.runs,
                jogs=shift.jogs,
                inputs=worker.changes,
                problems=tuple(shift.problems),
                loops=worker.loops(),
                memory=memory_figures(shift.memory),
                recorded=sum(file.stat().st_size for file in folder.rglob('*.mcap')) / 1e6,
                machine=before,
            )
    for table in (loop_table(figures), memory_table(figures)):
        show(table, markdown=options.markdown)
    for line in figures.missed_goals:
        print(f'goal missed: {line}')
    print(f'{closing_line(figures)}\n{before}')
    write_page(options.page, soak_page(figures))
    print(f'page: {options.page}')
    return 1 if figures.missed_goals else 0


if __name__ == '__main__':
    sys.exit(main())
