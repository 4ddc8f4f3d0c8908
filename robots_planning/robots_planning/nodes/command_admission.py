"""CommandAdmission: whose commands are planned, and until when they may move the robot."""

from __future__ import annotations

from typing import Final

from diagnostic_msgs.msg import DiagnosticStatus

from robots_core.cell_interface.operating_modes import Commander
from robots_core.ros.messages import NANOSECONDS, diagnostic_values, number_in
from robots_core.ros.peers.commander_watch import NODES, PENDANT_LOST_AFTER, CommanderWatch
from robots_core.ros.peers.fresh_commands import FreshCommands
from robots_core.ros.peers.heartbeat import HeartbeatWatch
from robots_core.ros.peers.presence import Sender
from robots_core.ros.qos import subscribe
from robots_core.ros.robot_node import RobotNode
from robots_planning.commands.motion_planner import MotionPlanner

NO_STOP: Final = 'none'


class CommandAdmission:
    """Admits the commands of the robot's commander.

    What was admitted and does not move the robot yet, as it is still being planned or held, is given up when
    its commander is lost, another one takes the robot, the robot is stopped, or the planner itself was held
    up. A program gives up its motions by itself when the robot is stopped.
    """

    def __init__(self, node: RobotNode, planner: MotionPlanner, watchdog: float) -> None:
        self._node, self._planner = node, planner
        self.commanders = CommanderWatch(node, self._on_taken)
        """Follows the commander of the robot."""
        self._fresh = FreshCommands(node, watchdog)
        self._last = Commander.NOBODY  # whose command was admitted last
        self._was_held_up = node.create_guard_condition(planner.release)
        self.watch = HeartbeatWatch(node, ('lua_program_node',), watchdog, self._on_watched)
        """Watches the program's node."""
        HeartbeatWatch(node, ('pendant_node',), PENDANT_LOST_AFTER if watchdog else 0.0, self._on_watched)
        subscribe(node, DiagnosticStatus, 'stop_status', self._on_stop)

    def check(self, commander: Commander) -> None:
        """Admit commands that are there already.

        Raises:
            CommandRefusedError: as `CommanderWatch.check`.
        """
        self.commanders.check(commander)
        self._last = commander

    def check_sent(self, sender: Sender) -> Commander:
        """Admit a command of a node; returns what this node is.

        Raises:
            CommandRefusedError: as `CommanderWatch.check`.
            NotNowError: as `FreshCommands.check`.
        """
        commander = self.commanders.of_node(sender.name)
        self.commanders.check(commander)
        self._fresh.check(sender)
        self._last = commander
        return commander

    def missed(self) -> bool:
        """See `FreshCommands.missed`."""
        return self._fresh.missed()

    def held_up(self, silence: float) -> None:
        """The others have missed the planner, and have given up what they had commanded; from any thread."""
        if self._fresh.held_up(silence):
            self._planner.held_up()  # before the next sign of life, after which nothing is missed any more
            self._was_held_up.trigger()

    def _on_taken(self) -> None:
        if self._last is not self.commanders.commander:
            self._planner.give_up(f'{self.commanders.commander} has taken the robot')

    def _on_watched(self, name: str, reason: str) -> None:
        if reason and self._last is NODES[name]:
            self._planner.give_up(reason)

    def _on_stop(self, message: DiagnosticStatus) -> None:
        if message.message != NO_STOP and self._last is not Commander.PROGRAM:
            now = self._node.get_clock().now().nanoseconds / NANOSECONDS
            until = number_in(diagnostic_values(message), 'until', now)
            self._planner.give_up(message.message, min(until, now))
