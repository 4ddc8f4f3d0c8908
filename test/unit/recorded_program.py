"""Bags of made-up program runs: what a recorder would have written."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from robots_core.cell_interface.topic_qos import topic_qos
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_planning.trajectory import Trajectory
from written_bags import BAG_START, BAG_TYPES, write_bag

PERIOD = 0.004  # s
TYPES = BAG_TYPES.types


class RecordedProgram:
    """A program run that is made line by line; time advances as the lines require."""

    def __init__(self, robot: BaseRobotModel, *, file: str = 'made_up.lua', seed: int = 0) -> None:
        self.robot = robot
        self.file = file
        self.q = np.array(robot.home)
        self.time = 0.0
        self.messages: list[tuple[float, str, Any]] = []
        self.lag = np.random.default_rng(seed).uniform(0.0, 1e-4, robot.num_axes)
        self._tick = 0
        self._status(0, '', 'OPENED')

    def line(self, line: int, source: str) -> None:
        self._status(line, source, 'RUNNING')

    def rest(self, duration: float) -> None:
        """Stand still."""
        still = np.zeros(self.robot.num_axes)
        end = self.time + duration
        while (self._tick + 1) * PERIOD <= end + 1e-9:
            self._sample(self.q, still, still)
        self.time = end

    def move(self, trajectory: Trajectory, *, slower: float = 1.0, target: Pose | None = None) -> None:
        """Follow a trajectory, to joints or, with a target, on a line."""
        stamp = self._stamp(self.time)
        header = TYPES['std_msgs/msg/Header'](stamp=stamp, frame_id='base')
        if target is None:
            command = self._joint_state(header, trajectory.position[-1], [], [])
            self._add('/ptpjoint_joint', command)
        else:
            self._add(
                '/ptpcartesian', TYPES['geometry_msgs/msg/PoseStamped'](header=header, pose=_pose(target))
            )
        points = [
            self._point(time, *row)
            for time, row in zip(
                trajectory.time,
                zip(trajectory.position, trajectory.velocity, trajectory.acceleration, strict=True),
                strict=True,
            )
        ]
        self._add('/joint_trajectory', self._trajectory(header, points))
        start, duration = self.time, trajectory.duration * slower
        while self.time < start + duration:
            part = min((self._tick * PERIOD - start) / slower, trajectory.duration)
            q, q_dot, q_ddot = trajectory.sample(max(part, 0.0))
            self._sample(q, q_dot / slower, q_ddot / slower**2)
            self.time = self._tick * PERIOD
        self.q = trajectory.position[-1]
        self._result(stamp, 0, 'reached', self.time - start)

    def refuse(self, q: np.ndarray, why: str) -> None:
        """A motion that is not planned."""
        stamp = self._stamp(self.time)
        header = TYPES['std_msgs/msg/Header'](stamp=stamp, frame_id='base')
        self._add('/ptpjoint_joint', self._joint_state(header, q, [], []))
        self._result(stamp, 2, why)

    def outputs(self, *bits: int) -> None:
        self._add('/digital_outputs', self._bits(bits))

    def inputs(self, *bits: int) -> None:
        self._add('/lua_program_node/digital_inputs', self._bits(bits))

    def write(self, path: Path, *, state: str = 'FINISHED', error: str = '') -> Path:
        self._status(0, '', state, error)
        latched = {topic for _, topic, _ in self.messages if topic_qos(topic).published.latched}
        return write_bag(path, self.messages, latched=latched)

    # -- messages ------------------------------------------------------------------------------------

    def _add(self, topic: str, message: Any) -> None:
        self.messages.append((self.time, topic, message))

    def _sample(self, q: np.ndarray, q_dot: np.ndarray, q_ddot: np.ndarray) -> None:
        at = self._tick * PERIOD
        header = TYPES['std_msgs/msg/Header'](stamp=self._stamp(at), frame_id='')
        reference = self._trajectory(header, [self._point(PERIOD, q, q_dot, q_ddot)])
        self.messages.append((at, '/joint_reference', reference))
        self.messages.append(
            (at, '/joint_states', self._joint_state(header, q - self.lag * q_dot, q_dot, []))
        )
        self._tick += 1

    def _status(self, line: int, source: str, state: str, error: str = '') -> None:
        values = {'state': state, 'file': self.file, 'line': str(line), 'source': source, 'error': error}
        self._add('/program_status', self._diagnostics('program', 0, error, values))

    def _result(self, stamp: Any, level: int, text: str, duration: float = 0.0) -> None:
        values = {'id': f'{stamp.sec}.{stamp.nanosec:09d}', 'duration': str(duration)}
        self._add('/motion_result', self._diagnostics('motion', level, text, values))

    def _diagnostics(self, name: str, level: int, text: str, values: dict[str, str]) -> Any:
        pairs = [TYPES['diagnostic_msgs/msg/KeyValue'](key=key, value=value) for key, value in values.items()]
        return TYPES['diagnostic_msgs/msg/DiagnosticStatus'](
            level=level, name=name, message=text, hardware_id=self.robot.name, values=pairs
        )

    def _stamp(self, time: float) -> Any:
        seconds, nanoseconds = divmod(BAG_START + round(1e9 * time), 1_000_000_000)
        return TYPES['builtin_interfaces/msg/Time'](sec=seconds, nanosec=nanoseconds)

    def _point(self, time: float, q: np.ndarray, q_dot: np.ndarray, q_ddot: np.ndarray) -> Any:
        whole = int(time)
        return TYPES['trajectory_msgs/msg/JointTrajectoryPoint'](
            positions=np.asarray(q, dtype=np.float64),
            velocities=np.asarray(q_dot, dtype=np.float64),
            accelerations=np.asarray(q_ddot, dtype=np.float64),
            effort=np.empty(0),
            time_from_start=TYPES['builtin_interfaces/msg/Duration'](
                sec=whole, nanosec=round(1e9 * (time - whole))
            ),
        )

    def _trajectory(self, header: Any, points: Sequence[Any]) -> Any:
        return TYPES['trajectory_msgs/msg/JointTrajectory'](
            header=header, joint_names=list(self.robot.axes_data.names), points=list(points)
        )

    def _joint_state(self, header: Any, q: Any, q_dot: Any, effort: Any) -> Any:
        return TYPES['sensor_msgs/msg/JointState'](
            header=header,
            name=list(self.robot.axes_data.names),
            position=np.asarray(q, dtype=np.float64),
            velocity=np.asarray(q_dot, dtype=np.float64),
            effort=np.asarray(effort, dtype=np.float64),
        )

    @staticmethod
    def _bits(bits: Sequence[int]) -> Any:
        layout = TYPES['std_msgs/msg/MultiArrayLayout'](dim=[], data_offset=0)
        return TYPES['std_msgs/msg/UInt8MultiArray'](layout=layout, data=np.array(bits, dtype=np.uint8))


def _pose(pose: Pose) -> Any:
    x, y, z, w = map(float, pose.quaternion())
    return TYPES['geometry_msgs/msg/Pose'](
        position=TYPES['geometry_msgs/msg/Point'](*map(float, pose.r)),
        orientation=TYPES['geometry_msgs/msg/Quaternion'](x=x, y=y, z=z, w=w),
    )
