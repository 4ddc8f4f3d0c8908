"""CommandInbox: commands of several topics, in the order in which they were sent."""

from collections.abc import Callable

from builtin_interfaces.msg import Time
from rclpy.subscription import Subscription

from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.peers.identified_messages import deliver
from robots_core.ros.robot_node import RobotNode


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
