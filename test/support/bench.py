"""The peer of the nodes under test: starts them, sends and collects messages, calls services, waits."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_srvs.srv import Trigger

from robots_core.errors import InvalidInputError
from robots_core.ros.qos import COMMAND

STANDING = 20  # references without velocity; 25 come a second
MANY = QoSProfile(depth=10_000)
# With the value from before.
EVERY_STATE = QoSProfile(depth=10_000, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Bench:
    """A node of the test's own beside those under test; what a test needs besides is added to it.

    A publisher keeps the newest values alone where its QoS says so: those that a slow machine was late for
    are not collected.

    Args:
        runner: Spins the test's own node, and those under test unless they are given another one.
        name: The node's name.
    """

    def __init__(self, runner: Any, name: str = 'peer') -> None:
        self.runner = runner
        self.peer: Node = runner.create_node(name)
        self.health: list[DiagnosticStatus] = []
        """Of all nodes."""
        self._collected: dict[str, list[Any]] = {}
        self._publishers: dict[str, Any] = {}
        self._clients: dict[str, Any] = {}
        self.peer.create_subscription(
            DiagnosticArray, '/diagnostics', lambda message: self.health.extend(message.status), MANY
        )

    def start_node(self, kind: Callable[..., Any], *, runner: Any = None, **parameters: Any) -> Any:
        """Run a node under test with these parameters."""
        runner = runner or self.runner
        return runner.add(kind(**runner.options(**parameters)))

    def collect(
        self, topic: str, kind: type, qos: QoSProfile = MANY, read: Callable[[Any], Any] | None = None
    ) -> list[Any]:
        """Collect the messages of a topic from now on, each as `read` returns it."""
        found = self._collected[topic] = []

        def receive(message: Any) -> None:
            found.append(message if read is None else read(message))

        self.peer.create_subscription(kind, topic, receive, qos)
        return found

    def collect_sent(self, topic: str, kind: type, qos: QoSProfile = MANY) -> list[tuple[float, Any]]:
        """Collect the `data` of a topic's messages from now on, each with the time of sending, s."""
        found: list[tuple[float, Any]] = []

        def receive(message: Any, info: Any) -> None:
            found.append((1e-9 * info['source_timestamp'], message.data))

        self.peer.create_subscription(kind, topic, receive, qos)
        return found

    def collected(self, topic: str) -> list[Any]:
        """What was collected of a topic."""
        return self._collected[topic]

    def publisher(self, topic: str, kind: type, qos: QoSProfile = COMMAND) -> Any:
        """The publisher of a topic, with a subscriber there."""
        if topic not in self._publishers:
            self._publishers[topic] = self.peer.create_publisher(kind, topic, qos)
        publisher = self._publishers[topic]
        self.wait(publisher.get_subscription_count, f'a subscriber of {topic}')
        return publisher

    def publish(self, topic: str, message: Any, qos: QoSProfile = COMMAND) -> None:
        """Publish a message as soon as a node listens."""
        self.publisher(topic, type(message), qos).publish(message)

    def call(self, service: str, request: Any = None, kind: Any = Trigger) -> Any:
        """Call a service and return its response."""
        if service not in self._clients:
            self._clients[service] = self.peer.create_client(kind, service)
        client = self._clients[service]
        self.wait(client.service_is_ready, f'service {service}')
        future = client.call_async(kind.Request() if request is None else request)
        return self.wait(future.done, f'the answer of {service}') and future.result()

    def wait(self, condition: Callable[[], Any], what: str) -> Any:
        """Wait until a condition is true; return its value."""
        return self.runner.wait_for(condition, what=what)

    def until_standing(self, references: list[Any]) -> None:
        """Wait until the newest of these trajectory points, which keep coming, have no velocity."""
        count = len(references)
        self.wait(
            lambda: (
                len(references) > count + STANDING
                and not any(any(point.velocities) for point in references[-STANDING:])
            ),
            'a standing robot',
        )

    def set_parameters(self, node: Any, **values: Any) -> None:
        """Set parameters of a node under test.

        Raises:
            InvalidInputError: it refuses one.
        """
        for result in node.set_parameters([Parameter(name, value=value) for name, value in values.items()]):
            if not result.successful:
                raise InvalidInputError(result.reason)

    def until_health(self, level: bytes, text: str) -> DiagnosticStatus:
        """Wait for a diagnostic of this level that contains a text."""
        return self.wait(partial(self._health, level, text), f'health {text!r}')

    def _health(self, level: bytes, text: str) -> DiagnosticStatus | None:
        return next((one for one in self.health if one.level == level and text in one.message), None)
