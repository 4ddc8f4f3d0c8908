"""Subscriptions that hear every publisher, and what they say of those that they do not match."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from typing import Any

import pytest
from geometry_msgs.msg import PoseStamped
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float64

from bench import Bench
from robots_core.cell_interface.topic_qos import Profile, topic_qos
from robots_core.ros.qos import (
    COMMAND,
    SENSOR,
    STATE,
    STREAM,
    every_message,
    subscribe_any,
    subscribe_any_state,
)
from robots_planning.nodes.planning_node import PlanningNode

from .suite_nodes import OPTIONS, suite_nodes

UNACKNOWLEDGED = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)


def heard(bench: Bench, subscribe: Callable[[Any, list[float]], None], qos: QoSProfile) -> list[float]:
    values: list[float] = []
    subscribe(bench.runner.create_node('listener'), values)
    # What a publisher says of our subscriptions is its own choice.
    quiet = PublisherEventCallbacks(use_default_callbacks=False)
    publisher = bench.peer.create_publisher(Float64, 'topic', qos, event_callbacks=quiet)
    bench.peer.create_timer(0.02, lambda: publisher.publish(Float64(data=1.0)))
    bench.wait(lambda: values, 'a message')
    return values


@pytest.mark.parametrize('qos', [STREAM, STATE, COMMAND])
def test_publishers_of_state_are_heard_without_a_warning_that_they_are_not(
    ros_nodes: Any, qos: QoSProfile, capfd: pytest.CaptureFixture[str]
):
    heard(
        Bench(ros_nodes),
        lambda node, values: subscribe_any_state(node, Float64, 'topic', lambda one: values.append(one.data)),
        qos,
    )
    assert 'incompatible QoS' not in capfd.readouterr().err


@pytest.mark.parametrize('qos', [UNACKNOWLEDGED, SENSOR, STREAM, STATE])
def test_publishers_without_acknowledgement_are_heard_too(
    ros_nodes: Any, qos: QoSProfile, capfd: pytest.CaptureFixture[str]
):
    heard(
        Bench(ros_nodes),
        lambda node, values: subscribe_any(
            node, Float64, 'topic', lambda one: values.append(one.data), COMMAND
        ),
        qos,
    )
    assert 'incompatible QoS' not in capfd.readouterr().err


def test_a_reference_pose_without_acknowledgement_reaches_the_planner(ros_nodes: Any):
    bench = Bench(ros_nodes)
    node = bench.start_node(PlanningNode, robot_model='ur5e')
    message = PoseStamped()
    message.pose.position.x, message.pose.orientation.w = 0.5, 1.0
    publisher = bench.peer.create_publisher(PoseStamped, 'reference_pose', UNACKNOWLEDGED)
    bench.peer.create_timer(0.02, lambda: publisher.publish(message))
    bench.wait(lambda: node.planner.reference_pose is not None, 'the pose')


OF_OTHERS = ('/plc/', '/press/', '/joint_trajectory_controller/')
"""Where topics are that the suite shares with a PLC or a driver, whose choice their quality is."""


def key(qos: QoSProfile) -> tuple[Any, ...]:
    return qos.depth, qos.reliability, qos.durability


def as_key(profile: Profile) -> tuple[Any, ...]:
    return (
        profile.depth,
        ReliabilityPolicy.RELIABLE if profile.reliable else ReliabilityPolicy.BEST_EFFORT,
        DurabilityPolicy.TRANSIENT_LOCAL if profile.latched else DurabilityPolicy.VOLATILE,
    )


@pytest.mark.parametrize('executable', sorted(suite_nodes()))
def test_every_publisher_and_subscription_has_the_quality_of_the_table(ros_nodes: Any, executable: str):
    bench = Bench(ros_nodes)
    node = bench.start_node(suite_nodes()[executable], **OPTIONS.get(executable, {}))
    publishers = [one for one in node.publishers if not one.topic_name.startswith(OF_OTHERS)]
    assert publishers
    for publisher in publishers:
        name = publisher.topic_name
        assert key(publisher.qos_profile) == as_key(topic_qos(name).published), name
    found = defaultdict(set)
    for subscription in node.subscriptions:
        if not subscription.topic_name.startswith(OF_OTHERS):
            found[subscription.topic_name].add(key(subscription.qos_profile))
    for name, keys in found.items():
        qos = topic_qos(name)
        ways = [{as_key(one) for one in qos.subscribed}, {as_key(qos.polled)}]
        assert keys in [*ways, {key(every_message(name))}], name
