"""Programs of programs/, each run by the real nodes in lock-step once, for all tests."""

from __future__ import annotations

import fcntl
import io
import json
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from cell_options import parse_options
from robots_controller.live_cell.cell_command import run_cell
from robots_core.blocks.drives.drive_choice import DRIVE_LEVELS
from robots_core.defaults import RATE
from short_programs import SHORTENED, SHORTEST, short_copy

WIDTH = 120
FULL = 'second_order'
SEPARATE = ('welding.lua', 'welding_collision.lua', 'laser_seam.lua')
SPARSE_RATE, DENSE_RATE = 50.0, 100.0  # Hz, of the references
COMPARED_RATE = 12.5  # of runs that are only compared with simulations
# By default 250 Hz, in the demo. The laser's motions take 0.05 s each; a gripper misses its ring at 50 Hz,
# unless it reaches far.
RATES = {('welding.lua', FULL): 250.0}
RATES |= {('laser_seam.lua', drive): DENSE_RATE for drive in DRIVE_LEVELS}
RATES |= {('debris_removal.lua', drive): 25.0 for drive in DRIVE_LEVELS}
# What touches something, or is guided.
DENSE = ('debris_removal', 'motion_simulator', 'wheel_laboratory')
RATES |= {(f'{name}.lua', FULL): DENSE_RATE for name in DENSE}


@dataclass(frozen=True)
class LockstepRun:
    """A program that has run.

    Attributes:
        program: The shortened copy.
        returncode: Of `cell`.
        text: Its output.
        bag: Its recording.
        rate: Of the references, Hz.
    """

    program: Path
    returncode: int
    text: str
    bag: Path
    rate: float = RATE


class LockstepRuns:
    """Runs programs in lock-step, in the cells that they name; each once for all processes of the tests.

    Args:
        folder: For their copies and bags, shared by these processes.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def run(self, program: str, drive: str = FULL) -> LockstepRun:
        """The run of a program, by its file in programs/, with drives of a level.

        With drives of level `FULL` the nodes of the programs `SEPARATE` have a process each; all others share
        a process, without a view. References have the rate of `RATES`, or `SPARSE_RATE`, with other drives
        `COMPARED_RATE`.
        """
        separate = drive == FULL and program in SEPARATE
        rate = RATES.get((program, drive), SPARSE_RATE if drive == FULL else COMPARED_RATE)
        options = ['--lockstep', '--drive', drive, '--rate', str(rate)]
        if not separate:
            options += ['--composed', '--headless']
        folder = self._folder / f'{program.replace("/", "_")}_{drive}'
        folder.mkdir(parents=True, exist_ok=True)
        result = folder / 'result.json'
        with (folder / 'lock').open('w') as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not result.exists():
                path = short_copy(folder / 'programs', program, SHORTENED if drive == FULL else SHORTEST)
                found = run_cell_with(path, folder / 'out', *options)
                result.write_text(json.dumps(found))
        values = json.loads(result.read_text())
        return LockstepRun(Path(values[0]), values[1], values[2], Path(values[3]), rate)

    def run_file(self, program: Path, *options: str, rate: float = SPARSE_RATE) -> LockstepRun:
        """The run of any other program with these options of `cell`, in one process, recorded beside it."""
        options = ('--lockstep', '--composed', '--headless', '--rate', str(rate), *options)
        path, code, text, bag = run_cell_with(program, program.parent / 'out', *options)
        return LockstepRun(Path(path), code, text, Path(bag), rate)


def run_cell_with(path: Path, out: Path, *options: str) -> tuple[str, int, str, str]:
    """A program in a cell: program, exit code, output and bag."""
    text = io.StringIO()
    arguments = ('--program', str(path), '--once', '--port', '0', '--record', str(out))
    # In this process: the server that the nodes are forked from is started once for all runs.
    code = run_cell(parse_options([*arguments, *options]), Console(file=text, width=WIDTH))
    return str(path), code, text.getvalue(), str(next(out.glob('*/bag')))
