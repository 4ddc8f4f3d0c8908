"""The processes of a cell's nodes."""

from __future__ import annotations

import gc
from pathlib import Path

import pytest

from robots_controller.live_cell.cell_graph import NodeDescription
from robots_controller.live_cell.processes.node_processes import NodeProcesses


@pytest.mark.usefixtures('ros_domain')
def test_processes_that_have_ended_hold_no_file_descriptors(tmp_path: Path) -> None:
    node = NodeDescription('robots_controller', 'plc_node')

    def run_and_count() -> int:
        processes = NodeProcesses([node], namespace='/', log_folder=tmp_path)
        processes.start()
        processes.kill(node.executable)
        processes.stop()
        assert not processes.runs(node.executable)
        (ended,) = processes.take_dead()
        assert ended.reason == 'killed by SIGKILL'
        del processes, ended
        gc.collect()
        return len(list(Path('/proc/self/fd').iterdir()))

    first = run_and_count()  # with those of the server that forks
    assert [run_and_count() for _ in range(3)] == [first] * 3
