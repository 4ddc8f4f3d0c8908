"""Connection: a node of a client's own, and the services of a cell that it calls."""

import contextlib
import os
import threading
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException
from std_srvs.srv import Trigger

from robots_core.errors import NoAnswerError, NotNowError
from robots_core.ros.lean_executor import LeanExecutor
from robots_core.ros.middleware import choose_transports
from robots_core.ros.timed_node import TimedNode


class Connection:
    """A node in a context of its own, spun by a thread of its own.

    Args:
        namespace: Namespace of the cell.
        domain: ROS domain of the cell; that of the environment (ROS_DOMAIN_ID) by default.
        patience: Longest wait for an answer, s.
    """

    def __init__(self, namespace: str, domain: int | None, patience: float) -> None:
        self.patience = patience
        self._clients: dict[str, Any] = {}
        choose_transports()
        self._context = Context()
        rclpy.init(context=self._context, domain_id=domain)
        self.node = TimedNode(
            f'cell_client_{os.getpid()}',
            namespace=namespace,
            context=self._context,
            start_parameter_services=False,
        )
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

    def answer(self, service: str, kind: Any, request: Any) -> Any:
        """The answer of a service; not from a callback of the node.

        Args:
            service: Name below the namespace of the cell.
            kind: Type of the service.
            request: Its request.

        Raises:
            RobotsError: there is no such service, or it does not answer in time.
        """
        client, answered = self._client(service, kind), threading.Event()
        if client.wait_for_service(timeout_sec=self.patience):
            future = client.call_async(request)
            future.add_done_callback(lambda _: answered.set())
            if answered.wait(self.patience):
                return future.result()
        raise NoAnswerError(
            f'{client.service_name} has not answered for {self.patience:g} s: '
            f'is the cell running, in ROS domain {self._context.get_domain_id()}?'
        )

    def trigger(self, service: str) -> str:
        """Call a std_srvs/Trigger service; returns its message.

        Raises:
            RobotsError: it refuses, or does not answer.
        """
        answer = self.answer(service, Trigger, Trigger.Request())
        if not answer.success:
            raise NotNowError(answer.message)
        return str(answer.message)

    def send(self, service: str) -> None:
        """Call a std_srvs/Trigger service without waiting for its answer."""
        self._client(service, Trigger).call_async(Trigger.Request())

    def _client(self, service: str, kind: Any) -> Any:
        if service not in self._clients:
            self._clients[service] = self.node.create_client(kind, service)
        return self._clients[service]

    def _spin(self) -> None:
        with contextlib.suppress(ExternalShutdownException):
            while not self._ended.is_set():
                self._executor.spin_once()
