"""SimulatedGuide: a recorded sensor or person guides the simulated robot, as in a live cell."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import Final

import numpy as np

from robots_controller.control.control_loop import ControlLoop
from robots_controller.control.streamed_reference import StreamPoint
from robots_controller.simulation.guide_recording import (
    GUIDES,
    NANOSECONDS,
    GuideRecording,
    GuidingMessage,
)
from robots_core.blocks.following.following_methods import LARGEST_DEVIATION, RATE
from robots_core.errors import PlanningError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.realtime_movement import MovementState, RealtimeMovement
from robots_planning.robot_command_state import RobotCommandState
from robots_planning.teach_box import JOG_DEVIATION, JOG_RATE, TeachBox

ROUNDING: Final = 1e-9  # s
NOBODY: Final[Mapping[RobotCommandState, str]] = MappingProxyType(
    {
        RobotCommandState.TRAJECTORY: 'a simulation has no sensor; --references names a recording of one',
        RobotCommandState.TEACH: 'a simulation has nobody who jogs; --references names a recording of one',
    }
)


class _Follower(ABC):
    """Makes joint references of what guides the robot.

    Args:
        rate: References per second, Hz.
    """

    def __init__(self, rate: float) -> None:
        self.period = 1.0 / rate
        self.wanted = False
        self.streaming = False
        self._next = 0.0  # s, when the next step of a stream is due

    @abstractmethod
    def put(self, message: GuidingMessage, valid: float, reference: Array) -> None:
        """Take a message that was valid at a time, s."""

    @abstractmethod
    def step(self, now: float, reference: Array) -> Array | None:
        """The next reference (3, n), or None for a robot that nobody moves."""

    def states(self, now: float, reference: Array) -> Iterator[tuple[Array, float]]:
        """The references (3, n) that are made until now, and when each is due, s."""
        due = self._next if self.streaming else now
        while (self.wanted or self.streaming) and due <= now + ROUNDING:
            state = self.step(due, reference)
            due += self.period
            if state is not None:
                yield state, due
        self._next = due

    def let_go(self) -> None:
        """The robot is taken back: it shall stop."""
        self.wanted = False


class _SensorFollower(_Follower):
    """As inverse_kinematics_node."""

    def __init__(self, robot: BaseRobotModel, method: str) -> None:
        super().__init__(RATE)
        self._movement = RealtimeMovement(robot, self.period, robot.home, method=method)
        self._q = robot.home

    def put(self, message: GuidingMessage, valid: float, reference: Array) -> None:  # noqa: ARG002
        if not self.wanted:
            return
        if isinstance(message.value, Pose):
            self._movement.put(message.value, valid)
        else:
            self._movement.put_twist(message.value, valid)

    def step(self, now: float, reference: Array) -> Array | None:
        away = np.abs(reference[0] - self._q).max() > LARGEST_DEVIATION
        if away or not self.streaming:
            self._movement.place(reference[0], reference[1] if self.streaming else None)
        step = self._movement.step(now)
        self._q = step.q
        self.streaming = step.state is not MovementState.IDLE
        return np.array([step.q, step.q_dot, step.q_ddot]) if self.streaming else None

    def let_go(self) -> None:
        super().let_go()
        self._movement.let_go()


class _JogFollower(_Follower):
    """As planning_node."""

    def __init__(self, robot: BaseRobotModel) -> None:
        super().__init__(JOG_RATE)
        self._robot = robot
        self._box = TeachBox(robot, self.period, robot.home)
        self._tool = Pose.identity()

    def use_tool(self, tool: Pose) -> None:
        """Jog this tool centre point, which is a pose in tool0."""
        if self._tool.distance_to(tool) != (0.0, 0.0):
            self._tool = tool
            self._box = TeachBox(self._robot, self.period, self._robot.home, tool=tool)

    def put(self, message: GuidingMessage, valid: float, reference: Array) -> None:
        command = message.value
        assert isinstance(command, np.ndarray)
        if not self.streaming:
            if not (self.wanted and command.any()):
                return
            self._box.place(reference[0])
            self.streaming = True
        if message.topic == 'teach_joints':
            self._box.jog_axes(command, valid)
        else:
            self._box.jog_tool(command, valid, message.frame)

    def step(self, now: float, reference: Array) -> Array | None:
        if not self.streaming:
            return None
        if np.abs(reference[0] - self._box.q).max() > JOG_DEVIATION:
            self.streaming = False  # the controller does not follow: it was stopped
            return None
        step = self._box.step(now)
        self.streaming = step.jogging or not step.standing or bool(step.q_ddot.any())
        return np.array([step.q, step.q_dot, step.q_ddot])


class SimulatedGuide:
    """Plays a recording from when the program hands its robot over for the first time.

    Args:
        recording: What guides the robot; None for nothing.
        robot: The robot.
        control: Follows the references.
        method: Inverse kinematics that follows poses, one of `METHODS`.
        on_message: A message has come; with its type.
        on_point: A point goes to the controller, and there is this time between two, s; returns its id.

    Raises:
        RobotsError: an unknown method, or one that the robot has not.
    """

    def __init__(
        self,
        recording: GuideRecording | None,
        robot: BaseRobotModel,
        control: ControlLoop,
        *,
        method: str,
        on_message: Callable[[GuidingMessage, str], None],
        on_point: Callable[[StreamPoint, float], str],
    ) -> None:
        self._recording, self._control = recording, control
        self._on_message, self._on_point = on_message, on_point
        self._messages = deque(() if recording is None else recording.messages)
        self._start: int | None = None  # ns
        if recording is not None:
            self._sensor, self._jog = _SensorFollower(robot, method), _JogFollower(robot)

    @property
    def next_time(self) -> float:
        """When something happens next, s: now while a stream moves the robot; infinite for never."""
        if self._start is None:
            return math.inf
        if self._sensor.streaming or self._jog.streaming:
            return 0.0
        if not self._messages:
            return math.inf
        return (self._start + self._messages[0].time) / NANOSECONDS

    def hand_over(self, state: RobotCommandState, nanoseconds: int, tool: Pose) -> None:
        """The program hands the robot over, or takes it back.

        Args:
            state: TRAJECTORY or TEACH; IDLE.
            nanoseconds: On the simulated clock.
            tool: Pose of the program's tool in tool0, which a person jogs.

        Raises:
            RobotsError: nothing is recorded that guides the robot in this state.
        """
        if state is not RobotCommandState.IDLE:
            if self._recording is None:
                raise PlanningError(NOBODY[state])
            self._recording.check(state)
            if self._start is None:
                self._start = nanoseconds
        elif self._recording is None:
            return
        if state is RobotCommandState.TRAJECTORY:
            self._sensor.wanted = True
        elif state is RobotCommandState.TEACH:
            self._jog.use_tool(tool)
            self._jog.wanted = True
        else:
            self._sensor.let_go()
            self._jog.let_go()

    def step(self, nanoseconds: int) -> None:
        """Take what has come until now and send the controller what to follow; ns on the simulated clock."""
        reference = self._control.controller.reference
        if self._start is None or reference is None:
            return
        self._take_messages(self._start, nanoseconds, reference)
        now = nanoseconds / NANOSECONDS
        for follower in (self._sensor, self._jog):
            for state, due in follower.states(now, reference):
                point = StreamPoint(state[0], state[1], state[2], due)
                id_ = self._on_point(point, follower.period)
                self._control.stream(point, id_)

    def _take_messages(self, start: int, nanoseconds: int, reference: Array) -> None:
        assert self._recording is not None
        while self._messages and start + self._messages[0].time <= nanoseconds:
            message = self._messages.popleft()
            follower = self._jog if message.topic in GUIDES[RobotCommandState.TEACH] else self._sensor
            follower.put(message, (start + message.valid) / NANOSECONDS, reference)
            self._on_message(message, self._recording.types[message.topic])
