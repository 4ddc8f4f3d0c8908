"""PlannerClient: a program's motions as messages to planning_node."""

from collections import deque
from collections.abc import Callable, Mapping
from functools import partial
from typing import Final

from robots_controller.cell.ports import Configured
from robots_controller.nodes.ports.program.planner_settings import PlannerSettings
from robots_controller.program.motions.modal_settings import PLANNING_NODE, without_blend
from robots_controller.program.motions.motion_command import MotionCommand
from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.message_class import message_class
from robots_core.ros.messages import BUILD, id_stamp, stamp_id
from robots_core.ros.peers.presence import publishers_of, subscribers_of
from robots_core.ros.qos import make_publisher
from robots_core.ros.timed_node import TimedNode
from robots_planning.motion_kinds import JOINT, MOTION_KINDS, MotionKind


class PlannerClient(PlannerSettings):
    """See `PlannerPort`; safe from any thread.

    Args:
        node: The node to publish from.
        joint_names: The robot's joints.
        held_up: The others have missed this process, and it has not failed its program yet: nothing is
            commanded.
    """

    name: Final = PLANNING_NODE

    def __init__(
        self, node: TimedNode, joint_names: tuple[str, ...], held_up: Callable[[], bool] = lambda: False
    ) -> None:
        super().__init__(node)
        self._joint_names, self._held_up = joint_names, held_up
        self._last_stamp = 0
        self._waiting: deque[Callable[[], None]] = deque()
        self._turn = None
        if node.participant is not None:
            self._turn = node.participant.create_turn(self._apply_waiting, phase=Phase.PLANNING)
        self._planners: set[bytes] = set()  # identities of planners' publishers
        self._publishers = {
            kind: make_publisher(node, message_class(kind.message_type), kind.topic) for kind in MOTION_KINDS
        }

    def plans(self, command: MotionCommand) -> bool:
        """See `PlannerPort`."""
        return self.listens(command.kind) and not self._held_up()

    def listens(self, kind: MotionKind = JOINT) -> bool:
        """A node that publishes `joint_trajectory` is subscribed to a motion's topic.

        The number of subscriptions alone shows nothing: a recorder has them too.
        """
        publishers = publishers_of(self._node, 'joint_trajectory')
        if publishers.keys() - self._planners:  # one that was restarted has its own settings
            self.forget()
        self._planners = {*publishers}
        return not subscribers_of(self._node, kind.topic).isdisjoint(publishers.values())

    def configure(self, settings: Mapping[str, object], done: Configured, *, moving: bool) -> None:
        """See `PlannerPort`; in lock-step when the planner has all commands that were sent before."""
        apply = partial(self.apply, settings, done, moving=moving and self._turn is None)
        if self._turn is None:
            apply()
        else:
            self._waiting.append(apply)
            self._turn.ask(self._node.now())

    def flush(self, settings: Mapping[str, object]) -> None:
        """See `PlannerPort`."""
        self.configure(without_blend(settings), lambda _: None, moving=True)

    def _apply_waiting(self, _now: float) -> None:
        while self._waiting:
            self._waiting.popleft()()

    def next_id(self) -> str:
        """The stamp of the next command: unique even while a simulated clock stands still."""
        self._last_stamp = max(self._node.get_clock().now().nanoseconds, self._last_stamp + 1)
        return stamp_id(BUILD.time(self._last_stamp))

    def command(self, id_: str, command: MotionCommand) -> None:
        """See `PlannerPort`."""
        message = command.message(BUILD, id_stamp(id_), self._joint_names)
        self._publishers[command.kind].publish(message)

    def followers(self) -> Mapping[bytes, str]:
        """See `PlannerPort`; by endpoint: a node that was restarted has none of the motions."""
        publishers = publishers_of(self._node, 'motion_result')
        return {identity: name.rpartition('/')[2] for identity, name in publishers.items()}
