"""Cells for tests, each in a ROS domain of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from .cell_process import CellProcess

PROGRAMS = Path(__file__).parents[2] / 'programs'


@pytest.fixture
def start_cell(ros_domain: int, tmp_path: Path) -> Iterator[Callable[..., CellProcess]]:
    """Starts `cell` with the given options; ends it after the test."""
    del ros_domain
    cells: list[CellProcess] = []

    def start(*options: str) -> CellProcess:
        # Any free port: cells of several tests may run at once.
        cells.append(CellProcess(*options, '--port', '0', out=tmp_path / 'out'))
        return cells[-1]

    yield start
    for cell in cells:
        cell.close()
