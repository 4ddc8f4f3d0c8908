"""PathSwitching: switches outputs at their places on the path, by the controller's progress."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable
from typing import Final

from rclpy.node import Node
from rclpy.serialization import deserialize_message
from std_msgs.msg import Float64
from trajectory_msgs.msg import JointTrajectory

from robots_controller.program.motion_command import MotionCommand, OutputChange, PathSwitch
from robots_controller.program.path_switches import PathSwitches, switches_on_path
from robots_core.errors import RobotsError
from robots_core.pose import Pose
from robots_core.ros.messages import stamp_id
from robots_core.ros.qos import COMMAND, STREAM
from robots_core.validation import Array
from robots_planning.nodes.trajectory_messages import trajectory_from_message

# The controller tells its progress 25 times a second; between two messages it is extrapolated.
PROGRESS_PERIOD: Final = 0.04  # s


class PathSwitching:
    """Knows the motions that are on their way and what they switch; safe from any thread.

    The planned motion comes with the command's id, or with the last one's of a blended chain, and tells where
    the tool is at which progress. Between two messages of the controller's progress, the progress goes on at
    the speed it had: at constant speed the outputs switch within some milliseconds, while the robot
    accelerates or brakes within acceleration * (0.04 s)^2 / 2 of their place, 2 mm at 2 m/s^2.

    Args:
        node: The node to speak through.
        joint_names: The robot's joints.
        direct_kinematics: Pose of tool0 for joint positions.
        switch: Switches an output; from any thread.
    """

    def __init__(
        self,
        node: Node,
        *,
        joint_names: tuple[str, ...],
        direct_kinematics: Callable[[Array], Pose],
        switch: Callable[[OutputChange], None],
    ) -> None:
        self._joint_names = joint_names
        self._direct_kinematics = direct_kinematics
        self._switch = switch
        self._lock = threading.Lock()
        self._commands: dict[str, MotionCommand] = {}  # that wait for their plan, oldest first
        self._active: tuple[str, PathSwitches] | None = None
        self._lines: dict[PathSwitch, int] = {}
        self._timer: threading.Timer | None = None
        # A motion that switches nothing is not worth its deserialization.
        node.create_subscription(JointTrajectory, 'joint_trajectory', self._on_trajectory, COMMAND, raw=True)
        node.create_subscription(Float64, 'motion_progress', self._on_progress, STREAM)

    def watch(self, id_: str, command: MotionCommand) -> None:
        """A motion was sent."""
        with self._lock:
            self._commands[id_] = command
            self._lines |= dict.fromkeys(command.switches, command.line)

    def finish(self, id_: str, *, ok: bool) -> None:
        """A motion has ended: what it has not switched on a way that led to its end is switched now."""
        with self._lock:
            command = self._commands.pop(id_, None)
            if command is not None and ok:
                self._switch_all(command.switches)
            if self._active is not None and (self._active[0] == id_ or not ok):
                _, switches = self._active
                self._active = None
                if ok:
                    self._switch_all(switches.due(1.0))
            if not ok:
                self._commands.clear()

    def _on_trajectory(self, data: bytes) -> None:
        with self._lock:
            if not any(command.switches for command in self._commands.values()):
                return
        message = deserialize_message(data, JointTrajectory)
        id_ = stamp_id(message.header.stamp)
        with self._lock:
            if id_ not in self._commands:
                return
            ids = list(self._commands)
            chain = [self._commands.pop(one) for one in ids[: ids.index(id_) + 1]]
        try:
            trajectory = trajectory_from_message(message, self._joint_names)
        except RobotsError:  # the controller refuses it and says why
            return
        switches = switches_on_path(chain, trajectory, self._direct_kinematics)
        with self._lock:
            self._active = (id_, switches)

    def _on_progress(self, message: Float64) -> None:
        now, progress = time.monotonic(), message.data
        with self._lock:
            # The end of the motion before may come after the plan of this one: `finish` tells the end.
            if self._active is None or progress >= 1.0:
                return
            id_, switches = self._active
            self._switch_all(switches.due(progress))
            delay = switches.delay(now, progress)
            if delay is not None and delay < 2.0 * PROGRESS_PERIOD:
                if self._timer is not None:
                    self._timer.cancel()
                at = switches.next_progress
                assert at is not None
                self._timer = threading.Timer(delay, self._on_time, (id_, at))
                self._timer.daemon = True
                self._timer.start()

    def _on_time(self, id_: str, progress: float) -> None:
        with self._lock:
            if self._active is not None and self._active[0] == id_:
                self._switch_all(self._active[1].due(progress))

    def _switch_all(self, due: Iterable[PathSwitch]) -> None:
        for switch in due:
            line = self._lines.get(switch, 0)
            self._switch(OutputChange(switch.kind, switch.index, switch.value, line))
