"""The nodes in lock-step and the simulation do the same, to the last bit."""

from pathlib import Path

import pytest

from robots_core.blocks.drives.drive_level import DRIVE_LEVELS

from .both_cells import check_both_cells
from .lockstep_runs import PROGRAMS, LockstepRuns

NAMES = sorted(file.name for file in PROGRAMS.glob('*.lua'))
CASES = [(name, drive) for name in NAMES for drive in DRIVE_LEVELS]
# Of guidance without a recording there is nothing to compare.
LANGUAGE = sorted(f'language/{file.name}' for file in (PROGRAMS / 'language').glob('*.lua'))
CASES += [(name, 'rigid_body') for name in LANGUAGE if name != 'language/guided.lua']


@pytest.mark.parametrize(('name', 'drive'), CASES)
def test_both_cells_do_the_same(name: str, drive: str, lockstep_runs: LockstepRuns, tmp_path: Path) -> None:
    check_both_cells(lockstep_runs.run(name, drive), drive, tmp_path / 'bag')
