"""Recording: bags that a person begins and ends on the operator's page, and reports on them."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import Final

from robots_core.errors import BagError, NotNowError

END_TIME: Final = 30.0  # s, to close a bag
REPORT_TIME: Final = 300.0  # s
METADATA: Final = 'metadata.yaml'
ROBOTS: Final = 'robots_controller.commands.robots'


class Recording:
    """Records all topics of a cell by a process of its own: writing does not hold up the page."""

    def __init__(self, folder: Path, robot: str, namespace: str = '/') -> None:
        self._folder, self._robot, self._namespace = folder, robot, namespace
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._bag = ''

    @property
    def bag(self) -> str:
        """The bag that is written now; '' for none."""
        process = self._process
        return self._bag if process is not None and process.poll() is None else ''

    def begin(self) -> None:
        """Begin a bag.

        Raises:
            NotNowError: one is written already.
            BagError: its folder cannot be made.
        """
        with self._lock:
            if self.bag:
                raise NotNowError(
                    f'{self.bag} is recorded already; end it first', key='recorded', bag=str(self.bag)
                )
            path = self._folder / f'recorded_{time.strftime("%Y%m%d-%H%M%S")}' / 'bag'
            try:
                path.parent.mkdir(parents=True)
            except OSError as error:
                raise BagError(f'no bag can be written to {path.parent}: {error.strerror}') from error
            module = 'robots_controller.nodes.bags.record_bag'
            self._process = subprocess.Popen(  # noqa: S603  # our own module
                [sys.executable, '-m', module, str(path), self._namespace], stdin=subprocess.PIPE
            )
            self._bag = str(path)

    def end(self) -> None:
        """Close the bag, if one is written.

        Raises:
            BagError: it was not recorded to its end.
        """
        with self._lock:
            process, self._process = self._process, None
            if process is None:
                return
            assert process.stdin is not None
            process.stdin.close()  # it ends with this process too
            try:
                code = process.wait(END_TIME)
            except subprocess.TimeoutExpired:
                process.kill()
                code = process.wait()
            if code:
                raise BagError(f'{self._bag} was not recorded to its end; the log says why')

    def report(self) -> str:
        """The report of the newest bag, as a page.

        Raises:
            BagError: there is none, or it cannot be reported on.
        """
        bags = [path.parent for path in self._folder.glob(f'*/bag/{METADATA}')]
        if not bags:
            raise BagError(
                f'there is no bag in {self._folder}; record one, or start cell with --record',
                key='none',
                folder=str(self._folder),
            )
        newest = max(bags, key=lambda bag: max(file.stat().st_mtime for file in bag.iterdir()))
        with tempfile.TemporaryDirectory() as temporary:
            page = Path(temporary) / 'report.html'
            command = [sys.executable, '-m', ROBOTS, 'report', str(newest), '-o', str(page)]
            command += ['--robot', self._robot, '--namespace', self._namespace]
            try:
                made = subprocess.run(  # noqa: S603  # our own command
                    command, capture_output=True, text=True, timeout=REPORT_TIME, check=False
                )
            except subprocess.TimeoutExpired as error:
                raise BagError(f'no report on {newest}: it takes more than {REPORT_TIME:g} s') from error
            if not page.is_file():
                raise BagError(f'no report on {newest}: {(made.stderr or made.stdout).strip()}')
            return page.read_text('utf-8')
