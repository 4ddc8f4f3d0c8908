"""Commands on their way to the planner: their order, and whose are planned."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.subscription import Subscription

from robots_core.cell_interface.operating_modes import Commander
from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.messages import NANOSECONDS, diagnostic_values, number_in
from robots_core.ros.peers.commander_watch import NODES, PENDANT_LOST_AFTER, CommanderWatch
from robots_core.ros.peers.heartbeat import FreshCommands, HeartbeatWatch
from robots_core.ros.peers.identified_messages import deliver
from robots_core.ros.peers.presence import Sender
from robots_core.ros.qos import subscribe
from robots_core.ros.robot_node import RobotNode
from robots_planning.commands.admitted_commands import AdmittedCommands
from robots_planning.commands.motion_planner import MotionPlanner

NO_STOP: Final = 'none'


class CommandAdmission:
    """Admits the commands of the robot's commander, and has `AdmittedCommands` give them up.

    They are also given up when the planner itself was held up.
    """

    def __init__(self, node: RobotNode, planner: MotionPlanner, watchdog: float) -> None:
        self._node, self._planner = node, planner
        self._admitted = AdmittedCommands(planner)
        self.commanders = CommanderWatch(node, self._admitted.taken)
        """Follows the commander of the robot."""
        self._fresh = FreshCommands(node, watchdog)
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
        self._admitted.admit(commander)

    def check_sent(self, sender: Sender) -> Commander:
        """Admit a command of a node; returns what this node is.

        Raises:
            CommandRefusedError: as `CommanderWatch.check`.
            NotNowError: as `FreshCommands.check`.
        """
        commander = self.commanders.of_node(sender.name)
        self.commanders.check(commander)
        self._fresh.check(sender)
        self._admitted.admit(commander)
        return commander

    def missed(self) -> bool:
        """See `FreshCommands.missed`."""
        return self._fresh.missed()

    def held_up(self, silence: float) -> None:
        """The others have missed the planner, and have given up what they had commanded; from any thread."""
        if self._fresh.held_up(silence):
            self._planner.held_up()  # before the next sign of life, after which nothing is missed any more
            self._was_held_up.trigger()

    def _on_watched(self, name: str, reason: str) -> None:
        if reason:
            self._admitted.lost(NODES[name], reason)

    def _on_stop(self, message: DiagnosticStatus) -> None:
        if message.message != NO_STOP:
            now = self._node.get_clock().now().nanoseconds / NANOSECONDS
            until = number_in(diagnostic_values(message), 'until', now)
            self._admitted.stopped(message.message, min(until, now))


class CommandInbox:
    """Holds what came until nothing more waits on any topic, and then delivers it by stamp.

    An executor takes one message of each topic in turn: of commands that wait on several topics, it would
    hand over a later one first. In lock-step everything has come when the planner has its turn.
    """

    def __init__(self, node: RobotNode) -> None:
        self._waiting: list[tuple[tuple[int, int], Callable[[], object]]] = []
        self._more = False
        self._subscriptions: list[Subscription] = []
        self._node = node
        self._turn = None
        if node.participant is not None:
            self._turn = node.participant.create_turn(lambda _: self.deliver(), phase=Phase.PLANNING)
        # In every round of the executor, subscriptions are served before it.
        self._arrival = node.create_guard_condition(self._check)

    def subscribed(self, subscription: Subscription) -> None:
        """A subscription puts its commands here."""
        self._subscriptions.append(subscription)

    def put(self, stamp: Time, act: Callable[[], object]) -> None:
        """Call `act` after all commands that were sent before `stamp` and are here already."""
        self._waiting.append(((stamp.sec, stamp.nanosec), act))
        if self._turn is not None:
            self._turn.ask(self._node.now())
            return
        self._more = True
        self._arrival.trigger()

    def _check(self) -> None:
        if self._more:
            self._more = False
            self._arrival.trigger()
            return
        self.deliver()

    def deliver_all(self) -> None:
        """Deliver what came, now, also what the executor has not served yet.

        It serves one message of each topic for each request of a service: a burst of commands would be
        overtaken by the settings that were sent after it.
        """
        # In lock-step all has been served.
        for subscription in () if self._turn is not None else self._subscriptions:
            while deliver(subscription):
                pass
        self.deliver()

    def deliver(self) -> None:
        """Deliver what came, now."""
        waiting, self._waiting = self._waiting, []
        for _, act in sorted(waiting, key=lambda item: item[0]):
            act()
