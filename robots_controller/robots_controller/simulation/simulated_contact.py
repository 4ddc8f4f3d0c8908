"""SimulatedContact: the simulated robot's wheel on its soil, its force sensor, and force control."""

import math
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import Final

from robots_controller.cell.contact_setup import ContactSetup
from robots_controller.cell.force_guide import PERIOD, ForceGuide
from robots_controller.cell.guide_recording import NANOSECONDS, GuidingMessage
from robots_controller.io.io_image import IoImage
from robots_controller.program.joint_feedback import JointFeedback
from robots_core.blocks.following.guide import Guide
from robots_core.errors import PlanningError
from robots_core.periodic_schedule import PeriodicSchedule
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array

TOPIC: Final = 'reference_twist'


class SimulatedContact:
    """A `GuideSource` that presses by force, 250 times a second, on what the sensor measured last.

    Args:
        setup: What the tool touches, and how it presses.
        robot: The robot.
        io: The program's outputs.
        on_problem: See `ForceGuide`.
    """

    types: Mapping[str, str] = MappingProxyType({TOPIC: 'geometry_msgs/msg/TwistStamped'})
    start: int | None = 0

    def __init__(
        self, setup: ContactSetup, robot: BaseRobotModel, io: IoImage, on_problem: Callable[[str], None]
    ) -> None:
        self._setup, self._robot, self._io = setup, robot, io
        self._contact = setup.contact()
        self._guide = ForceGuide(setup, robot, on_problem)
        self._times = PeriodicSchedule(round(PERIOD * NANOSECONDS))
        self._handed_over = False
        self._measured: tuple[Array, Array] | None = None

    @property
    def next_time(self) -> float:
        """See `GuideSource`."""
        return 0.0 if self._handed_over else math.inf

    def hand_over(self, guide: Guide, now: int) -> None:  # noqa: ARG002  # as of a recording
        """See `GuideSource`."""
        if guide is Guide.PERSON:
            raise PlanningError('a simulation has no teach box; --references names a recording of one')
        self._handed_over = guide is Guide.SENSOR
        self._guide.hand_over(handed_over=self._handed_over)

    def measure(self, feedback: JointFeedback) -> Array:
        """Wrench (6,) that the sensor measures at the end of a period, N and N m, in tool0."""
        self._contact.slip = self._io.value(self._setup.slip)
        wrench = self._contact.of_robot(self._robot, feedback.position).wrench
        self._measured = wrench, feedback.position
        return wrench

    def due(self, now: int) -> Iterator[GuidingMessage]:
        """See `GuideSource`."""
        setup = self._setup
        for time in self._times.due(now):
            seconds = time / NANOSECONDS
            if self._measured is not None:
                self._guide.measured(*self._measured)
            outputs = {channel: self._io.value(channel) for channel in (setup.load, setup.speed, setup.slip)}
            twist = self._guide.step(seconds, outputs)
            if twist is not None:
                yield GuidingMessage(TOPIC, time, time, b'', twist)
