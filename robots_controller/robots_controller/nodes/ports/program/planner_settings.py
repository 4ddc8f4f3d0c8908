"""PlannerSettings: the modal settings of a program as parameters of planning_node."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from rcl_interfaces.msg import ParameterType
from rcl_interfaces.srv import GetParameters, SetParametersAtomically
from rclpy.parameter import Parameter

from robots_core.errors import PlanningError
from robots_core.ros.peers.presence import is_served
from robots_core.ros.timed_node import TimedNode

Done = Callable[[PlanningError | None], None]


class PlannerSettings:
    """Sets what differs, all at once; what a program does not set is as it was before any program.

    Args:
        node: Owner of the clients.
    """

    def __init__(self, node: TimedNode) -> None:
        self._node = node
        self._get = node.create_client(GetParameters, 'planning_node/get_parameters')
        self._set = node.create_client(SetParametersAtomically, 'planning_node/set_parameters_atomically')
        self._sent: dict[str, object] = {}
        self._original: dict[str, Any] = {}  # ParameterValue by name

    def forget(self) -> None:
        """planning_node was restarted: it has its own settings."""
        self._sent.clear()
        self._original.clear()

    def differs(self, settings: Mapping[str, object]) -> bool:
        """See `PlannerPort`."""
        return dict(settings) != self._sent

    @property
    def configurable(self) -> bool:
        """See `PlannerPort`: planning_node answers."""
        return is_served(self._node, self._get) and is_served(self._node, self._set)

    def apply(self, wanted: Mapping[str, object], done: Done, *, moving: bool = False) -> None:
        """Set these settings and take back all others; returns at once.

        Args:
            wanted: Values by the parameter's name, SI.
            done: Called when planning_node has answered, from the executor's thread: None, or why it refuses.
            moving: A motion was just sent, which shall have the settings before these.
        """
        unknown = [name for name in wanted if name not in self._original]
        if unknown or moving:
            # A service may overtake a topic: after its answer to a question the planner has what came before.
            future = self._get.call_async(GetParameters.Request(names=unknown or list(wanted)))
            future.add_done_callback(partial(self._on_original, unknown, dict(wanted), done))
        else:
            self._change(dict(wanted), done)

    def _on_original(self, names: list[str], wanted: dict[str, object], done: Done, future: Any) -> None:
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

    def _change(self, wanted: dict[str, object], done: Done) -> None:
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

    def _on_changed(self, wanted: dict[str, object], done: Done, future: Any) -> None:
        result = future.result().result if future.exception() is None else None
        if result is not None and result.successful:
            self._sent = wanted
            done(None)
        else:
            reason = result.reason if result else 'no answer'
            done(PlanningError(f'planning_node refuses the settings: {reason}'))
