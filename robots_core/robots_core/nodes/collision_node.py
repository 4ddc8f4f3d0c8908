"""collision_node: watches the robot and its path ahead, and stops it before it collides."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory

from robots_core.blocks.collision.joint_path import JointPath
from robots_core.blocks.collision.path_search import RESOLUTION
from robots_core.blocks.collision.results import PathProximity, Proximity
from robots_core.blocks.collision.scene import Scene
from robots_core.blocks.collision_detection import ENGINES, CollisionDetection, checked_margin
from robots_core.errors import InvalidInputError, RobotsError
from robots_core.nodes.watched_scene import WatchedScene
from robots_core.ros.messages import (
    diagnostic_status,
    joint_indices,
    joint_values,
    motion_result_from_message,
    seconds,
    stamp_id,
)
from robots_core.ros.polled_subscription import PolledSubscription
from robots_core.ros.qos import COMMAND, SENSOR, STATE, STREAM
from robots_core.ros.robot_node import RobotNode, bounded
from robots_core.ros.run import run
from robots_core.validation import Array

MAX_RATE = 250.0  # Hz
# Less than what the planner keeps: a robot that lags behind its reference by a millimetre needs no stop.
DEFAULT_MARGIN = 0.002  # m
# A look, a call of the service and a period of the controller may pass before a guided robot brakes.
REACTION_TIME = 0.1  # s
SERVICE_PERIOD = 5.0  # s between complaints that nobody can stop the robot


@dataclass
class _Motion:
    """A motion that runs or waits, and the place on it that comes too close to something."""

    path: JointPath
    danger: PathProximity | None = None
    stopped: bool = False


class CollisionNode(RobotNode):
    """Publishes `collision_status` and `min_distance`, and stops the controller when the margin is undercut.

    The path of every `joint_trajectory` is looked at when it comes and when the scene changes, so that
    nothing between two looks at the robot is missed; the controller is stopped on its path as soon as a place
    that is too close lies within `lookahead`. The robot itself is looked at `rate` times a second. Where a
    stream guides it there is no path: it is stopped as soon as the way that it needs to brake is not free.

    Parameters:
        scene: Scene file; further objects come on `collision_objects`.
        collision_margin: Distance to keep, m.
        collision_engine: 'fcl' or 'coal'.
        lookahead: How far ahead on the path a place may be, s, when the controller is stopped.
        rate: Looks at the robot per second, Hz.
        controller: Node whose `~/stop` is called.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__('collision_node', **options)
        self._margin = checked_margin(
            self.parameter(
                'collision_margin',
                DEFAULT_MARGIN,
                'distance to keep, m',
                check=checked_margin,
                read_only=True,
            )
        )
        engine = self.parameter(
            'collision_engine', 'fcl', f'one of {", ".join(ENGINES)}', check=_known_engine, read_only=True
        )
        self._lookahead = self.parameter(
            'lookahead', 1.0, 'stop this long before, s', check=bounded(0.0, 60.0, 's'), read_only=True
        )
        rate = self.parameter(
            'rate', 25.0, 'looks per second, Hz', check=bounded(0.1, MAX_RATE, 'Hz'), read_only=True
        )
        controller = self.parameter(
            'controller', 'controller_node', 'node whose ~/stop is called', read_only=True
        )
        self._detection = CollisionDetection(self.robot, engine=engine)
        self._names = list(self.robot.axes_data.names)
        self._motions: dict[str, _Motion] = {}
        self._progress = 0.0
        self._floor = self._margin
        self._stopping: Any = None
        self._guided_into = False

        self._status = self.create_publisher(DiagnosticStatus, 'collision_status', STATE)
        self._distance = self.create_publisher(Float64, 'min_distance', STATE)
        self._stop = self.create_client(Trigger, f'{controller}/stop')
        self._scene = WatchedScene(self, self._on_scene)
        self._joint_states: PolledSubscription[JointState] = PolledSubscription(
            self, JointState, 'joint_states', SENSOR
        )
        self.create_subscription(JointTrajectory, 'joint_trajectory', self._on_trajectory, COMMAND)
        self.create_subscription(Float64, 'motion_progress', self._on_progress, STREAM)
        self.create_subscription(DiagnosticStatus, 'motion_result', self._on_result, COMMAND)
        self.create_timer(1.0 / rate, self._look)

    # -- what comes in -------------------------------------------------------------------------------

    def _on_scene(self, scene: Scene) -> None:
        self._detection.set_scene(scene)
        for motion, now in self._times():
            motion.danger = self._detection.first_approach(motion.path, margin=self._margin, since=now)
        self._stop_before_dangers()
        if not any(motion.stopped for motion in self._motions.values()):
            self.ready(objects=len(scene.objects))

    def _on_trajectory(self, message: JointTrajectory) -> None:
        try:
            path = self._path(message)
            if path is None:
                return
            motion = _Motion(path, self._detection.first_approach(path, margin=self._margin))
        except RobotsError as error:
            self.refuse('joint_trajectory', error, stream=True)
            return
        if not self._motions:
            self._progress = 0.0
        self._motions[stamp_id(message.header.stamp)] = motion
        start = self._detection.distance(path.sample(path.start))
        closest = np.inf if start is None else start.distance
        self._floor = min(self._margin, max(closest - 2.0 * RESOLUTION, 0.0))
        self._stop_before_dangers()

    def _path(self, message: JointTrajectory) -> JointPath | None:
        """The path of a trajectory; None for an empty one, which stops, and for a streamed reference."""
        if len(message.points) < 2:
            return None
        indices = joint_indices(message.joint_names, self._names, 'joint_trajectory')
        count = len(message.joint_names)
        for number, point in enumerate(message.points, 1):
            if not len(point.positions) == len(point.velocities) == len(point.accelerations) == count:
                raise InvalidInputError(
                    f'point {number} must have {count} positions, velocities and accelerations each'
                )
        position, velocity, acceleration = (
            np.array([getattr(point, field) for point in message.points], dtype=np.float64)[:, indices]
            for field in ('positions', 'velocities', 'accelerations')
        )
        time = [seconds(p.time_from_start) for p in message.points]
        return JointPath(np.array(time), position, velocity, acceleration)

    def _on_progress(self, message: Float64) -> None:
        self._progress = message.data
        self._stop_before_dangers()

    def _on_result(self, message: DiagnosticStatus) -> None:
        if self._motions.pop(motion_result_from_message(message).id, None) is not None:
            self._progress = 0.0
            if not self._motions:
                self.ready(objects=len(self._detection.scene.objects))

    # -- what goes out -------------------------------------------------------------------------------

    def _look(self) -> None:
        message = self._joint_states.take()
        if message is None:
            return
        try:
            q = joint_values(message.name, message.position, self._names, 'joint_states')
            closest = self._detection.distance(q)
            if not self._motions:
                self._watch_guided(message, q)
        except RobotsError as error:
            self.refuse('joint_states', error, stream=True)
            return
        distance = np.inf if closest is None else closest.distance
        self._distance.publish(Float64(data=distance))
        if distance < self._floor and closest is not None:
            for motion in self._motions.values():
                self._stop_motion(motion, closest.describe())
        self._publish_status(q, closest)

    def _watch_guided(self, message: JointState, q: Array) -> None:
        """Stop a robot that moves without a path before it comes too close to something."""
        if not message.velocity:
            return
        q_dot = joint_values(message.name, message.velocity, self._names, 'joint_states velocities')
        time = REACTION_TIME + float((np.abs(q_dot) / self.robot.axes_data.acceleration).max())
        danger = self._detection.first_approach(JointPath.straight(q, q + time * q_dot), margin=self._margin)
        if danger is None:
            if self._guided_into:
                self.ready(objects=len(self._detection.scene.objects))
            self._guided_into = False
        elif self._stopping is None or self._stopping.done():
            self._guided_into = self._call_stop(danger.proximity.describe())

    def _publish_status(self, q: Array, closest: Proximity | None) -> None:
        level, text, values = DiagnosticStatus.OK, 'nothing to collide with', {}
        if closest is not None:
            values = {
                'first': closest.first,
                'second': closest.second,
                'distance': closest.distance,
                'point_first': _triple(closest.point_first),
                'point_second': _triple(closest.point_second),
            }
            text = closest.describe()
            if closest.distance < self._margin:
                level = DiagnosticStatus.ERROR
        danger = next((motion.danger for motion in self._motions.values() if motion.danger), None)
        if danger is not None:
            level = max(level, DiagnosticStatus.WARN)
            values['ahead'] = danger.describe()
            if level == DiagnosticStatus.WARN:
                text = f'ahead: {danger.describe()}'
        if closest is not None and closest.in_contact:
            values['contacts'] = '; '.join(' - '.join(pair) for pair in self._detection.contacts(q))
        self._status.publish(
            diagnostic_status(
                'collision', text, level=level, hardware_id=self.robot_name, margin=self._margin, **values
            )
        )

    def _times(self) -> list[tuple[_Motion, float]]:
        """All motions with their path times, s; those that wait for the first are at their start."""
        done = self._progress
        times = []
        for motion in self._motions.values():
            times.append((motion, motion.path.start + done * (motion.path.end - motion.path.start)))
            done = 0.0
        return times

    def _stop_before_dangers(self) -> None:
        """Stop where a place that is too close is not far ahead."""
        for motion, now in self._times():
            place = motion.danger
            if place is not None and now <= place.time <= now + self._lookahead:
                self._stop_motion(motion, place.describe())

    def _stop_motion(self, motion: _Motion, reason: str) -> None:
        if not motion.stopped:
            motion.stopped = self._call_stop(reason)

    def _call_stop(self, reason: str) -> bool:
        """Ask the controller to stop; False if nobody is there to be asked."""
        if not self._stop.service_is_ready():
            self.report_health(DiagnosticStatus.ERROR, f'nobody serves {self._stop.srv_name}: {reason}')
            self.get_logger().error(  # type: ignore[no-untyped-call]
                f'nobody serves {self._stop.srv_name} to stop the robot: {reason}',
                throttle_duration_sec=SERVICE_PERIOD,
            )
            return False
        self.get_logger().error(  # type: ignore[no-untyped-call]
            f'stopping the controller: {reason}', throttle_duration_sec=SERVICE_PERIOD
        )
        self.report_health(DiagnosticStatus.ERROR, f'stopped the controller: {reason}')
        self._stopping = self._stop.call_async(Trigger.Request())
        return True


def _triple(point: Array) -> str:
    return ' '.join(f'{value:.6f}' for value in point)


def _known_engine(name: Any) -> None:
    if name not in ENGINES:
        raise InvalidInputError(f'unknown engine {name!r}; engines are {", ".join(ENGINES)}')


def main() -> None:
    """Start the node."""
    sys.exit(run(CollisionNode))


if __name__ == '__main__':
    main()
