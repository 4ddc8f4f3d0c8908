"""SimulatedBag: a bag with the topics of a live recording, stamped with the simulated time."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Connection

from robots_controller.recording.bag_qos import bag_qos_of
from robots_controller.recording.crash_safe_writer import CrashSafeWriter
from robots_controller.recording.message_rows import MessageRows, marks
from robots_controller.simulation.record import ros_messages as ros
from robots_controller.simulation.record.recording import Recording
from robots_controller.simulation.record.ros_messages import BUILD
from robots_controller.simulation.simulated_clock import START
from robots_core.errors import BagError, RobotsError
from robots_core.orientation import quaternions_of
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array

TCP_RATE: Final = 50.0  # Hz
# Samples wait for each other to be written at once, but not for longer than that a kill may cost.
MOST_WAITING: Final = 250
# The end of a bag costs as much as seconds of a simulation; what a kill costs can be simulated again.
CHUNKS: Final = 64
MOST_AT_ONCE: Final = 4096  # of a robot that stood for long; bounds the memory


class SimulatedBag:
    """Writes what a `Recording` holds, and messages in between.

    Args:
        path: Folder of the bag; must not exist.
        robot: The robot.
        period: Of the controller, s.
        recording: Holds the samples.

    Raises:
        RobotsError: the folder exists or cannot be made.
    """

    problem: RobotsError | None = None
    """Why the bag ends early; None if it does not."""

    def __init__(self, path: Path, robot: BaseRobotModel, *, period: float, recording: Recording) -> None:
        self.path = path
        self._robot = robot
        self._recording = recording
        self._written = 0
        self._waiting: dict[str, list[tuple[int, float | Array]]] = {
            'measured_wrench': [],
            'motion_progress': [],
        }
        self._names = robot.axes_data.names
        self._tcp_every = max(1, round(1.0 / (TCP_RATE * period)))
        self._connections: dict[str, Connection] = {}
        self._rows = self._templates(period)
        if path.exists():
            raise BagError(f'{path} exists already; a bag needs a folder of its own')
        self._writer = CrashSafeWriter(path, chunks=CHUNKS)
        try:
            self._writer.open()
        except OSError as error:
            raise BagError(f'{path}: the bag cannot be made: {error.strerror}') from error
        self.write('robot_description', 0, BUILD.value(robot.description))

    def write(self, topic: str, nanoseconds: int, message: Any) -> None:
        """Write a message, after the samples before it.

        Args:
            topic: Below the cell's namespace, or global.
            nanoseconds: Since the start of the program.
            message: As `ros_messages` makes them.
        """
        self.write_serialized(topic, message.__msgtype__, nanoseconds, ros.serialized(message))

    def write_serialized(
        self, topic: str, type_name: str, nanoseconds: int, data: bytes | memoryview
    ) -> None:
        """The same of a message that is serialized already."""
        self.write_samples()
        with self._ended_by_errors():
            self._writer.write(self._connection(topic, type_name), START + nanoseconds, data)

    def add_row(self, topic: str, nanoseconds: int, values: float | Array) -> None:
        """Write the values of a message with the samples: `motion_progress`, or `measured_wrench` (6,)."""
        self._waiting[topic].append((nanoseconds, values))

    @property
    def room(self) -> int:
        """How many more samples may wait."""
        return MOST_WAITING - 1 - (self._recording.count - self._written)

    def write_samples_in_time(self) -> None:
        """Write the samples if many wait."""
        if self.room < 0:
            self.write_samples()

    def write_samples(self) -> None:
        """Write all samples that are not written yet."""
        while self._written < self._recording.count:
            first = self._written
            self._written = min(first + MOST_AT_ONCE, self._recording.count)
            self._write_part(first, self._written)

    def _write_part(self, first: int, end: int) -> None:
        part = slice(first, end)
        stamps = START + self._recording.nanoseconds[part]
        reference, state = self._recording.reference[part], self._recording.state[part]
        self._write_rows('joint_reference', stamps, [reference[:, i] for i in range(3)])
        self._write_rows('joint_states', stamps, [state[:, i] for i in range(state.shape[1])])
        every = slice(-first % self._tcp_every, None, self._tcp_every)
        positions = state[every, 0]
        if len(positions):
            r, T = self._robot.tool_poses(positions)
            self._write_rows('tcp_pose', stamps[every], [np.hstack([r, quaternions_of(T)])])
        for topic, rows in self._waiting.items():
            if rows:
                times, values = zip(*rows, strict=True)
                rows.clear()
                self._write_rows(topic, START + np.array(times), [np.array(values)])

    def close(self) -> None:
        """Write what has come and end."""
        self.write_samples()
        with self._ended_by_errors():
            self._writer.close()

    # -- inside -----------------------------------------------------------------------------------

    def _write_rows(self, topic: str, stamps: NDArray[np.int64], values: list[Array]) -> None:
        rows = self._rows[topic]
        with self._ended_by_errors():
            self._writer.write_rows(
                self._connection(topic, rows.type_name), stamps, rows.fill(stamps, values)
            )

    @contextmanager
    def _ended_by_errors(self) -> Iterator[None]:
        # Not raised here: it is no error of the program, in whose thread this may be.
        try:
            yield
        except RobotsError as error:
            self.problem = error

    def _connection(self, topic: str, type_name: str) -> Connection:
        if topic not in self._connections:
            self._connections[topic] = self._writer.add_connection(
                topic if topic.startswith('/') else f'/{topic}',
                type_name,
                typestore=ros.typestore(),
                offered_qos_profiles=[bag_qos_of(topic)],
            )
        return self._connections[topic]

    def _templates(self, period: float) -> dict[str, MessageRows]:
        n = len(self._names)
        rows, mark, wrench, pose = [marks(n, i) for i in range(3)], marks(1, 0), marks(6, 0), marks(7, 0)
        states = rows[: self._recording.state.shape[1]]
        point = round(1e9 * period), rows[0], rows[1], rows[2]
        tcp = BUILD.pose_stamped(0, Pose.identity())
        tcp.pose = BUILD.pose(pose[:3], pose[3:])
        templates: dict[str, tuple[Any, list[Array]]] = {
            'joint_reference': (BUILD.joint_trajectory(0, self._names, [point]), rows),
            'joint_states': (BUILD.joint_state(0, self._names, *states), states),
            'tcp_pose': (tcp, [pose]),
            'measured_wrench': (BUILD.wrench_stamped(0, wrench), [wrench]),
            'motion_progress': (BUILD.value(float(mark[0])), [mark]),
        }
        return {
            topic: MessageRows(ros.typestore(), message, groups)
            for topic, (message, groups) in templates.items()
        }
