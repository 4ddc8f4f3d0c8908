"""Commands are taken in the order in which they were sent, whatever topics they came on."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from sensor_msgs.msg import JointState

from robots_core.ros.qos import COMMAND
from robots_core.ros.timed_node import TimedNode
from robots_planning.nodes.command_intake import CommandInbox

if TYPE_CHECKING:
    from rclpy.context import Context

SENT_ON = ('second', 'first', 'third', 'first', 'first', 'second')


def test_commands_that_wait_on_several_topics_are_taken_as_they_were_sent(ros_context: Context) -> None:
    node, sender = TimedNode('taker', context=ros_context), TimedNode('sender', context=ros_context)
    inbox = CommandInbox(node)
    arrived: list[int] = []
    taken: list[int] = []

    def receive(message: JointState) -> None:
        arrived.append(message.header.stamp.nanosec)
        inbox.put(message.header.stamp, partial(taken.append, message.header.stamp.nanosec))

    for topic in ('first', 'second', 'third'):
        node.create_subscription(JointState, topic, receive, COMMAND)
    publishers = {topic: sender.create_publisher(JointState, topic, COMMAND) for topic in SENT_ON}
    executor = SingleThreadedExecutor(context=ros_context)
    executor.add_node(node)
    while not all(publisher.get_subscription_count() for publisher in publishers.values()):
        executor.spin_once(timeout_sec=0.01)
    for number, topic in enumerate(SENT_ON):
        message = JointState()
        message.header.stamp.nanosec = number
        publishers[topic].publish(message)
    # The node is busy with something else until all of them are there.
    assert all(publisher.wait_for_all_acked(Duration(seconds=10)) for publisher in publishers.values())
    while len(taken) < len(SENT_ON):
        executor.spin_once(timeout_sec=0.01)
    executor.shutdown()
    node.destroy_node()
    sender.destroy_node()
    # Taken in the order of the stamps although they came in that of the topics.
    assert arrived != sorted(arrived)
    assert taken == sorted(taken)
