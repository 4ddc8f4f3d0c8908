"""Record all topics of a cell into a bag, until the standard input ends."""

from __future__ import annotations

import sys
import threading
from pathlib import Path
from typing import Final

import rclpy
from rclpy.signals import SignalHandlerOptions

from robots_controller.nodes.bags.bag_recorder import BagRecorder
from robots_core.exit_codes import ExitCode
from robots_core.process_end import bounded_end
from robots_core.ros.running.spun_nodes import SpunNodes

CHECK_PERIOD: Final = 0.1  # s, how soon a problem ends the recording


def main() -> int:
    """Record; returns an exit code."""
    path, namespace = sys.argv[1:]
    # Ctrl-C reaches all processes of a terminal: the bag is closed when the other one is gone.
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    recorder = BagRecorder(Path(path), namespace=namespace)
    spinning = SpunNodes((recorder,), 'bag recorder')
    reading = threading.Thread(target=sys.stdin.buffer.read, daemon=True)
    reading.start()
    try:
        while reading.is_alive() and not recorder.problem:
            reading.join(CHECK_PERIOD)
    finally:
        recorder.close()
        with bounded_end():
            spinning.end()
            rclpy.shutdown()
    return ExitCode.FAILED if recorder.problem else ExitCode.OK


if __name__ == '__main__':
    sys.exit(main())
