"""CellOperator: the node of a person at a running cell: presses buttons, and reads the program's state."""

import threading
from typing import Any, Final, Self

import rclpy
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import Trigger

from robots_core.ros.messages import diagnostic_values
from robots_core.ros.qos import STATE
from robots_core.ros.running.middleware import choose_transports
from robots_core.ros.streams.polled_subscription import PolledSubscription
from waiting import POLL, happens

SERVICE_TIME: Final = 5.0  # s


class CellOperator:
    """A node spun by a thread of its own; a context manager.

    Args:
        domain: ROS domain.
        name: The node's name.
    """

    def __init__(self, domain: int, name: str) -> None:
        choose_transports()
        self._context = rclpy.Context()
        rclpy.init(context=self._context, domain_id=domain)
        self._node = Node(name, context=self._context)
        self._lock = threading.Lock()
        self._callers: dict[str, Any] = {}
        self._program: dict[str, str] = {}
        self._status = PolledSubscription(self._node, DiagnosticStatus, 'program_status', STATE)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._spin, name=name, daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()
        self._executor.shutdown()
        self._node.destroy_node()
        self._context.try_shutdown()

    def call(self, service: str) -> tuple[bool, str]:
        """Call a Trigger service: whether it succeeded, and what it said."""
        with self._lock:
            caller = self._callers.get(service)
            if caller is None:
                caller = self._callers[service] = self._node.create_client(Trigger, service)
        answer = answer_of(caller, Trigger.Request())
        if answer is None:
            return False, f'{service} does not answer'
        return answer.success, answer.message

    @property
    def program_state(self) -> str:
        """State of the program, as its node has said last; '' before it has."""
        return self._program.get('state', '')

    @property
    def program_error(self) -> str:
        """What has ended it."""
        return self._program.get('error', '')

    def poll(self) -> None:
        """Take what has come; with the lock held, every 20 ms."""

    def _spin(self) -> None:
        while not self._stop.is_set():
            self._executor.spin_once(timeout_sec=POLL)
            with self._lock:
                status = self._status.take()
                if status is not None:
                    self._program = diagnostic_values(status)
                self.poll()


def answer_of(client: Any, request: Any) -> Any:
    """The answer of a service; None if it is not there or does not answer."""
    if not happens(client.service_is_ready, SERVICE_TIME):
        return None
    future = client.call_async(request)
    return future.result() if happens(future.done, SERVICE_TIME) else None
