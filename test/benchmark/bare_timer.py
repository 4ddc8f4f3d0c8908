"""The peer of the controller's benchmark: an rclpy timer that publishes the same message."""

from __future__ import annotations

import array
import contextlib
import sys

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint


class BareTimer(Node):
    """Publishes a constant one-point JointTrajectory at `rate` and does nothing else."""

    def __init__(self, rate: float, names: list[str]) -> None:
        super().__init__('bare_timer')
        self._message = JointTrajectory(joint_names=names, points=[JointTrajectoryPoint()])
        self._values = array.array('d', [0.0] * len(names))
        qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._publisher = self.create_publisher(JointTrajectory, 'joint_reference', qos)
        self.create_timer(1.0 / rate, self._tick)

    def _tick(self) -> None:
        message = self._message
        message.header.stamp = self.get_clock().now().to_msg()
        point = message.points[0]
        point.positions = self._values[:]
        point.velocities = self._values[:]
        point.accelerations = self._values[:]
        self._publisher.publish(message)


def main() -> None:
    rate, names = float(sys.argv[1]), sys.argv[2].split(',')
    rclpy.init()
    executor = SingleThreadedExecutor()
    executor.add_node(BareTimer(rate, names))
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        executor.spin()


if __name__ == '__main__':
    main()
