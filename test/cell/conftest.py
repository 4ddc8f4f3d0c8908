"""Cells for tests, each in a ROS domain of its own."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from .cell_process import CellProcess, CellThread
from .lockstep_runs import LockstepRuns


@pytest.fixture(scope='session')
def lockstep_runs(session_ros_domain: int, tmp_path_factory: pytest.TempPathFactory) -> LockstepRuns:
    """Programs that the nodes have run in lock-step."""
    del session_ros_domain
    folder = tmp_path_factory.getbasetemp()
    # Those of the processes of one test run are beside each other.
    shared = folder.parent if 'PYTEST_XDIST_WORKER' in os.environ else folder
    return LockstepRuns(shared / 'lockstep')


@pytest.fixture
def start_cell(ros_domain: int, tmp_path: Path) -> Iterator[Callable[..., CellThread]]:
    """Starts a cell without a 3D view, with the given options, one at a time; ends it after the test."""
    del ros_domain
    cells: list[CellThread] = []

    def start(*options: str) -> CellThread:
        cells.append(CellThread(*options, '--headless', out=tmp_path / 'out'))
        return cells[-1]

    yield start
    for cell in cells:
        cell.close()


@pytest.fixture
def start_process(ros_domain: int, tmp_path: Path) -> Iterator[Callable[..., CellProcess]]:
    """The same for the command `cell`, with the view that it has by default."""
    del ros_domain
    cells: list[CellProcess] = []

    def start(*options: str) -> CellProcess:
        # Any free port: cells of several tests may run at once.
        cells.append(CellProcess(*options, '--port', '0', out=tmp_path / 'out'))
        return cells[-1]

    yield start
    for cell in cells:
        cell.close()
