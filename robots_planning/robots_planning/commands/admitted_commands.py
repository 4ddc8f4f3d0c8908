"""AdmittedCommands: whose commands are under way, and when they are given up."""

from robots_core.cell_interface.operating_modes import Commander
from robots_planning.commands.motion_planner import MotionPlanner


class AdmittedCommands:
    """Gives up what was admitted and does not move the robot yet, as it is still being planned or held.

    That happens when the commander is lost, another one takes the robot, or the robot is stopped. A program
    gives up its motions by itself when the robot is stopped.

    Args:
        planner: Of these commands.
    """

    def __init__(self, planner: MotionPlanner) -> None:
        self._planner = planner
        self._last = Commander.NOBODY

    def admit(self, commander: Commander) -> None:
        """A command of this commander goes to the planner."""
        self._last = commander

    def taken(self, commander: Commander) -> None:
        """This commander has taken the robot."""
        if self._last is not commander:
            self._planner.give_up(f'{commander} has taken the robot')

    def lost(self, commander: Commander, reason: str) -> None:
        """This commander is gone."""
        if self._last is commander:
            self._planner.give_up(reason)

    def stopped(self, reason: str, until: float) -> None:
        """The robot is stopped: what was commanded before this time, s, is void."""
        if self._last is not Commander.PROGRAM:
            self._planner.give_up(reason, until)
