"""No message ends a node: every topic that it subscribes to gets generated ones, and it continues serving."""

from __future__ import annotations

import random
from collections.abc import Iterator
from typing import Any, Final

import pytest
import rclpy
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from hypothesis import given, settings
from hypothesis import strategies as st
from rcl_interfaces.srv import ListParameters
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile
from rosgraph_msgs.msg import Clock

from counted_cases import count_cases
from robots_core import load_robot_model
from robots_core.ros.lockstep.phases import NANOSECONDS
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.running.lean_executor import LeanExecutor

from .generated_messages import messages_of, mixed, nearly
from .suite_nodes import OPTIONS, suite_nodes
from .valid_messages import valid_messages

ROBOT: Final = 'kuka_kr210_r2700'
OWN: Final = ('/clock', '/parameter_events')  # rclpy's
TICK: Final = 0.05  # s: every timer and loop of the nodes has its turn
PATIENCE: Final = 240.0  # s
MOST: Final = 8  # messages in a batch
# Examples of each topic, and messages mixed from those of one: 10 000 in `make fuzz-messages`.
EXAMPLES, MIXED = (50, 200) if settings().max_examples > 100 else (3, 36)
# Depth and durability for all subscriptions; liveliness for those that ask for a lease.
QOS: Final = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class TopicsBench:
    """One node on a simulated clock, in the test's own thread: what its callbacks raise, the test raises."""

    def __init__(self, kind: Any, context: Any, **parameters: Any) -> None:
        self.robot = load_robot_model(ROBOT)
        self.context = context
        self._time = 0
        self._examples: dict[tuple[type, int], list[Any]] = {}
        values = {'robot_model': ROBOT, 'use_sim_time': True, **parameters}
        self.node = kind(
            context=context, parameter_overrides=[Parameter(name, value=one) for name, one in values.items()]
        )
        self.peer = rclpy.create_node('fuzz', context=context)
        self.executor = LeanExecutor(context=context)
        self.executor.add_node(self.node)
        self.executor.add_node(self.peer)
        self._clock = self.peer.create_publisher(Clock, '/clock', 1)
        self._client = self.peer.create_client(ListParameters, f'{self.node.get_name()}/list_parameters')
        self.health: list[DiagnosticStatus] = []
        self.peer.create_subscription(
            DiagnosticArray, '/diagnostics', lambda message: self.health.extend(message.status), QOS.depth
        )
        self.subscriptions = [one for one in self.node.subscriptions if one.topic_name not in OWN]
        self._publishers = {one: self._publisher(one) for one in self.subscriptions}
        self.until(lambda: self._clock.get_subscription_count() and self._client.service_is_ready())
        self.until(lambda: all(one.get_publisher_count() for one in self.subscriptions))
        self.tick()

    def _publisher(self, subscription: Any) -> Any:
        profile, wanted = QoSProfile(depth=QOS.depth, durability=QOS.durability), subscription.qos_profile
        if wanted.liveliness is LivelinessPolicy.AUTOMATIC:
            profile.liveliness = wanted.liveliness
            profile.liveliness_lease_duration = wanted.liveliness_lease_duration
        return self.peer.create_publisher(subscription.msg_type, subscription.topic_name, profile)

    def until(self, condition: Any) -> None:
        """Spin until a condition is true."""
        end = self.peer.get_clock().now().nanoseconds + PATIENCE * NANOSECONDS
        while not condition():
            self.executor.spin_once(0.01)
            assert self.peer.get_clock().now().nanoseconds < end

    def _drain(self) -> None:
        """Let the node handle what has come: in each round, a message of each topic."""
        for _ in range(2 * MOST):
            self.executor.spin_once(0.0)

    def tick(self, time: float = TICK) -> None:
        """Let the node handle what came, advance its clock, and let it handle what that makes due."""
        self._drain()
        self._advance(time)
        self._drain()

    def _advance(self, time: float) -> None:
        self._time += round(time * NANOSECONDS)
        message = Clock()
        message.clock.sec, message.clock.nanosec = divmod(self._time, NANOSECONDS)
        self._clock.publish(message)
        self.until(lambda: self.node.get_clock().now().nanoseconds == self._time)

    def send(self, subscription: Any, messages: list[Any]) -> None:
        """Publish a batch; the node serves a request after it."""
        for one, publisher in self._publishers.items():  # valid ones, so that more becomes of these
            publisher.publish(self.examples(one.msg_type)[0])
        self.tick()
        count_cases('messages', len(messages))
        for number, message in enumerate(messages, 1):
            self._publishers[subscription].publish(message)
            self.executor.spin_once(0.0)
            if number % MOST == 0:
                self._advance(TICK)
        self.tick()
        future = self._client.call_async(ListParameters.Request())
        self.until(future.done)
        assert future.result().result.names

    def check_health(self) -> None:
        """The node reports its health, and no internal error."""
        assert self.context.ok()
        if not isinstance(self.node, RobotNode):
            return
        self.health.clear()
        name = self.node.get_fully_qualified_name()
        self.tick(1.0)
        self.until(lambda: any(status.name == name for status in self.health))
        assert not any('internal' in status.message for status in self.health)

    def examples(self, kind: type) -> list[Any]:
        """Valid messages of a type, of this instant."""
        key = kind, self._time
        if key not in self._examples:
            seconds, nanoseconds = divmod(self._time, NANOSECONDS)
            self._examples[key] = valid_messages(kind, self.robot, Time(sec=seconds, nanosec=nanoseconds))
        return self._examples[key]

    def close(self) -> None:
        self.executor.shutdown()
        self.node.destroy_node()
        self.peer.destroy_node()


@pytest.fixture(params=sorted(suite_nodes()))
def bench(request: pytest.FixtureRequest, ros_context: Any) -> Iterator[TopicsBench]:
    name = request.param
    bench = TopicsBench(suite_nodes()[name], ros_context, **OPTIONS.get(name, {}))
    yield bench
    bench.close()


def test_every_topic_of_every_node_takes_any_message(bench: TopicsBench) -> None:
    texts = tuple(bench.robot.axes_data.names)
    for subscription in bench.subscriptions:
        kind = subscription.msg_type
        one = nearly(bench.examples(kind), texts) | messages_of(kind, texts)

        @settings(max_examples=EXAMPLES)
        @given(st.lists(one, min_size=1, max_size=MOST), st.integers(0, 2**32))
        def check(messages: list[Any], seed: int) -> None:
            rng = random.Random(seed)  # noqa: S311  # no secret
            parts = [*messages, *bench.examples(kind)]  # noqa: B023  # called within the loop
            bench.send(subscription, [*messages, *(mixed(parts, rng) for _ in range(MIXED))])  # noqa: B023

        check()
    bench.check_health()
