"""CellServices: the services of a cell, called from a node; Connection: those of a node of their own."""

import os
import threading
from collections.abc import Callable, Iterable
from typing import Any

import rclpy
from rclpy.context import Context
from std_srvs.srv import Trigger

from robots_core.errors import NoAnswerError, NotNowError
from robots_core.ros.running.middleware import choose_transports
from robots_core.ros.running.spun_nodes import SpunNodes
from robots_core.ros.timed_node import TimedNode


class CellServices:
    """Calls services below the namespace of a node.

    Args:
        node: Spun by another thread than those that wait for answers.
        patience: Longest wait for an answer, s.
    """

    def __init__(self, node: TimedNode, patience: float) -> None:
        self.node = node
        self.patience = patience
        self._clients: dict[str, Any] = {}

    def answer(self, service: str, kind: Any, request: Any) -> Any:
        """The answer of a service; not from a callback of the node.

        Raises:
            NoAnswerError: there is no such service, or it does not answer in time.
        """
        client, answered = self._client(service, kind), threading.Event()
        if client.wait_for_service(timeout_sec=self.patience):
            future = client.call_async(request)
            future.add_done_callback(lambda _: answered.set())
            if answered.wait(self.patience):
                return future.result()
        raise NoAnswerError(
            f'{client.service_name} has not answered for {self.patience:g} s: '
            f'is the cell running, in ROS domain {self.node.context.get_domain_id()}?'
        )

    def trigger(self, service: str) -> str:
        """Call a std_srvs/Trigger service; returns its message.

        Raises:
            NotNowError: it refuses.
            NoAnswerError: it does not answer.
        """
        answer = self.answer(service, Trigger, Trigger.Request())
        if not answer.success:
            raise NotNowError(answer.message)
        return str(answer.message)

    def prepare(self, services: Iterable[str], kind: Any = Trigger) -> None:
        """Look for services of a kind now, so that the first `send` finds them."""
        for service in services:
            self._client(service, kind)

    def send(
        self,
        service: str,
        kind: Any = Trigger,
        request: Any = None,
        on_answer: Callable[[Any], None] = lambda _: None,
    ) -> None:
        """Call a service without waiting; the node's thread takes its answer."""
        future = self._client(service, kind).call_async(kind.Request() if request is None else request)
        future.add_done_callback(lambda answered: on_answer(answered.result()))

    def _client(self, service: str, kind: Any) -> Any:
        if service not in self._clients:
            self._clients[service] = self.node.create_client(kind, service)
        return self._clients[service]


class Connection(CellServices):
    """A node in a context of its own, spun by a thread; in the ROS domain of the environment by default."""

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
