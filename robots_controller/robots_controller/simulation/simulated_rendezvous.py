"""SimulatedRendezvous: connects the bodies in orbit with the cell that moves them, as drive_node does."""

from collections.abc import Iterator, Mapping

from robots_controller.io.io_image import Channel
from robots_controller.simulation.in_process_cell import InProcessCell
from robots_core.blocks.floating_base.rendezvous import CLOSE, Rendezvous
from robots_core.blocks.following.guide import Guide


class SimulatedRendezvous:
    """Takes the gripper's output, sets the inputs, and measures poses for the guidance.

    Args:
        rendezvous: The bodies, stepped with the drives.
        cell: The cell.
    """

    def __init__(self, rendezvous: Rendezvous, cell: InProcessCell) -> None:
        self._rendezvous, self._cell = rendezvous, cell
        self._set = self.inputs
        self._report: str | None = None

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

    def before_step(self) -> None:
        """Say who guides the robot, before the drives move."""
        self._rendezvous.guided = self._cell.guide_player.guide is Guide.SENSOR

    def after_step(self) -> None:
        """Measure and record, after the drives have moved."""
        bodies, cell = self._rendezvous, self._cell
        reference = bodies.reference
        if reference is not None:
            cell.log.reference(*reference)
            cell.guide_player.measured(*reference, cell.clock.stamp)
        if bodies.report != self._report:
            self._report = bodies.report
            cell.log.grasp(bodies.report, refused=bodies.refused)
        if bodies.shown:
            cell.log.bodies(bodies)

    def changes(self) -> Iterator[tuple[Channel, float]]:
        """The inputs that have changed, with their values."""
        before, self._set = self._set, self.inputs
        for channel, value in self._set.items():
            if value != before[channel]:
                yield channel, value
