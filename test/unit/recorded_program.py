"""Bags of made-up program runs: what a recorder would have written."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from robots_controller.simulation.record.ros_messages import BUILD, id_of
from robots_core.cell_interface.topic_qos import topic_qos
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.status import Level, Status
from robots_planning.trajectory import Trajectory
from written_bags import BAG_START, write_bag

PERIOD = 0.004  # s


class RecordedProgram:
    """A program run that is made line by line; time advances as the lines require."""

    def __init__(self, robot: BaseRobotModel, *, file: str = 'made_up.lua', seed: int = 0) -> None:
        self.robot = robot
        self._names = robot.axes_data.names
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
        if target is None:
            self._add('/ptpjoint_joint', BUILD.joint_state(stamp, self._names, trajectory.position[-1]))
        else:
            self._add('/ptpcartesian', BUILD.pose_stamped(stamp, target))
        times, rows = trajectory.points_of_message()
        points = zip(times.tolist(), *rows, strict=True)
        self._add('/joint_trajectory', BUILD.joint_trajectory(stamp, self._names, points))
        start, duration = self.time, trajectory.duration * slower
        while self.time < start + duration:
            part = min((self._tick * PERIOD - start) / slower, trajectory.duration)
            q, q_dot, q_ddot = trajectory.sample(max(part, 0.0))
            self._sample(q, q_dot / slower, q_ddot / slower**2)
            self.time = self._tick * PERIOD
        self.q = trajectory.position[-1]
        self._result(stamp, Level.OK, 'reached', self.time - start)

    def refuse(self, q: np.ndarray, why: str) -> None:
        """A motion that is not planned."""
        stamp = self._stamp(self.time)
        self._add('/ptpjoint_joint', BUILD.joint_state(stamp, self._names, q))
        self._result(stamp, Level.ERROR, why)

    def outputs(self, *bits: int) -> None:
        self._add('/digital_outputs', BUILD.image('digital_outputs', np.array(bits), labelled=False))

    def inputs(self, *bits: int) -> None:
        self._add(
            '/lua_program_node/digital_inputs', BUILD.image('digital_inputs', np.array(bits), labelled=False)
        )

    def write(self, path: Path, *, state: str = 'FINISHED', error: str = '') -> Path:
        self._status(0, '', state, error)
        latched = {topic for _, topic, _ in self.messages if topic_qos(topic).published.latched}
        return write_bag(path, self.messages, latched=latched)

    # -- messages ------------------------------------------------------------------------------------

    def _add(self, topic: str, message: Any) -> None:
        self.messages.append((self.time, topic, message))

    def _sample(self, q: np.ndarray, q_dot: np.ndarray, q_ddot: np.ndarray) -> None:
        at = self._tick * PERIOD
        stamp, point = self._stamp(at), (round(1e9 * PERIOD), q, q_dot, q_ddot)
        reference = BUILD.joint_trajectory(stamp, self._names, [point])
        state = BUILD.joint_state(stamp, self._names, q - self.lag * q_dot, q_dot)
        self.messages += [(at, '/joint_reference', reference), (at, '/joint_states', state)]
        self._tick += 1

    def _status(self, line: int, source: str, state: str, error: str = '') -> None:
        values = {'state': state, 'file': self.file, 'line': line, 'source': source, 'error': error}
        self._add('/program_status', BUILD.status(Status('program', error, values=values), self.robot.name))

    def _result(self, stamp: int, level: Level, text: str, duration: float = 0.0) -> None:
        status = Status('motion', text, level, {'id': id_of(stamp), 'duration': duration})
        self._add('/motion_result', BUILD.status(status, self.robot.name))

    @staticmethod
    def _stamp(time: float) -> int:
        return BAG_START + round(1e9 * time)
