"""PlannerClient: a program's motions and modal settings as messages and parameters to planning_node."""

from collections import deque
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, Final

from rcl_interfaces.msg import ParameterType
from rcl_interfaces.srv import GetParameters, SetParametersAtomically
from rclpy.parameter import Parameter

from robots_controller.cell.ports import Configured
from robots_controller.program.motions.modal_settings import PLANNING_NODE, without_blend
from robots_controller.program.motions.motion_command import MotionCommand
from robots_core.errors import PlanningError
from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.messages import BUILD, id_stamp, message_class, stamp_id
from robots_core.ros.peers.presence import is_served, publishers_of, subscribers_of
from robots_core.ros.qos import make_publisher
from robots_core.ros.timed_node import TimedNode
from robots_planning.motion_kinds import JOINT, MOTION_KINDS, MotionKind


class PlannerClient:
    """See `PlannerPort`; safe from any thread.

    Of the settings those that differ are set, all at once; what a program does not set is as it was before
    any program.

    Args:
        held_up: The others have missed this process, and it has not failed its program yet: nothing is
            commanded.
    """

    name: Final = PLANNING_NODE

    def __init__(
        self, node: TimedNode, joint_names: tuple[str, ...], held_up: Callable[[], bool] = lambda: False
    ) -> None:
        self._node, self._joint_names, self._held_up = node, joint_names, held_up
        self._get = node.create_client(GetParameters, 'planning_node/get_parameters')
        self._set = node.create_client(SetParametersAtomically, 'planning_node/set_parameters_atomically')
        self._sent: dict[str, object] = {}
        self._original: dict[str, Any] = {}  # ParameterValue by name
        self._last_stamp = 0
        self._waiting: deque[Callable[[], None]] = deque()
        self._turn = None
        if node.participant is not None:
            self._turn = node.participant.create_turn(self._apply_waiting, phase=Phase.PLANNING)
        self._planners: set[bytes] = set()  # identities of planners' publishers
        self._publishers = {
            kind: make_publisher(node, message_class(kind.message_type), kind.topic) for kind in MOTION_KINDS
        }

    # -- motions -------------------------------------------------------------------------------------

    def plans(self, command: MotionCommand) -> bool:
        """See `PlannerPort`."""
        return self.listens(command.kind) and not self._held_up()

    def listens(self, kind: MotionKind = JOINT) -> bool:
        """A node that publishes `joint_trajectory` is subscribed to a motion's topic.

        The number of subscriptions alone shows nothing: a recorder has them too.
        """
        publishers = publishers_of(self._node, 'joint_trajectory')
        if publishers.keys() - self._planners:  # one that was restarted has its own settings
            self._sent.clear()
            self._original.clear()
        self._planners = {*publishers}
        return not subscribers_of(self._node, kind.topic).isdisjoint(publishers.values())

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

    # -- settings ------------------------------------------------------------------------------------

    def differs(self, settings: Mapping[str, object]) -> bool:
        """See `PlannerPort`."""
        return dict(settings) != self._sent

    @property
    def configurable(self) -> bool:
        """See `PlannerPort`: planning_node answers."""
        return is_served(self._node, self._get) and is_served(self._node, self._set)

    def configure(self, settings: Mapping[str, object], done: Configured, *, moving: bool) -> None:
        """See `PlannerPort`; in lock-step when the planner has all commands that were sent before."""
        if self._turn is None:
            self._apply(dict(settings), done, moving=moving)
        else:
            self._waiting.append(partial(self._apply, dict(settings), done, moving=False))
            self._turn.ask(self._node.now())

    def flush(self, settings: Mapping[str, object]) -> None:
        """See `PlannerPort`."""
        self.configure(without_blend(settings), lambda _: None, moving=True)

    def _apply_waiting(self, _now: float) -> None:
        while self._waiting:
            self._waiting.popleft()()

    def _apply(self, wanted: dict[str, object], done: Configured, *, moving: bool) -> None:
        unknown = [name for name in wanted if name not in self._original]
        if unknown or moving:
            # A service may overtake a topic: after its answer to a question the planner has what came before.
            future = self._get.call_async(GetParameters.Request(names=unknown or list(wanted)))
            future.add_done_callback(partial(self._on_original, unknown, wanted, done))
        else:
            self._change(wanted, done)

    def _on_original(
        self, names: list[str], wanted: dict[str, object], done: Configured, future: Any
    ) -> None:
        answer = future.result() if future.exception() is None else None
        if answer is None:
            done(PlanningError('planning_node does not report its settings'))
            return
        values = answer.values if names else []
        missing = [
            name
            for name, value in zip(names, values, strict=False)
            if value.type == ParameterType.PARAMETER_NOT_SET
        ]
        if len(values) != len(names) or missing:  # no values at all where a single one is missing
            which = ' or '.join(missing or names)
            done(PlanningError(f'planning_node has no {which}; this planner cannot do what the program sets'))
            return
        self._original |= zip(names, values, strict=True)
        self._change(wanted, done)

    def _change(self, wanted: dict[str, object], done: Configured) -> None:
        messages = [
            Parameter(name, value=list(value) if isinstance(value, tuple) else value).to_parameter_msg()
            for name, value in wanted.items()
            if self._sent.get(name) != value
        ]
        for name in self._sent.keys() - wanted.keys():
            message = Parameter(name, value=0.0).to_parameter_msg()
            message.value = self._original[name]
            messages.append(message)
        future = self._set.call_async(SetParametersAtomically.Request(parameters=messages))
        future.add_done_callback(partial(self._on_changed, wanted, done))

    def _on_changed(self, wanted: dict[str, object], done: Configured, future: Any) -> None:
        result = future.result().result if future.exception() is None else None
        if result is not None and result.successful:
            self._sent = wanted
            done(None)
        else:
            reason = result.reason if result else 'no answer'
            done(PlanningError(f'planning_node refuses the settings: {reason}'))
