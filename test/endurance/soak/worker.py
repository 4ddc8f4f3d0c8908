"""Worker: what people and a PLC do at a cell all day, and what they see of it."""

from __future__ import annotations

import time
from array import array
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import UInt8
from trajectory_msgs.msg import JointTrajectory

from cell_operator import CellOperator, answer_of
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.ros.messages import ENCAPSULATION_SIZE, SERIALIZED_STAMP, STAMP_END
from robots_core.ros.qos import STREAM
from robots_core.ros.streams.polled_subscription import PolledSubscription

from .figures import LoopFigures, loop_figures

EVERY: Final = QoSProfile(depth=5000)
TOPICS: Final = {'joint_reference': JointTrajectory, 'joint_states': JointState}
JOG_SPEED: Final = 0.1  # rad/s (m/s)
JOG_PERIOD: Final = 0.04  # s
REQUEST: Final = 0b10  # bit of the PLC's word
TOGGLE: Final = 0.2  # s between two changes of an input that nothing waits for


@dataclass
class Seen:
    """Messages of one topic: when they were due, how late, s, and whether they differ from those before."""

    due: array[float] = field(default_factory=lambda: array('d'))
    late: array[float] = field(default_factory=lambda: array('d'))
    moved: array[int] = field(default_factory=lambda: array('b'))
    content: bytes = b''


class Worker(CellOperator):
    """Runs programs, jogs, answers as a PLC, and notes how late references and feedback are sent.

    Args:
        robot: The robot.
        domain: ROS domain.
    """

    def __init__(self, robot: BaseRobotModel, domain: int) -> None:
        super().__init__(domain, 'worker')
        self._names = list(robot.axes_data.names)
        self._streams = {
            topic: PolledSubscription(self._node, kind, topic, EVERY, raw=True)
            for topic, kind in TOPICS.items()
        }
        self._seen = {topic: Seen() for topic in TOPICS}
        self._words = PolledSubscription(self._node, UInt8, 'plc/word', STREAM)
        self._inputs = self._node.create_publisher(UInt8, 'plc/inputs', 10)
        self._jog = self._node.create_publisher(JointState, 'teach_joints', 1)
        self._mode = self._node.create_client(SetParameters, 'controller_node/set_parameters')
        self._origin = time.time()
        self._image, self._request, self._sent = 0, 0, 0.0
        self.changes = 0
        """Of inputs."""
        self.position: list[float] = []
        """Of the newest feedback."""

    def begin(self) -> None:
        """Forget what was seen while the cell started."""
        with self._lock:
            self._origin = time.time()
            self._seen = {topic: Seen() for topic in TOPICS}

    def poll(self) -> None:
        """Note what came, and answer as the PLC."""
        for topic, stream in self._streams.items():
            seen = self._seen[topic]
            for data, info in stream.take_all():
                stamp, content = self._stamp(data), data[STAMP_END:]
                seen.due.append(stamp - self._origin)
                seen.late.append(1e-9 * info['source_timestamp'] - stamp)
                seen.moved.append(content != seen.content)
                seen.content = content
        word = self._words.take()
        if word is not None:
            self._request = int(bool(word.data & REQUEST))
        now = time.monotonic()
        image = self._request | (int(now / TOGGLE) % 2) << 1
        if image != self._image or now - self._sent > 1.0:
            self.changes += (image ^ self._image).bit_count()
            self._image, self._sent = image, now
            self._inputs.publish(UInt8(data=image))

    def jog(self, axis: int, direction: float, seconds: float) -> None:
        """Jog one axis, as a person who holds a key does."""
        velocity = np.zeros(len(self._names))
        velocity[axis] = direction * JOG_SPEED
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            message = JointState(name=self._names, velocity=velocity.tolist())
            message.header.stamp = self._node.get_clock().now().to_msg()
            self._jog.publish(message)
            time.sleep(JOG_PERIOD)

    def set_mode(self, mode: str) -> str:
        """Turn the mode switch: '' or why it cannot be turned now."""
        request = SetParameters.Request(
            parameters=[Parameter('operating_mode', value=mode).to_parameter_msg()]
        )
        answer = answer_of(self._mode, request)
        if answer is None:
            return 'controller_node does not answer'
        (result,) = answer.results
        return '' if result.successful else result.reason

    def loops(self) -> tuple[LoopFigures, ...]:
        """How late everything was sent."""
        with self._lock:
            return tuple(
                loop_figures(topic, np.array(seen.due), np.array(seen.late), np.array(seen.moved, bool))
                for topic, seen in self._seen.items()
            )

    @staticmethod
    def _stamp(data: Any) -> float:
        sec, nanosec = SERIALIZED_STAMP.unpack_from(data, ENCAPSULATION_SIZE)
        return float(sec + 1e-9 * nanosec)
