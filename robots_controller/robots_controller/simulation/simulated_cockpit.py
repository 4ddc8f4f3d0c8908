"""SimulatedCockpit: what moves a cabin is played from a recording, and cued as the node does."""

from collections.abc import Iterator, Mapping
from types import MappingProxyType

from robots_controller.cell.guide_recording import GuideRecording, GuideReplay, GuidingMessage
from robots_controller.simulation.simulated_guide import SENSOR_PERIOD, SensorSource, missing
from robots_core.blocks.following.following_methods import RATE
from robots_core.blocks.following.guide import Guide
from robots_core.blocks.motion_cueing.cabin import Cabin
from robots_core.blocks.motion_cueing.cockpit import Cockpit
from robots_core.blocks.motion_cueing.driven_vehicle import DriverInputs
from robots_core.blocks.motion_cueing.vehicle_inputs import INPUTS
from robots_core.blocks.motion_cueing.vehicle_motion import VehicleMotion
from robots_core.periodic.periodic_schedule import PeriodicSchedule
from robots_core.pose import Pose

POSE, TWIST = 'reference_pose', 'reference_twist'


class SimulatedCockpit(SensorSource):
    """A `GuideSource` of the poses that cue a recorded motion, 250 times a second.

    Args:
        cabin: The cabin.
        recording: The inputs of its driver, or the motion of a vehicle; None for none.
    """

    def __init__(self, cabin: Cabin, recording: GuideRecording | None) -> None:
        super().__init__()
        self.types: Mapping[str, str] = MappingProxyType(
            {POSE: 'geometry_msgs/msg/PoseStamped', TWIST: 'geometry_msgs/msg/TwistStamped', **INPUTS}
        )
        self._cabin, self._cockpit = cabin, Cockpit(cabin, 1.0 / RATE)
        self._replay = None if recording is None else GuideReplay(recording)
        self._times = PeriodicSchedule(SENSOR_PERIOD)

    def hand_over(self, guide: Guide, now: int) -> None:
        """See `GuideSource`."""
        if guide is Guide.SENSOR and self._replay is None:
            raise missing('driver')
        super().hand_over(guide, now)
        if self._replay is not None:
            self._replay.hand_over(guide, now)
        self._cockpit.hand_over(handed_over=self.handed_over)

    def due(self, now: int) -> Iterator[GuidingMessage]:
        """See `GuideSource`."""
        for time in self._times.due(now):
            newest: dict[str, DriverInputs | VehicleMotion] = {}
            for message in () if self._replay is None else self._replay.due(time):
                assert isinstance(message.value, (DriverInputs, VehicleMotion))
                newest[message.topic] = message.value
                yield message
            if not self.handed_over:
                continue
            for value in newest.values():
                self._cockpit.take(value)
            step = self._cockpit.step()
            pose = self._cabin.flange_of(step)
            # As its message has it: the way through a quaternion rounds.
            pose = Pose.from_quaternion(pose.r, pose.quaternion())
            yield GuidingMessage(POSE, time, time, b'', pose)
            yield GuidingMessage(TWIST, time, time, b'', self._cabin.twist_of(step))
