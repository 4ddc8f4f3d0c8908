"""ControllerCondition: what a person is told first about a controller."""

import math
from typing import Final

from robots_controller.control.controller import Controller, ControllerState
from robots_core.errors import RobotsError
from robots_core.status import Level

REFUSAL_SHOWN: Final = 1.0  # s


class ControllerCondition:
    """The condition of a controller; of several problems the one that keeps the robot from moving longest."""

    def __init__(self, controller: Controller) -> None:
        self._controller = controller
        self._refusal: RobotsError | None = None
        self._refused_at = -math.inf

    def stream_refused(self, error: RobotsError, now: float) -> None:
        """A point of a stream was refused, at a time in s."""
        self._refusal, self._refused_at = error, now

    def at(self, now: float, inactive: str = '') -> tuple[Level, str]:
        """The condition at a time, s; `inactive` says why the controller may not move the robot."""
        controller = self._controller
        if inactive:
            return Level.WARN, inactive
        if controller.state is ControllerState.WAITING:
            return Level.WARN, 'waiting for joint_states'
        if controller.stops.latched:
            return Level.ERROR, f'stopped until ~/reset: {controller.stops.state.reason}'
        if now - self._refused_at < REFUSAL_SHOWN:
            return Level.WARN, f'joint_trajectory: {self._refusal}'
        obstacle = controller.obstacle
        if hindrance := controller.awaited or (obstacle and f'held before {obstacle}'):
            return Level.WARN, hindrance
        return Level.OK, 'ready'
