"""Record all topics of a cell into a bag, until the standard input ends."""

from __future__ import annotations

import sys
import threading
from pathlib import Path

import rclpy
from rclpy.signals import SignalHandlerOptions

from robots_controller.nodes.bags.bag_recorder import BagRecorder
from robots_core.exit_codes import ExitCode
from robots_core.process_end import bounded_end
from robots_core.ros.running.lean_executor import LeanExecutor


def main() -> int:
    """Record; returns an exit code."""
    path, namespace = sys.argv[1:]
    # Ctrl-C reaches all processes of a terminal: the bag is closed when the other one is gone.
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    ended = threading.Event()
    executor = LeanExecutor()

    def wait_for_end() -> None:
        sys.stdin.buffer.read()
        ended.set()
        executor.wake()

    recorder = BagRecorder(Path(path), namespace=namespace)
    executor.add_node(recorder)
    threading.Thread(target=wait_for_end, daemon=True).start()
    try:
        while not ended.is_set() and not recorder.problem:
            executor.spin_once()
    finally:
        recorder.close()
        with bounded_end():
            recorder.destroy_node()  # type: ignore[no-untyped-call]
            executor.shutdown()
            rclpy.shutdown()
    return ExitCode.FAILED if recorder.problem else ExitCode.OK


if __name__ == '__main__':
    sys.exit(main())
