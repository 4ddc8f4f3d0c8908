"""Connection: a node of a client's own, and the services of a cell that it calls."""

import contextlib
import os
import threading

import rclpy
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException

from robots_controller.client.cell_services import CellServices
from robots_core.ros.running.lean_executor import LeanExecutor
from robots_core.ros.running.middleware import choose_transports
from robots_core.ros.timed_node import TimedNode


class Connection(CellServices):
    """A node in a context of its own, spun by a thread of its own.

    Args:
        namespace: Namespace of the cell.
        domain: ROS domain of the cell; that of the environment (ROS_DOMAIN_ID) by default.
        patience: Longest wait for an answer, s.
    """

    def __init__(self, namespace: str, domain: int | None, patience: float) -> None:
        choose_transports()
        self._context = Context()
        rclpy.init(context=self._context, domain_id=domain)
        node = TimedNode(
            f'cell_client_{os.getpid()}',
            namespace=namespace,
            context=self._context,
            start_parameter_services=False,
        )
        super().__init__(node, patience)
        self._executor = LeanExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._spin, name='cell client', daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End the thread and the node."""
        self._ended.set()
        self._executor.wake()
        self._thread.join()
        self.node.destroy_node()
        self._executor.shutdown()
        self._context.try_shutdown()

    def _spin(self) -> None:
        with contextlib.suppress(ExternalShutdownException):
            while not self._ended.is_set():
                self._executor.spin_once()
