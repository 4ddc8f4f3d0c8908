"""ReferenceStream: publishes one-point JointTrajectory messages at a high rate, at little cost."""

import time
from collections.abc import Sequence

import numpy as np
from rclpy.node import Node
from rclpy.serialization import serialize_message
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robots_core.ros.lockstep.counted import CountedPublisher
from robots_core.ros.lockstep.phases import NANOSECONDS
from robots_core.ros.messages import ENCAPSULATION_SIZE, SERIALIZED_STAMP, doubles
from robots_core.ros.qos import make_publisher
from robots_core.validation import Array

EMPTY_SEQUENCE_SIZE = 4
DURATION_SIZE = 8


class ReferenceStream:
    """Publisher of `trajectory_msgs/JointTrajectory` with one point and always the same joints.

    Only the stamp and 3 n numbers change from message to message. They are written into a serialized
    template, which takes a fraction of what building and converting a message object takes.

    Args:
        node: Owner; stamps are on its clock.
        topic: Topic name.
        names: Joint names, n of them.
        time_from_start: The point's time, s.
    """

    def __init__(
        self,
        node: Node,
        topic: str,
        names: Sequence[str],
        *,
        time_from_start: float,
    ) -> None:
        self._publisher = make_publisher(node, JointTrajectory, topic)
        if isinstance(self._publisher, CountedPublisher):
            self._publish = self._publisher.publish
        else:
            self._publish = self._publisher.handle.publish_raw  # without its checks of the argument
        self._simulated = bool(getattr(node.get_clock(), 'ros_time_is_active', False))
        n = len(names)
        # Marks that cannot occur by chance show where serialization puts each of the three arrays.
        marks = 1e300 * (1.0 + np.arange(3.0 * n).reshape(3, n))
        point = JointTrajectoryPoint(
            positions=doubles(marks[0]), velocities=doubles(marks[1]), accelerations=doubles(marks[2])
        )
        point.time_from_start.sec = int(time_from_start)
        point.time_from_start.nanosec = round(1e9 * (time_from_start % 1.0))
        template = bytearray(serialize_message(JointTrajectory(joint_names=list(names), points=[point])))
        offsets = [template.index(row.tobytes()) for row in marks]
        # The serializer leaves padding behind the message's end: an empty sequence and a duration.
        del template[offsets[-1] + 8 * n + EMPTY_SEQUENCE_SIZE + DURATION_SIZE :]
        self._buffer = template
        # The three arrays are equally long, and so equally far from each other.
        stride = offsets[1] - offsets[0]
        self._values: Array = np.ndarray((3, n), np.float64, template, offsets[0], (stride, 8))
        self._last: Array | None = None

    def publish(self, reference: Array, deadline: float) -> None:
        """Publish a reference.

        Args:
            reference: (3, n): position, velocity, acceleration; never changed after it was published.
            deadline: When it was due, s on the clock of `TimedNode.now`: the message's stamp, free of the
                jitter of sending.
        """
        if self._simulated:
            nanoseconds = round(NANOSECONDS * deadline)
        else:
            nanoseconds = time.time_ns() + int(1e9 * (deadline - time.monotonic()))
        SERIALIZED_STAMP.pack_into(self._buffer, ENCAPSULATION_SIZE, *divmod(nanoseconds, NANOSECONDS))
        if reference is not self._last:  # one that stands is the same from period to period
            self._values[:] = self._last = reference
        self._publish(bytes(self._buffer))
