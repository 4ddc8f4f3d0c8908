"""ManagedNode: a node that may leave it to a lifecycle manager when it works."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.lifecycle import LifecycleNodeMixin, LifecycleState
from rclpy.lifecycle import TransitionCallbackReturn as Outcome

from robots_core.errors import InvalidInputError, NotNowError, RobotsError
from robots_core.ros.robot_node import RobotNode

INACTIVE: Final = 'not active: it is managed, and waits for ~/change_state'


class ManagedNode(RobotNode):
    """A `RobotNode` that works from its start, or, with parameter `managed`, as long as it is active.

    Parameters:
        managed: Offer the services of lifecycle_msgs, and begin unconfigured.

    Raises:
        InvalidInputError: `managed` in lock-step.
    """

    def __init__(self, name: str, **options: Any) -> None:
        super().__init__(name, **options)
        self._lifecycle: ManagedStates | None = None
        managed = self.parameter(
            'managed', False, 'offers the services of lifecycle_msgs, and works only while it is active'
        )
        if not managed:
            return
        if self.participant is not None:
            raise InvalidInputError('managed is not for lock-step, which counts all messages of a node')
        self._lifecycle = ManagedStates(self)
        self.closing.callback(self._lifecycle.close)

    @property
    def active(self) -> bool:
        """The node does its work; always so if it is not managed."""
        return self._lifecycle is None or self._lifecycle.active

    def activate(self) -> None:
        """Begin to work.

        Raises:
            RobotsError: it cannot; the node stays inactive.
        """

    def deactivate(self) -> None:
        """End the work.

        Raises:
            NotNowError: the robot moves; the node stays active.
        """
        if self.moving:
            raise NotNowError('the robot moves; ~/stop of its controller stops it on its path')
        self.give_up()

    def give_up(self) -> None:
        """End the work whatever the robot does: stop it, inside its limits."""


class ManagedStates(LifecycleNodeMixin):
    """Asks a node to begin and to end its work; a RobotsError of it refuses the transition.

    The rest has no work: parameters are read when the node starts, so that configure and cleanup change
    nothing but the state.
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
