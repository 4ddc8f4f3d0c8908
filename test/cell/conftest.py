"""Cells for tests, each in a ROS domain of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from .cell_process import CellProcess
from .live_runs import LiveRuns


@pytest.fixture(scope='session')
def live_runs(session_ros_domain: int, tmp_path_factory: pytest.TempPathFactory) -> LiveRuns:
    """Programs that have run in a live cell."""
    del session_ros_domain
    return LiveRuns(tmp_path_factory.mktemp('live'))


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
