"""Peers of a cell's nodes: bare rclpy nodes with the same publishers and subscriptions, each in a process.

`bare_nodes.py FILE NODE` is one of them; the file is what `benchmark_cell_at_rest.py` has found in a cell.
"""

from __future__ import annotations

import contextlib
import json
import sys
from functools import partial
from pathlib import Path
from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message

from robots_core.ros.messages import message_class
from robots_core.ros.running.middleware import choose_transports


class BareNode(Node):
    """Publishes recorded messages with the time of now at their rates, and does nothing with what it gets."""

    def __init__(self, name: str, description: dict[str, list[dict[str, Any]]]) -> None:
        super().__init__(name)
        for endpoint in description['publishers']:
            publisher = self.create_publisher(_type(endpoint), endpoint['topic'], _qos(endpoint))
            message = _type(endpoint)()
            if endpoint['sample']:
                message = deserialize_message(bytes.fromhex(endpoint['sample']), _type(endpoint))
            if endpoint['rate'] > 0.0:
                self.create_timer(1.0 / endpoint['rate'], partial(self._publish, publisher, message))
            elif endpoint['durability'] == DurabilityPolicy.TRANSIENT_LOCAL.name:
                publisher.publish(message)
        for endpoint in description['subscriptions']:
            self.create_subscription(_type(endpoint), endpoint['topic'], lambda _: None, _qos(endpoint))

    def _publish(self, publisher: Any, message: Any) -> None:
        if hasattr(message, 'header'):
            message.header.stamp = self.get_clock().now().to_msg()
        publisher.publish(message)


def _type(endpoint: dict[str, Any]) -> Any:
    return message_class(endpoint['type'])


def _qos(endpoint: dict[str, Any]) -> QoSProfile:
    return QoSProfile(
        depth=1,
        reliability=ReliabilityPolicy[endpoint['reliability']],
        durability=DurabilityPolicy[endpoint['durability']],
    )


def main() -> None:
    file, name = sys.argv[1:]
    choose_transports()
    rclpy.init()
    executor = SingleThreadedExecutor()
    executor.add_node(BareNode(name, json.loads(Path(file).read_text())[name]))
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        executor.spin()


if __name__ == '__main__':
    main()
