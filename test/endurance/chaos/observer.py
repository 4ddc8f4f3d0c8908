"""Observer: records what a cell does, and calls its services as a person would."""

import time
from collections.abc import Iterable, Sequence
from typing import Any, Final

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, UInt8, UInt64
from trajectory_msgs.msg import JointTrajectory

from cell_operator import CellOperator
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.ros.joint_trajectories import FIELDS, field_rows, point_times, single_point
from robots_core.ros.messages import seconds
from robots_core.ros.peers.heartbeat import HEARTBEAT
from robots_core.ros.qos import STATE
from robots_core.ros.streams.polled_subscription import PolledSubscription
from robots_planning.trajectory import Trajectory

from .recording import JointSamples

DEPTH: Final = 5000
STREAM: Final = QoSProfile(depth=DEPTH, reliability=ReliabilityPolicy.BEST_EFFORT)
RELIABLE: Final = QoSProfile(depth=DEPTH)
TOPICS: Final[dict[str, tuple[Any, QoSProfile]]] = {
    'joint_reference': (JointTrajectory, STREAM),
    'joint_states': (JointState, STREAM),
    'joint_trajectory': (JointTrajectory, RELIABLE),
    'stop_status': (DiagnosticStatus, STATE),
    'drives_on': (Bool, STATE),
    'plc/word': (UInt8, RELIABLE),
}
PATH_STEP: Final = 0.005  # s of a plan between two points of its path
STALE: Final = 0.2  # s without a reference, or a sign of life
KEPT: Final = 120.0  # s of plans: a robot may have stood for long


class Observer(CellOperator):
    """Collects messages as they come, and reads them when they are asked for.

    Args:
        robot: The robot.
        domain: ROS domain.
        nodes: Those whose signs of life are looked for.
    """

    def __init__(self, robot: BaseRobotModel, domain: int, nodes: Iterable[str] = ()) -> None:
        super().__init__(domain, 'observer')
        self._robot = robot
        self._beats = {
            name: PolledSubscription(self._node, UInt64, f'{name}/{HEARTBEAT}', raw=True) for name in nodes
        }
        self._last_beats = dict.fromkeys(self._beats, -np.inf)
        self._found: dict[str, list[tuple[float, bytes]]] = {topic: [] for topic in TOPICS}
        self._subscriptions = {
            topic: PolledSubscription(self._node, kind, topic, qos, raw=True)
            for topic, (kind, qos) in TOPICS.items()
        }

    def forget(self) -> None:
        """Drop what has come, except for the newest message of each topic and newer plans."""
        recent = time.time() - KEPT
        with self._lock:
            for topic, found in self._found.items():
                keep = [item for item in found if item[0] > recent] if topic == 'joint_trajectory' else []
                self._found[topic] = keep or found[-1:]

    @property
    def hears(self) -> bool:
        """References or feedback came lately: one of the two comes as long as controller or drives run."""
        newest = (self._newest(topic) for topic in ('joint_reference', 'joint_states'))
        return any(one is not None and seconds(one.header.stamp) > time.time() - STALE for one in newest)

    @property
    def all_alive(self) -> bool:
        """All nodes have given a sign of life lately."""
        with self._lock:
            return min(self._last_beats.values(), default=np.inf) > time.monotonic() - STALE

    @property
    def moving(self) -> bool:
        """References came lately, and move the robot."""
        newest = self._newest('joint_reference')
        if newest is None or seconds(newest.header.stamp) < time.time() - STALE:
            return False
        return any(newest.points[0].velocities)

    def references(self, origin: float) -> JointSamples:
        """References since `forget`, with times from an origin (s)."""
        names, rows, times = self._robot.axes_data.names, [], []
        for sent, message in self._timed('joint_reference'):
            rows.append(single_point(message, names, 'joint_reference')[:2])
            times.append((seconds(message.header.stamp) - origin, sent - origin))
        return _samples(times, rows, len(names))

    def feedback(self, origin: float) -> JointSamples:
        """Feedback since `forget`, with times from an origin (s)."""
        names, rows, times = self._robot.axes_data.names, [], []
        for sent, message in self._timed('joint_states'):
            order = [message.name.index(name) for name in names]
            rows.append(np.array([message.position, message.velocity])[:, order])
            times.append((seconds(message.header.stamp) - origin, sent - origin))
        return _samples(times, rows, len(names))

    def path(self) -> np.ndarray:
        """Joint positions on the plans that are kept, (k, n)."""
        found = [np.empty((0, self._robot.num_axes))]
        for message in self._read('joint_trajectory'):
            if len(message.points) > 1:
                names = self._robot.axes_data.names
                rows = [field_rows(message, names, 'joint_trajectory', field) for field in FIELDS]
                trajectory = Trajectory(point_times(message), *rows)
                count = int(trajectory.duration / PATH_STEP) + 2
                found.append(trajectory.sample(np.linspace(0.0, trajectory.duration, count))[0])
        return np.concatenate(found)

    def stop(self, origin: float) -> tuple[float, str]:
        """When the first fault after the origin was latched, s after it, and its reason."""
        for sent, message in self._timed('stop_status'):
            if sent > origin and message.level != DiagnosticStatus.OK:
                return sent - origin, message.message
        return np.inf, ''

    def drives(self, origin: float) -> tuple[tuple[float, bool], ...]:
        """What the controller has said of the drives since `forget`, and before it last."""
        return tuple((sent - origin, message.data) for sent, message in self._timed('drives_on'))

    def words(self, origin: float) -> tuple[tuple[float, int], ...]:
        """What the PLC got since `forget`."""
        return tuple((sent - origin, message.data) for sent, message in self._timed('plc/word'))

    def _newest(self, topic: str) -> Any:
        with self._lock:
            data = self._found[topic][-1][1] if self._found[topic] else None
        return None if data is None else deserialize_message(data, TOPICS[topic][0])

    def _timed(self, topic: str) -> Sequence[tuple[float, Any]]:
        with self._lock:
            found = list(self._found[topic])
        return [(sent, deserialize_message(data, TOPICS[topic][0])) for sent, data in found]

    def _read(self, topic: str) -> Sequence[Any]:
        return [message for _, message in self._timed(topic)]

    def poll(self) -> None:
        """Keep what has come."""
        for name, beats in self._beats.items():
            if beats.take() is not None:
                self._last_beats[name] = time.monotonic()
        for topic, subscription in self._subscriptions.items():
            self._found[topic] += [
                (1e-9 * info['source_timestamp'], data) for data, info in subscription.take_all()
            ]


def _samples(times: list[tuple[float, float]], rows: list[Any], num_axes: int) -> JointSamples:
    values = np.array(rows).reshape(len(rows), 2, num_axes)
    due, sent = np.array(times).reshape(len(rows), 2).T
    return JointSamples(due, sent, values[:, 0], values[:, 1])
