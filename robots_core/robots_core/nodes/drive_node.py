"""drive_node: simulated drives that follow `joint_reference` and report `joint_states`."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

from robots_core.blocks.drive_train import DriveTrain
from robots_core.errors import InvalidInputError, RobotsError
from robots_core.nodes.messages import doubles, joint_values
from robots_core.nodes.polled_subscription import PolledSubscription
from robots_core.nodes.qos import STATE, STREAM
from robots_core.nodes.robot_node import RobotNode
from robots_core.nodes.run import run
from robots_core.periodic_thread import PeriodicThread
from robots_core.validation import Array


class DriveNode(RobotNode):
    """The drives in the place of a real robot: one `DriveTrain` stepped in real time."""

    def __init__(self, **options: Any) -> None:
        super().__init__('drive_node', **options)
        rate = self.parameter('rate', 250.0, 'steps per second, Hz', bounds=(10.0, 2000.0), read_only=True)
        priority = self.parameter(
            'realtime_priority',
            50,
            'FIFO priority of the loop where the system permits it; 0: none',
            read_only=True,
        )
        bandwidth = self.parameter(
            'bandwidth',
            [15.0],
            'natural frequency of the drives, Hz; one number or one per axis',
            read_only=True,
        )
        damping = self.parameter(
            'damping', [1.0], 'damping ratio of the drives; one number or one per axis', read_only=True
        )
        start = self.parameter(
            'initial_position',
            [float('nan')],
            "joint positions at start, rad; the robot's home by default",
            read_only=True,
        )
        axes = self.robot.axes_data
        q = self.robot.home if np.isnan(start).all() else axes.check_position(start, 'initial_position')
        self._drives = DriveTrain(q, period=1.0 / rate, bandwidth=bandwidth, damping=damping)
        self._reference: Array = np.array(q)
        self._references: PolledSubscription[JointTrajectory] = PolledSubscription(
            self, JointTrajectory, 'joint_reference', STREAM
        )
        self._message = JointState(name=list(axes.names))
        self._publisher = self.create_publisher(JointState, 'joint_states', STATE)
        self._thread = PeriodicThread(
            self._step,
            period=1.0 / rate,
            name='drives',
            on_error=self.thread_failed,
            realtime_priority=priority,
        )
        self._thread.start()
        self.ready(rate=rate)

    def _step(self, deadline: float) -> None:
        del deadline
        message = self._references.take()
        if message is not None:
            try:
                self._reference = self._read(message)
            except RobotsError as error:
                self.refuse('joint_reference', error, stream=True)
        q, q_dot = self._drives.step(self._reference)
        state = self._message
        state.header.stamp = self.get_clock().now().to_msg()
        state.position, state.velocity = doubles(q), doubles(q_dot)
        self._publisher.publish(state)

    def _read(self, message: JointTrajectory) -> Array:
        if len(message.points) != 1:
            raise InvalidInputError(f'{len(message.points)} points came, a reference is one point')
        names = self.robot.axes_data.names
        q = joint_values(message.joint_names, message.points[0].positions, names, 'joint_reference')
        return self.robot.axes_data.check_position(q, 'joint_reference')

    def destroy_node(self) -> None:
        """End the thread before what it uses."""
        self._thread.stop()
        super().destroy_node()  # type: ignore[no-untyped-call]


def main() -> None:
    """Start the node."""
    sys.exit(run(DriveNode))


if __name__ == '__main__':
    main()
