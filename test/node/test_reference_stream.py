"""References come out of the serialized template as from a message object."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message
from rosbags.typesys import Stores, get_typestore
from trajectory_msgs.msg import JointTrajectory

from robots_core.periodic.resting_rate import RestingRate
from robots_core.ros.streams.serialized_streams import ReferenceStream


@pytest.mark.parametrize('names', [('A1', 'A2', 'A3'), ('a',), tuple(f'joint_{i}' for i in range(7))])
def test_publishes_what_it_is_given_and_nothing_else(ros_nodes: Any, names: tuple[str, ...]) -> None:
    node = ros_nodes.create_node()
    raw: list[bytes] = []
    node.create_subscription(JointTrajectory, 'joint_reference', raw.append, QoSProfile(depth=10), raw=True)
    stream = ReferenceStream(node, 'joint_reference', names, time_from_start=1.25)
    ros_nodes.wait_for(stream._publisher.get_subscription_count)
    reference = np.random.default_rng(1).normal(size=(3, len(names)))
    before = node.get_clock().now().nanoseconds
    stream.publish(reference, time.monotonic() - 1.0)  # it was due a second ago
    ros_nodes.wait_for(lambda: raw)
    message = deserialize_message(raw[0], JointTrajectory)
    assert tuple(message.joint_names) == names
    (point,) = message.points
    np.testing.assert_array_equal([point.positions, point.velocities, point.accelerations], reference)
    assert len(point.effort) == 0
    assert (point.time_from_start.sec, point.time_from_start.nanosec) == (1, 250_000_000)
    stamp = message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec
    # The two clocks are read one after the other, on a machine that may do something else in between.
    assert before - 1.0e9 <= stamp <= node.get_clock().now().nanoseconds - 0.9e9
    # Strict readers refuse trailing bytes.
    get_typestore(Stores.ROS2_JAZZY).deserialize_cdr(raw[0], 'trajectory_msgs/msg/JointTrajectory')


def test_a_reference_that_stands_is_sent_seldom_and_again_before_one_that_moves(ros_nodes: Any) -> None:
    node, period = ros_nodes.create_node(), 0.004
    found: list[tuple[int, float]] = []

    def take(message: JointTrajectory) -> None:
        found.append((message.header.stamp.nanosec, message.points[0].positions[0]))

    node.create_subscription(JointTrajectory, 'joint_reference', take, QoSProfile(depth=100))
    stream = ReferenceStream(
        node, 'joint_reference', ['a'], time_from_start=period, resting=RestingRate(10, 2)
    )
    ros_nodes.wait_for(stream._publisher.get_subscription_count)
    stands, start, sent = np.zeros((3, 1)), time.monotonic(), []
    for k in range(35):
        stream.publish(stands if k < 30 else np.full((3, 1), float(k)), start + k * period)
        sent += [k] if k in {0, 1, 2, 12, 22, 29} or k >= 30 else []
    ros_nodes.wait_for(lambda: len(found) >= len(sent))
    assert [position for _, position in found] == [0.0] * 6 + [30.0, 31.0, 32.0, 33.0, 34.0]
    steps = np.diff([stamp for stamp, _ in found]) % 1_000_000_000
    np.testing.assert_allclose(1e-9 * steps, period * np.diff(sent), atol=1e-6)
