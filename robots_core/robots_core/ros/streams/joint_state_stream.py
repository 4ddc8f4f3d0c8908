"""JointStateStream: publishes JointState messages at a high rate, at little cost."""

from collections.abc import Sequence

from rclpy.node import Node
from sensor_msgs.msg import JointState

from robots_core.ros.messages import joint_state_message
from robots_core.ros.qos import make_publisher
from robots_core.ros.streams.serialized_rows import SerializedRows
from robots_core.validation import Array

EMPTY_SEQUENCE_SIZE = 4


class JointStateStream:
    """Publisher of `sensor_msgs/JointState` with joints that seldom change.

    Args:
        node: Owner; stamps are on its clock.
        topic: Topic name.
    """

    def __init__(self, node: Node, topic: str) -> None:
        self._publisher = make_publisher(node, JointState, topic)
        self._clock = node.get_clock()
        self._layout: tuple[list[str], int] = [], 0
        self._serialized: SerializedRows | None = None

    def publish(self, names: Sequence[str], values: Sequence[Array]) -> None:
        """Publish what joints do now.

        Args:
            names: Of the joints, n of them.
            values: Positions and velocities, (n,) each, and efforts where there are any.
        """
        layout = list(names), len(values)
        if layout != self._layout:
            self._layout = layout
            self._serialized = self._template() if names else None
        now = self._clock.now()
        if self._serialized is None:
            message = JointState()
            message.header.stamp = now.to_msg()
            self._publisher.publish(message)
            return
        for row, numbers in zip(self._serialized.rows, values, strict=True):
            row[:] = numbers
        self._publisher.publish(self._serialized.stamped(now.nanoseconds))

    def _template(self) -> SerializedRows:
        names, fields = self._layout
        end = EMPTY_SEQUENCE_SIZE if fields == 2 else 0  # positions and velocities
        return SerializedRows(
            lambda rows: joint_state_message(0, names, *rows), (fields, len(names)), end=end
        )
