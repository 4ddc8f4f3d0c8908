"""motion_cueing_node: what a driver or the simulation of a vehicle sends becomes the motion of the cabin."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped
from sensor_msgs.msg import Imu, Joy
from std_msgs.msg import String

from robots_core import Pose
from robots_core.blocks import Cockpit, CueingStep, DriverInputs, VehicleMotion, read_cabin
from robots_core.blocks.following.following_methods import RATE
from robots_core.nodes.motion_cueing_node import MotionCueingNode
from robots_core.ros.lockstep.phases import START, Phase
from robots_core.ros.messages import pose_from_message
from robots_core.ros.qos import COMMAND, STATE
from robots_core.ros.timed_node import TimedNode

G = 9.80665
FILE = Path(__file__).parents[2] / 'programs' / 'motion_simulator' / 'cabin.yaml'
CABIN = read_cabin(FILE)
HANDED_OVER, STOPS, TAKEN_BACK = 25, 250, 450  # periods
NAN = 150  # period with a broken sample
VALUES = {
    'vehicle_imu': VehicleMotion(np.array([3.0, -2.0, G]), np.zeros(3)),
    'joy': DriverInputs(0.2, 1.0),
}


class Car(TimedNode):
    """Drives, is handed the robot after a while, and stops sending before the robot is taken back."""

    phase = Phase.ENVIRONMENT

    def __init__(self, topic: str, **options: Any) -> None:
        super().__init__('car', **options)
        self.poses: list[tuple[int, Pose]] = []
        self._inputs = self.create_publisher(Joy if topic == 'joy' else Imu, topic, COMMAND)
        self._guide = self.create_publisher(String, 'guide', STATE)
        self.create_subscription(PoseStamped, 'reference_pose', self._take, COMMAND)
        self._topic, self.period = topic, 0
        self.start_loop(self._drive, period=1.0 / RATE, name='car')

    def _take(self, message: PoseStamped) -> None:
        stamp = message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec
        self.poses.append((round((stamp - START) * RATE / 1e9), pose_from_message(message.pose)))

    def _drive(self, now: float) -> None:
        self.period = round((now - START / 1e9) * RATE)
        if self.period in {HANDED_OVER, TAKEN_BACK}:
            self._guide.publish(String(data='SENSOR' if self.period == HANDED_OVER else 'NONE'))
        if self.period < STOPS:
            last = float('nan') if self.period == NAN else None
            if self._topic == 'joy':
                self._inputs.publish(Joy(axes=[0.2, 1.0 if last is None else last]))
                return
            message = Imu()
            f = message.linear_acceleration
            f.x, f.y, f.z = (3.0, -2.0, G if last is None else last)
            self._inputs.publish(message)


@pytest.mark.parametrize('topic', VALUES)
def test_what_is_sent_is_cued_until_it_stops(ros_nodes: Any, topic: str) -> None:
    car = ros_nodes.add(Car(topic, **ros_nodes.options(lockstep=True)))
    options = {'lockstep': True, 'robot_model': 'kuka_kr500_r2830', 'cabin': str(FILE)}
    ros_nodes.add(MotionCueingNode(**ros_nodes.options(**options)))
    run = ros_nodes.coordinate('car', 'motion_cueing_node')
    ros_nodes.wait_for(lambda: car.period > TAKEN_BACK + 20, what='the end')
    ros_nodes.call(run.end)
    periods = np.array([period for period, _ in car.poses])
    first, last = periods[[0, -1]]
    np.testing.assert_array_equal(periods, range(first, last + 1))
    assert first - HANDED_OVER <= 1
    assert last - TAKEN_BACK <= 1
    steps = [step for _, step in cued(topic, periods.tolist())]
    for (_, pose), step in zip(car.poses, steps, strict=True):
        assert max(pose.distance_to(CABIN.flange_of(step))) < 1e-6  # a joystick has single precision
    assert max(pose.distance_to(CABIN.flange)[0] for _, pose in car.poses) > 0.05
    # The cabin is on its way back when the robot is taken back.
    assert any('no motion of the vehicle' in limit for limit in steps[-1].limits)


def cued(topic: str, periods: list[int]) -> list[tuple[int, CueingStep]]:
    cockpit, found = Cockpit(CABIN, 1.0 / RATE), []
    for period in periods:
        if period != NAN and period < STOPS:
            cockpit.take(VALUES[topic])
        found.append((period, cockpit.step()))
    return found
