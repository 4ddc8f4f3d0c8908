"""Generated messages, files and programs for some time, how many, and what failed: make fuzz."""

import argparse
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from counted_cases import FILE, counted_cases
from printed_tables import machine, show
from robots_controller.report.tables import ReportTable, Row

TESTS: Final = Path(__file__).parents[1]
PYTEST: Final = ('-m', 'pytest', '-q', '--timeout', '0', '--hypothesis-profile=fuzz', '--tb=short', '-x')
DAMAGED: Final = (
    *('scenes', 'frames', 'urdfs', 'limits', 'io_maps', 'contacts', 'plc_scripts', 'drivers', 'orbits'),
    *('cabins', 'studies', 'accesses', 'points', 'values', 'programs', 'meshes'),
)
PROGRAMS_AT_ONCE: Final = 10
LONGEST_STEP: Final = 300.0  # s: all kinds have their turn
FINDING: Final = re.compile(r'\d+ failed|Falsifying example|^seed \d+ \(', re.MULTILINE)
END_TIME: Final = 60.0  # s for what is under way then
SHOWN: Final = 6000  # characters of a failure


@dataclass(frozen=True)
class Step:
    """One process of generated cases.

    Attributes:
        kind: Of its cases.
        command: After `python`.
        environment: Besides this process' own: makes the cases come again.
    """

    kind: str
    command: tuple[str, ...]
    environment: dict[str, str] = field(default_factory=dict)

    @property
    def again(self) -> str:
        """The command that tries the same cases again: what failed is tried first."""
        values = ' '.join(f'{name}={value}' for name, value in self.environment.items())
        return f'{values} python {" ".join(self.command)}'.strip()


def steps(rng: random.Random, nodes: Sequence[str]) -> Iterator[Step]:
    """Steps without end: all kinds in turn, and all nodes."""
    messages = _shuffled(rng, nodes)
    every_message = f'{TESTS}/node/test_message_fuzz.py::test_every_topic_of_every_node_takes_any_message'
    files = _shuffled(rng, DAMAGED)
    lua = str(TESTS / 'property' / 'test_lua_laws.py')
    while True:
        yield Step('messages', (*PYTEST, f'{every_message}[{next(messages)}]'))
        yield Step(
            'damaged files', (*PYTEST, f'{TESTS}/property/test_damaged_files.py::test_damaged_{next(files)}')
        )
        yield Step('Lua', (*PYTEST, lua))
        seed = str(rng.randrange(10**9))
        programs = f'{TESTS / "node" / "test_lua_fuzz.py"}::test_random_programs'
        yield Step('Lua', (*PYTEST, programs), {'FUZZ_SEED': seed})
        first = str(rng.randrange(10**6))
        run = ('-m', 'cell.generated.run_seeds', first, str(PROGRAMS_AT_ONCE), '1', 'simulated')
        yield Step('generated programs', run, {'PYTHONPATH': f'$PYTHONPATH:{TESTS}'})


def _shuffled(rng: random.Random, names: Sequence[str]) -> Iterator[str]:
    while True:
        yield from rng.sample(names, len(names))


class Fuzz:
    """Runs steps at once until the time is over, and keeps what failed.

    Args:
        end: Time of `time.monotonic`, s.
        folder: For the counts.
    """

    def __init__(self, end: float, folder: Path) -> None:
        self._end, self._counts = end, folder / 'cases'
        self._lock = threading.Lock()
        self.failures: Counter[str] = Counter()
        self.processes: Counter[str] = Counter()

    def work(self, pending: Iterator[Step]) -> None:
        """One process after the other; several threads share the steps."""
        while time.monotonic() < self._end:
            with self._lock:
                step = next(pending)
            self.run(step)

    def run(self, step: Step) -> None:
        """Run one step to its end, or to that of the time; print it if it failed."""
        environment = {**os.environ, FILE: str(self._counts)}
        environment |= {name: os.path.expandvars(value) for name, value in step.environment.items()}
        process = subprocess.Popen(
            [sys.executable, *step.command],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors='replace',
            env=environment,
            start_new_session=True,  # Ctrl-C ends the steps through this process alone
        )
        try:
            output, _ = process.communicate(timeout=min(LONGEST_STEP, max(1.0, self._end - time.monotonic())))
            failed = process.returncode != 0
        except subprocess.TimeoutExpired:
            # Not SIGINT, which ends the contexts of nodes: the tests would take that for their failure.
            os.killpg(process.pid, signal.SIGTERM)
            try:
                output, _ = process.communicate(timeout=END_TIME)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                output, _ = process.communicate()
            failed = has_finding(output)
        with self._lock:
            self.processes[step.kind] += 1
            self.failures[step.kind] += failed
            if failed:
                print(f'{output[-SHOWN:]}\nagain: {step.again}\n', flush=True)

    def table(self) -> ReportTable:
        """What was tried."""
        return result_table(counted_cases(self._counts), self.failures, self.processes)


def has_finding(output: str) -> bool:
    """A step that the end of the time has ended had found something, whatever its exit code is then."""
    return FINDING.search(output) is not None


def result_table(cases: Counter[str], failures: Counter[str], processes: Counter[str]) -> ReportTable:
    """A row for each kind, and one for all."""
    rows = [
        Row(
            (kind, str(cases[kind]), str(processes[kind]), str(failures[kind])),
            bad=failures[kind] > 0,
            trends={3: 'worse'} if failures[kind] else {},
        )
        for kind in sorted({*cases, *processes})
    ]
    total = (str(sum(counter.values())) for counter in (cases, processes, failures))
    columns = (('kind', 'text'), ('cases', 'number'), ('processes', 'number'), ('failed', 'number'))
    return ReportTable('Generated cases', columns, (*rows, Row(('all', *total))))


def node_names() -> list[str]:
    """Nodes that get messages, as their test names them."""
    test = str(TESTS / 'node' / 'test_message_fuzz.py')
    listed = subprocess.run(
        [sys.executable, '-m', 'pytest', '--collect-only', '-q', test],
        capture_output=True,
        text=True,
        check=True,
    )
    return re.findall(r'takes_any_message\[(\w+)\]', listed.stdout)


def main() -> int:
    """Try cases, print what failed and how many there were; returns 1 if one failed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('duration', type=float, help='s')
    parser.add_argument('--seed', type=int, default=None, help='of the order; another one each time')
    parser.add_argument('--workers', type=int, default=os.cpu_count() or 1)
    parser.add_argument('--markdown', action='store_true', help='the table as Markdown')
    options = parser.parse_args()
    seed = random.SystemRandom().randrange(10**6) if options.seed is None else options.seed
    began = time.monotonic()
    with tempfile.TemporaryDirectory(prefix='fuzz_') as folder:
        fuzz = Fuzz(began + options.duration, Path(folder))
        pending = steps(random.Random(seed), node_names())  # noqa: S311  # no secret
        with ThreadPoolExecutor(options.workers) as pool:
            for worker in [pool.submit(fuzz.work, pending) for _ in range(options.workers)]:
                worker.result()
        show(fuzz.table(), markdown=options.markdown)
    print(f'seed {seed}, {(time.monotonic() - began) / 60.0:.1f} minutes; {machine()}')
    return 1 if sum(fuzz.failures.values()) else 0


if __name__ == '__main__':
    sys.exit(main())
