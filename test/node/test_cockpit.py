"""The motion simulator's cockpit in lock-step: it publishes what the block gives for the same samples."""

from __future__ import annotations

from typing import Any

import numpy as np
from geometry_msgs.msg import PoseStamped
from sensor_msgs.msg import Imu
from std_msgs.msg import String

from motion_simulator.cabin import FLANGE_IN_MIDDLE, RATE, cue, flange
from motion_simulator.cockpit import Cockpit
from robots_core import Pose
from robots_core.blocks import VehicleMotion
from robots_core.ros.lockstep.phases import START, Phase
from robots_core.ros.messages import pose_from_message
from robots_core.ros.qos import COMMAND, STATE
from robots_core.ros.timed_node import TimedNode

G = 9.80665
HANDED_OVER, STOPS, TAKEN_BACK = 50, 400, 700  # periods
NAN = 300  # period with a broken sample


class Car(TimedNode):
    """Drives, is handed the robot after a while, and stops sending before the robot is taken back."""

    # After the cockpit, which takes what was sent in the period before, on every machine alike.
    phase = Phase.OBSERVE

    def __init__(self, **options: Any) -> None:
        super().__init__('car', **options)
        self.poses: list[tuple[int, Pose]] = []
        self._motions = self.create_publisher(Imu, 'vehicle_imu', COMMAND)
        self._guide = self.create_publisher(String, 'guide', STATE)
        self.create_subscription(PoseStamped, 'reference_pose', self._take, COMMAND)
        self.period = 0
        self.start_loop(self._drive, period=1.0 / RATE, name='car')

    def _take(self, message: PoseStamped) -> None:
        stamp = message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec
        self.poses.append((round((stamp - START) * RATE / 1e9), pose_from_message(message.pose)))

    def _drive(self, now: float) -> None:
        self.period = round((now - START / 1e9) * RATE)
        if self.period in {HANDED_OVER, TAKEN_BACK}:
            self._guide.publish(String(data='SENSOR' if self.period == HANDED_OVER else 'NONE'))
        if self.period < STOPS:
            message = Imu()
            f = message.linear_acceleration
            f.x, f.y, f.z = (3.0, -2.0, float('nan') if self.period == NAN else G)
            self._motions.publish(message)


def test_what_a_cockpit_sends_is_cued_until_it_stops(ros_nodes: Any) -> None:
    car = ros_nodes.add(Car(**ros_nodes.options(lockstep=True)))
    ros_nodes.add(Cockpit(**ros_nodes.options(lockstep=True)))
    run = ros_nodes.coordinate('car', 'cockpit')
    ros_nodes.wait_for(lambda: car.period > TAKEN_BACK + 20, what='the end')
    ros_nodes.call(run.end)
    periods = np.array([period for period, _ in car.poses])
    np.testing.assert_array_equal(periods, range(HANDED_OVER + 1, TAKEN_BACK + 1))
    motion = VehicleMotion(np.array([3.0, -2.0, G]), np.zeros(3))
    steps = cue(None if k - 1 == NAN or k - 1 >= STOPS else motion for k in periods)
    for (_, pose), step in zip(car.poses, steps, strict=True):
        assert max(pose.distance_to(flange(step))) < 1e-9
    assert max(pose.distance_to(FLANGE_IN_MIDDLE)[0] for _, pose in car.poses) > 0.05
    # The cabin is on its way back when the robot is taken back.
    assert any('no motion of the vehicle' in limit for limit in steps[-1].limits)
