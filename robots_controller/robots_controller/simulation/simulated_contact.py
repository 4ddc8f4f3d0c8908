"""SimulatedContact: the simulated robot's wheel on its soil, its force sensor, and force control."""

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Final

import numpy as np

from robots_controller.cell.contact_setup import ContactSetup
from robots_controller.cell.force_guide import PERIOD, ForceGuide
from robots_controller.cell.guide_recording import NANOSECONDS, GuidingMessage
from robots_controller.control.control_loop import ControlLoop
from robots_controller.control.stops.faults import Fault
from robots_controller.io.io_image import IoImage
from robots_controller.program.joint_feedback import JointFeedback
from robots_controller.simulation.record.cell_log import CellLog
from robots_controller.simulation.simulated_guide import SensorSource
from robots_core.blocks.following.guide import Guide
from robots_core.blocks.multibody.tool_wrench import joint_torques
from robots_core.periodic.periodic_schedule import PeriodicSchedule
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.status import Status
from robots_core.validation import Array

TOPIC: Final = 'reference_twist'


class SimulatedContact(SensorSource):
    """A `GuideSource` that presses by force, 250 times a second, on what the sensor measured last."""

    types: Mapping[str, str] = MappingProxyType({TOPIC: 'geometry_msgs/msg/TwistStamped'})

    def __init__(
        self, setup: ContactSetup, robot: BaseRobotModel, io: IoImage, control: ControlLoop, log: CellLog
    ) -> None:
        super().__init__()
        self._setup, self._robot, self._io = setup, robot, io
        self._contact = setup.contact()
        self._control, self._log = control, log
        self._guide = ForceGuide(setup, robot, self._report)
        self._times = PeriodicSchedule(round(PERIOD * NANOSECONDS))
        self._measured: tuple[Array, Array] | None = None
        self.joint_torques = np.zeros(robot.num_axes)
        """Of what presses on the tool, (n,), N m (N)."""
        self._report('')

    def hand_over(self, guide: Guide, now: int) -> None:
        """See `GuideSource`."""
        super().hand_over(guide, now)
        self._guide.hand_over(handed_over=self.handed_over)

    def measure(self, feedback: JointFeedback) -> None:
        """Measure the wrench at the end of a period."""
        self._contact.slip = self._io.value(self._setup.slip)
        wrench = self._contact.of_robot(self._robot, feedback.position).wrench
        self._measured = wrench, feedback.position
        self.joint_torques = joint_torques(self._robot, feedback.position, wrench)
        self._log.wrench(wrench)

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

    def _report(self, problem: str) -> None:
        if problem:
            self._control.trip(Fault.CONTACT, problem)
        self._log.report('contact_status', Status.of_problem('contact', problem))
