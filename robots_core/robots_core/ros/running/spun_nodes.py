"""SpunNodes: nodes that a thread of their own spins."""

import contextlib
import threading
from collections.abc import Callable, Sequence

from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

from robots_core.ros.running.lean_executor import LeanExecutor


class SpunNodes:
    """Nodes of one context, spun by a thread of their own.

    Args:
        nodes: The nodes.
        name: Of the thread.
    """

    def __init__(self, nodes: Sequence[Node], name: str) -> None:
        self._nodes = nodes
        self._executor = LeanExecutor(context=nodes[0].context)
        self._ended = threading.Event()
        for node in nodes:
            self._executor.add_node(node)
        self._thread = threading.Thread(target=self._spin, name=name, daemon=True)
        self._thread.start()

    def _spin(self) -> None:
        with contextlib.suppress(ExternalShutdownException):
            while not self._ended.is_set():
                self._executor.spin_once()

    def call(self, function: Callable[[], None]) -> None:
        """Call a function in the thread."""
        self._executor.create_task(function)

    def stop(self) -> None:
        """End the thread."""
        self._ended.set()
        self._executor.wake()
        self._thread.join()

    def end(self) -> None:
        """End the thread, and destroy the nodes."""
        self.stop()
        for node in self._nodes:
            node.destroy_node()
        self._executor.shutdown()
