"""Programs of programs/, each run in a live cell once, for all tests."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path

from .cell_process import CellProcess

PROGRAMS = Path(__file__).parents[2] / 'programs'
# Text of a program and what stands in its place, so that things are done once, nearer, or sooner.
SHORTENED = {
    'palletizing.lua': {
        'ROWS, COLUMNS, LAYERS, GAP = 2, 2, 2,': 'ROWS, COLUMNS, LAYERS, GAP = 1, 2, 1,',
        'PALLET = {1.20, -1.30, 0.10,': 'PALLET = {1.20, -0.60, 0.10,',
    },
    'press_tending.lua': {
        'PATIENCE = 2, 10': 'PATIENCE = 1, 10',
        'FEEDER = {0.30, 1.60, 0.70, 90,': 'FEEDER = {1.60, 0.80, 0.70, 30,',
        'TRAY = {0.30, -1.60, 0.70, -90,': 'TRAY = {1.60, -0.80, 0.70, -30,',
        # The wrist stays as it is at all three places.
        'ptpJointSpaceAngles(0, -100, 110, 0, 80, 0)': 'ptpJointSpaceAngles(0, -100, 110, 0, 80, -180)',
    },
    'three_axis_grasp.lua': {'setSpeed(0.3)': 'setSpeed(0.8)', 'wait(1)': 'wait(0.3)'},
    'wheel_test.lua': {
        'TRACK, RAMP = 0.80, 0.05': 'TRACK, RAMP = 0.10, 0.05',
        'LIFT = 1.80, 0.70, 0.15': 'LIFT = 1.80, 0.70, 0.05',
        'ipairs {0, 0.2}': 'ipairs {0.2}',
    },
    'rover_placement.lua': {
        'LIFT = 0.10': 'LIFT = 0.05',
        'wait(1) --': 'wait(0.3) --',
        'setSpeed(nil, 0.05, 20)': 'setSpeed(nil, 0.1, 20)',
        'setSpeed(0.5) --': 'setSpeed(1) --',
    },
}


@dataclass(frozen=True)
class LiveRun:
    """A program that has run.

    Attributes:
        program: The shortened copy.
        cell: Has ended.
    """

    program: Path
    cell: CellProcess


class LiveRuns:
    """Runs programs in the cells that they name.

    Args:
        folder: For their copies and bags.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._runs: dict[str, LiveRun] = {}

    def run(self, program: str) -> LiveRun:
        """The run of a program, by its file name; the same whenever it is asked for."""
        if program not in self._runs:
            folder = self._folder / program
            path = _copy(folder / 'programs' / program)
            cell = CellProcess('--program', str(path), '--once', '--port', '0', out=folder / 'out')
            try:
                cell.wait()
            finally:
                cell.close()
            self._runs[program] = LiveRun(path, cell)
        return self._runs[program]


def _copy(path: Path) -> Path:
    shutil.copytree(PROGRAMS, path.parent)
    text = path.read_text()
    for old, new in SHORTENED.get(path.name, {}).items():
        assert text.count(old) == 1
        text = text.replace(old, new)
    path.write_text(text)
    return path
