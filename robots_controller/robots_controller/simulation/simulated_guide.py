"""SimulatedGuide: a sensor or a person guides the simulated robot, as in a live cell."""

import contextlib
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Final, Protocol

import numpy as np

from robots_controller.cell.guide_recording import GUIDES, NANOSECONDS, GuideReplay, GuidingMessage
from robots_controller.control.control_loop import ControlLoop
from robots_controller.control.streamed_reference import StreamPoint
from robots_controller.simulation.cell_parts import CellParts
from robots_controller.simulation.record.cell_log import CellLog
from robots_core.blocks.following.following_methods import RATE
from robots_core.blocks.following.guide import Guide
from robots_core.blocks.following.realtime_movement import RealtimeMovement, RealtimeStep
from robots_core.blocks.following.sensor_guidance import SensorGuidance
from robots_core.blocks.multibody.payload import CarriedPayload
from robots_core.errors import PlanningError, RobotsError
from robots_core.periodic.periodic_schedule import PeriodicSchedule
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_planning.commands.motion_planner import MotionPlanner
from robots_planning.guidance.jogging import Jogging
from robots_planning.guidance.teach_box import JOG_RATE, TeachStep

SENSOR_PERIOD: Final = round(NANOSECONDS / RATE)  # ns
JOG_PERIOD: Final = round(NANOSECONDS / JOG_RATE)  # ns
MISSING: Final = {Guide.SENSOR: 'sensor', Guide.PERSON: 'teach box'}


class GuideSource(Protocol):
    """Where messages that guide the robot come from; times are in ns."""

    types: Mapping[str, str]
    """package/msg/Name by topic, of the messages that are to be recorded."""

    @property
    def start(self) -> int | None:
        """Since when messages come; None for not yet."""

    @property
    def next_time(self) -> float:
        """When the next one comes; infinite for never."""

    def hand_over(self, guide: Guide, now: int) -> None:
        """The program hands the robot over, or takes it back.

        Raises:
            RobotsError: there is nothing of it.
        """

    def due(self, now: int) -> Iterator[GuidingMessage]:
        """The messages that have come until `now`."""


class SensorSource:
    """A `GuideSource` without a recording, whose messages come while a sensor guides the robot."""

    start: int | None = 0

    def __init__(self) -> None:
        self.handed_over = False
        """A sensor guides the robot now."""

    @property
    def next_time(self) -> float:
        """See `GuideSource`."""
        return 0.0 if self.handed_over else math.inf

    def hand_over(self, guide: Guide, now: int) -> None:  # noqa: ARG002  # as of a recording
        """See `GuideSource`."""
        if guide is Guide.PERSON:
            raise missing(MISSING[guide])
        self.handed_over = guide is Guide.SENSOR


def missing(what: str) -> PlanningError:
    """The error to raise for what guides the robot only from a recording."""
    return PlanningError(f'a simulation has no {what}; --references names a recording of one')


class SimulatedGuide:
    """Passes on what comes from a source to the block that follows it, and its references to the controller.

    Args:
        source: What guides the robot; None for nothing.
        robot: The robot.
        control: Follows the references.
        planner: Of the robot's motions.
        log: Records messages and references.
        method: Inverse kinematics that follows poses, one of `METHODS`.

    Raises:
        RobotsError: an unknown method, or one that the robot has not.
    """

    def __init__(
        self,
        source: GuideSource | None,
        robot: BaseRobotModel,
        control: ControlLoop,
        planner: MotionPlanner,
        log: CellLog,
        *,
        method: str,
    ) -> None:
        self._control, self._planner, self._log = control, planner, log
        self._source = source
        self._sensor_times = PeriodicSchedule(SENSOR_PERIOD)
        self._jog_times = PeriodicSchedule(JOG_PERIOD)
        self._received = False  # since the last step of the sensor's stream
        if source is not None:
            movement = RealtimeMovement(robot, 1.0 / RATE, robot.home, method=method)
            self._carried = CarriedPayload(movement.load)
            self._sensor = SensorGuidance(
                movement, reference=lambda: control.controller.reference, refused=lambda *_: None
            )
            self._jogging = Jogging(
                robot,
                standing=planner.standing,
                busy=lambda: planner.moving,
                reference=lambda: control.controller.reference[0],  # type: ignore[index]
            )

    @property
    def next_time(self) -> float:
        """When something happens next, s: now while a stream moves the robot; infinite for never."""
        if self._source is None or self._source.start is None:
            return math.inf
        if self._received or self._sensor.streaming or self._jogging.active:
            return 0.0
        return self._source.next_time / NANOSECONDS

    @property
    def started(self) -> bool:
        """Messages come, or may come, in each period."""
        return self._source is not None and self._source.start is not None

    def carry(self, payload: Sequence[float]) -> None:
        """Take the payload of the settings, by its numbers (see `payload_of`)."""
        if self._source is not None:
            self._carried.carry(payload)

    def hand_over(self, guide: Guide, nanoseconds: int) -> None:
        """The program hands the robot over, or takes it back, at a time of the simulated clock, ns.

        Raises:
            RobotsError: nothing of it is recorded.
        """
        source = self._source
        if source is None:
            if guide is not Guide.NONE:
                raise missing(MISSING[guide])
            return
        if source.start is None:
            self._sensor_times.begin(nanoseconds + 1)  # of this instant, guidance has had its turn
        self.step(nanoseconds)  # what was due before the program came to this
        source.hand_over(guide, nanoseconds)
        self._sensor.hand_over(handed_over=guide is Guide.SENSOR)
        self._jogging.use_tool(self._planner.settings.tool_pose, self._planner.settings.hold)
        self._take_messages(source, nanoseconds)

    def step(self, nanoseconds: int) -> None:
        """Take what has come until now and send the controller what to follow; ns on the simulated clock."""
        source = self._source
        if source is None or source.start is None or self._control.controller.reference is None:
            return
        for time in self._sensor_times.due(nanoseconds):
            # As in nodes, a step does not use what comes after it, however rare the controller's periods are.
            self._take_messages(source, time)
            self._received = False
            self._send(self._sensor.step(time / NANOSECONDS), time, SENSOR_PERIOD)
        self._take_messages(source, nanoseconds)

    def _take_messages(self, source: GuideSource, nanoseconds: int) -> None:
        taken = -1
        for message in source.due(nanoseconds):
            if message.time > taken:  # what an earlier message of this instant has begun starts after it
                self._step_jogging(message.time - 1)
            taken = message.time
            if message.topic in GUIDES[Guide.PERSON]:
                self._jog(message)
            else:
                self._follow(message)
            if message.topic in source.types:
                self._log.guided(message, source.types[message.topic])
        self._step_jogging(nanoseconds)

    def _step_jogging(self, nanoseconds: int) -> None:
        for time in self._jog_times.due(nanoseconds) if self._jogging.active else ():
            step = self._jogging.step(time / NANOSECONDS)
            if step is None:
                self._jogging.end()
                break
            self._send(step, time, JOG_PERIOD)

    def _follow(self, message: GuidingMessage) -> None:
        if isinstance(message.value, Pose):
            self._sensor.put(message.value, message.valid / NANOSECONDS)
        elif isinstance(message.value, np.ndarray):
            self._sensor.put_twist(message.value, message.valid / NANOSECONDS)
        else:  # of a vehicle, which its cockpit has taken
            return
        self._received = True

    def _jog(self, message: GuidingMessage) -> None:
        command, begins = message.value, False
        assert isinstance(command, np.ndarray)
        age, now = (message.time - message.valid) / NANOSECONDS, message.time / NANOSECONDS
        with contextlib.suppress(RobotsError):  # jogging continues, as in a live cell
            if message.topic == 'teach_joints':
                begins = self._jogging.jog_axes(command, age, now)
            else:
                begins = self._jogging.jog_tool(command, message.frame, age, now)
        if begins:
            self._jog_times.begin(message.time + 1)

    def _send(self, step: RealtimeStep | TeachStep | None, time: int, period: int) -> None:
        if step is not None:
            due = (time + period) / NANOSECONDS
            point = StreamPoint(step.q, step.q_dot, step.q_ddot, due)
            self._control.stream(point, self._log.streamed(point, time, period))


def guide_of_cell(parts: CellParts) -> GuideSource | None:
    """What a recording guides the robot of a cell with, through its cabin if it has one; None for nothing."""
    if parts.cabin is None:
        return None if parts.references is None else GuideReplay(parts.references)
    # On demand: the filters of the cueing need SciPy.
    from robots_controller.simulation.simulated_cockpit import SimulatedCockpit  # noqa: PLC0415

    return SimulatedCockpit(parts.cabin, parts.references)
