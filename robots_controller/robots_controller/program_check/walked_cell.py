"""WalkedCell: a simulated cell in which nothing guides the robot."""

from robots_controller.simulation.simulated_cell import SimulatedCell
from robots_core.blocks.following.guide import Guide


class WalkedCell(SimulatedCell):
    """A simulated cell whose robot stands while a program lets others guide it; arguments as there.

    Where a sensor or a person would lead the robot is unknown.
    """

    def guide(self, guide: Guide) -> None:
        """See `RobotPort`."""
