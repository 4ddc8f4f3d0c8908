"""What the loss of a node of the cell is to a program."""

from typing import Final

from robots_controller.cell.program_host import ProgramHost

PLANNER: Final = 'planning_node'
CONTROLLER: Final = 'controller_node'
WATCHED_NODES: Final = (PLANNER, CONTROLLER)
"""The nodes without which no program moves the robot."""


def watched_node_changed(host: ProgramHost, name: str, reason: str) -> None:
    """Let a program fail with a lost node; without a controller outputs get fail-safe even if none runs.

    Args:
        host: Of the program.
        name: The node.
        reason: Why it is lost; '' when it is back.
    """
    if name == PLANNER:
        host.motions.lose_planner(reason)
    if reason and not host.lose_robot(reason) and name == CONTROLLER:
        host.make_outputs_safe()
