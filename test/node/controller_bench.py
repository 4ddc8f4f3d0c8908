"""A controller with its drive, and what the tests send to it."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from bench import Bench
from late_drives import PATIENT, SPARSE
from robots_controller.nodes.controller_node import ControllerNode
from robots_core import load_robot_model
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.nodes.drive_node import DriveNode
from robots_core.ros.messages import doubles, id_stamp, motion_result_from_message, stamp_id
from robots_core.ros.qos import COMMAND, STATE

ROBOT = load_robot_model('kuka_kr210_r2700')
NAMES = list(ROBOT.axes_data.names)
HOME = np.array(ROBOT.home)
AWAY = HOME + np.array([0.2, 0.1, -0.1, 0.3, 0.2, 0.1])
FAST_DRIVES = {'bandwidth': [40.0]}
# One process runs the test too, which no thread may push aside.
OPTIONS = {'robot_model': 'kuka_kr210_r2700', 'realtime_priority': 0, **SPARSE}
STANDING = 20  # references that are the same; 25 come a second
CRAWL = 0.02  # override: no machine comes too late for what happens on the way


class ControllerBench(Bench):
    """A controller with its drive; the test sends trajectories."""

    def __init__(
        self,
        runner: Any,
        *,
        feedback_timeout: float = PATIENT,
        watchdog: float = PATIENT,
        controller: Mapping[str, Any] = MappingProxyType({}),
        operating_mode: str = 'AUTOMATIC',
        **drives: Any,
    ) -> None:
        super().__init__(runner, 'planner')
        self.newest_reference = 0.0  # s
        self.newest_state = 0.0  # s
        self.references = self.collect('joint_reference', JointTrajectory, read=self._reference)
        self.positions = self.collect('joint_states', JointState, read=self._state)
        self.results = self.collect('motion_result', DiagnosticStatus, COMMAND, motion_result_from_message)
        self.progress = self.collect('motion_progress', Float64, read=lambda message: message.data)
        self.drive = self.start_node(DriveNode, **OPTIONS, **(drives or FAST_DRIVES))
        self.controller = self.start_node(
            ControllerNode,
            **OPTIONS,
            feedback_timeout=feedback_timeout,
            watchdog=watchdog,
            operating_mode=operating_mode,
            **controller,
        )
        self.trajectories = self.publisher('joint_trajectory', JointTrajectory)
        self.wait(lambda: self.references, 'first reference')

    def _reference(self, message: JointTrajectory) -> np.ndarray:
        self.newest_reference = float(stamp_id(message.header.stamp))
        return np.array(message.points[0].positions)

    def _state(self, message: JointState) -> np.ndarray:
        self.newest_state = float(stamp_id(message.header.stamp))
        return np.array(message.position)

    def override(self, value: float) -> None:
        self.publish('override', Float64(data=value), STATE)
        self.wait(lambda: self.controller._controller.speed.override == value, 'the override')

    def send_slowly(self, goal: np.ndarray, duration: float = 1.0) -> str:
        """Send a motion that crawls until the override is 1 again, and wait until it moves."""
        self.override(CRAWL)
        id_ = self.send(HOME, goal, duration)
        self.wait(lambda: np.any(self.references[-1] != HOME), 'a moving robot')
        return id_

    def stamp(self) -> str:
        """The id of a motion that is commanded now."""
        return stamp_id(self.peer.get_clock().now().to_msg())

    def send(
        self,
        start: np.ndarray,
        goal: np.ndarray,
        duration: float = 1.0,
        names: list[str] | None = None,
        id_: str = '',
    ) -> str:
        """Send a minimum-jerk motion, stamped now if it has no id; returns its id."""
        zero = doubles(np.zeros(start.size))
        message = JointTrajectory(joint_names=names or NAMES)
        message.header.stamp = id_stamp(id_ or self.stamp())
        for time, q in ((0.0, start), (duration, goal)):
            point = JointTrajectoryPoint(positions=doubles(q), velocities=zero, accelerations=zero)
            point.time_from_start.sec, point.time_from_start.nanosec = int(time), int(1e9 * (time % 1))
            message.points.append(point)
        self.trajectories.publish(message)
        return stamp_id(message.header.stamp)

    def result(self) -> MotionResult:
        self.wait(lambda: self.results, 'motion_result')
        # On a busy machine the last references and states come after it.
        now = 1e-9 * self.peer.get_clock().now().nanoseconds
        self.wait(lambda: self.newest_reference >= now, 'the references until now')
        if self.drive._loop.alive:
            self.wait(lambda: self.newest_state >= now, 'the states until now')
        return self.results.pop(0)

    def ask(self, service: str) -> None:
        assert self.call(f'controller_node/{service}').success

    def until_standing(self) -> None:
        count = len(self.references)
        self.wait(
            lambda: (
                len(self.references) > count + STANDING
                and np.ptp(self.references[-STANDING:], axis=0).max() == 0.0
            ),
            'a standing robot',
        )
