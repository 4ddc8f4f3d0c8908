"""ManagedStates: the states of a managed node, as the services of lifecycle_msgs change them."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.lifecycle import LifecycleNodeMixin, LifecycleState
from rclpy.lifecycle import TransitionCallbackReturn as Outcome

from robots_core.errors import RobotsError

if TYPE_CHECKING:
    from robots_core.ros.managed_node import ManagedNode


class ManagedStates(LifecycleNodeMixin):
    """Asks a node to begin and to end its work; a RobotsError of it refuses the transition.

    The rest has no work: parameters are read when the node starts, so that configure and cleanup change
    nothing but the state.

    Args:
        node: The node; it is given the services.
    """

    def __init__(self, node: ManagedNode) -> None:
        self.active = False
        """The node may work."""
        self._node = node
        self.handle, self.default_callback_group = node.handle, node.default_callback_group
        self._services: list[Any] = node._services  # noqa: SLF001  # as in rclpy's LifecycleNode
        super().__init__()
        self._change = self._service_change_state.callback
        self._service_change_state.callback = self._change_state

    def close(self) -> None:
        """Let the node be destroyed."""
        self._state_machine.destroy_when_not_in_use()

    def _change_state(self, request: Any, response: Any) -> Any:
        before = self._state_machine.current_state[1]
        try:
            return self._change(request, response)
        except rclpy_implementation.RCLError:  # rclpy lets it end the process
            asked = request.transition.label or request.transition.id
            self._node.journal.warning(f'transition {asked} is refused: the node is {before}')
            response.success = False
            return response

    def on_activate(self, state: LifecycleState) -> Outcome:
        """Let the node begin its work."""
        return self._begin_or_end('activate', self._node.activate, before=state, active=True)

    def on_deactivate(self, state: LifecycleState) -> Outcome:
        """Let the node end its work."""
        return self._begin_or_end('deactivate', self._node.deactivate, before=state, active=False)

    def on_shutdown(self, state: LifecycleState) -> Outcome:
        """Stop the robot; nothing follows."""
        return self._begin_or_end('shutdown', self._node.give_up, before=state, active=False)

    def _begin_or_end(
        self, name: str, work: Callable[[], None], *, before: LifecycleState, active: bool
    ) -> Outcome:
        try:
            work()
        except RobotsError as error:
            self._node.journal.warning(f'transition {name} of the {before.label} node is refused: {error}')
            return Outcome.FAILURE
        self.active = active
        return Outcome.SUCCESS
