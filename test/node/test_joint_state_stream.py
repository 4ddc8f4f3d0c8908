"""Joint states come out of the serialized template as from a message object."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message
from rosbags.typesys import Stores, get_typestore
from sensor_msgs.msg import JointState

from robots_core.ros.streams.serialized_streams import JointStateStream

NAMES = ('A1', 'A2', 'A3')


@pytest.fixture
def published(ros_nodes: Any) -> Any:
    """Publishes, and returns the message that has arrived."""
    node, raw = ros_nodes.create_node(), []
    node.create_subscription(JointState, 'joint_states', raw.append, QoSProfile(depth=10), raw=True)
    stream = JointStateStream(node, 'joint_states')
    ros_nodes.wait_for(lambda: node.count_subscribers('joint_states'))

    def publish(names: tuple[str, ...], values: np.ndarray) -> JointState:
        raw.clear()
        before = node.get_clock().now().nanoseconds
        stream.publish(names, values)
        ros_nodes.wait_for(lambda: raw)
        message = deserialize_message(raw[0], JointState)
        stamp = message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec
        assert before <= stamp <= node.get_clock().now().nanoseconds
        # Strict readers refuse trailing bytes.
        get_typestore(Stores.ROS2_JAZZY).deserialize_cdr(raw[0], 'sensor_msgs/msg/JointState')
        return message

    return publish


def _assert_has(message: JointState, names: tuple[str, ...], values: np.ndarray) -> None:
    assert tuple(message.name) == names
    fields = (message.position, message.velocity, message.effort)
    for numbers, expected in zip(fields, values, strict=False):
        np.testing.assert_array_equal(numbers, expected)
    assert all(len(numbers) == 0 for numbers in fields[len(values) :])


@pytest.mark.parametrize('count', [1, 3, 7])
@pytest.mark.parametrize('fields', [2, 3])
def test_publishes_what_it_is_given_and_nothing_else(published: Any, count: int, fields: int) -> None:
    names = tuple(f'joint_{i}' for i in range(count))
    values = np.random.default_rng(1).normal(size=(fields, count))
    for factor in (1.0, 2.0):
        _assert_has(published(names, factor * values), names, factor * values)


def test_joints_and_fields_may_change(published: Any) -> None:
    values = np.arange(9.0).reshape(3, 3)
    _assert_has(published(NAMES, values[:2]), NAMES, values[:2])
    _assert_has(published(NAMES[1:], values[:2, 1:]), NAMES[1:], values[:2, 1:])
    _assert_has(published((), values[:2, :0]), (), values[:2, :0])
    _assert_has(published(NAMES, values), NAMES, values)
