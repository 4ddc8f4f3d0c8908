"""SimulatedRendezvous: the bodies in orbit, their camera and gripper, in a simulated cell."""

from collections import deque
from collections.abc import Iterator, Mapping
from types import MappingProxyType

from robots_controller.cell.guide_recording import GuidingMessage
from robots_controller.io.io_image import Channel
from robots_controller.simulation.in_process_cell import InProcessCell
from robots_controller.simulation.record.ros_messages import BUILD
from robots_controller.simulation.simulated_guide import SensorSource
from robots_core.blocks.floating_base.rendezvous import CLOSE, Rendezvous
from robots_core.blocks.floating_base.rendezvous_messages import POSE, TWIST, RendezvousMessages
from robots_core.blocks.following.guide import Guide


class SimulatedRendezvous(SensorSource):
    """A `GuideSource`, whose camera measures the target; takes the gripper's output and sets the inputs."""

    types: Mapping[str, str] = MappingProxyType({})  # its messages are all recorded in `after_step`

    def __init__(self, rendezvous: Rendezvous, robot: str) -> None:
        super().__init__()
        self._rendezvous = rendezvous
        self._messages = RendezvousMessages(rendezvous, BUILD, robot)
        self._measured: deque[GuidingMessage] = deque()
        self._set = self.inputs

    def hand_over(self, guide: Guide, now: int) -> None:
        """See `GuideSource`."""
        super().hand_over(guide, now)
        self._rendezvous.guided = self.handed_over

    def due(self, now: int) -> Iterator[GuidingMessage]:
        """See `GuideSource`."""
        while self._measured and self._measured[0].time <= now:
            yield self._measured.popleft()

    @property
    def inputs(self) -> Mapping[Channel, float]:
        """Values of the inputs that it sets."""
        values = {'digital': self._rendezvous.digital_inputs, 'analog': self._rendezvous.measured}
        return {
            Channel(kind, 'input', index): float(value)  # type: ignore[arg-type]
            for kind, row in values.items()
            for index, value in enumerate(row, 1)
        }

    def output(self, name: str, value: float) -> None:
        """Take the value of an output such as 'digital_output.1'."""
        if name == f'digital_output.{CLOSE}':
            self._rendezvous.close(closing=bool(value))

    def after_step(self, cell: InProcessCell) -> None:
        """Measure and record, after the drives have moved."""
        bodies, now = self._rendezvous, cell.clock.stamp
        reference = bodies.reference
        if reference is not None:
            pose, twist = reference
            self._measured += [
                GuidingMessage(POSE, now, now, b'', pose),
                GuidingMessage(TWIST, now, now, b'', twist),
            ]
        cell.log.record(self._messages.after_step(now, reference))

    def changes(self) -> Iterator[tuple[Channel, float]]:
        """The inputs that have changed, with their values."""
        before, self._set = self._set, self.inputs
        for channel, value in self._set.items():
            if value != before[channel]:
                yield channel, value
