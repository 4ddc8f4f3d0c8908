"""Connection: a node of a client's own, and the services of a cell that it calls."""

import os

import rclpy
from rclpy.context import Context

from robots_controller.client.cell_services import CellServices
from robots_core.ros.running.middleware import choose_transports
from robots_core.ros.running.spun_nodes import SpunNodes
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
        self._spinning = SpunNodes((node,), 'cell client')

    def close(self) -> None:
        """End the thread and the node."""
        self._spinning.end()
        self._context.try_shutdown()
