"""ManagedNode: a node that may leave it to a lifecycle manager when it works."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from robots_core.errors import InvalidInputError, NotNowError
from robots_core.ros.robot_node import RobotNode

if TYPE_CHECKING:
    from robots_core.ros.managed_states import ManagedStates

INACTIVE: Final = 'not active: it is managed, and waits for ~/change_state'


class ManagedNode(RobotNode):
    """A `RobotNode` that works from its start, or, with parameter `managed`, as long as it is active.

    Args:
        name: Default node name.
        options: Passed on to `RobotNode`.

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
        # Imported on demand: other nodes need none of its messages.
        self._lifecycle = import_module('robots_core.ros.managed_states').ManagedStates(self)
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
