"""BlockedMotion: the motion that was stopped before an obstacle, and whether it may continue."""

from __future__ import annotations

from robots_controller.control.command_authority import CommandAuthority
from robots_controller.control.stops.faults import Fault
from robots_controller.control.stops.stop_latch import StopLatch
from robots_core.cell_interface.motion_result import BLOCKED
from robots_core.errors import TrajectoryRefusedError


class BlockedMotion:
    """Permits the path around an obstacle, and nothing else, to move a robot that stands before one.

    A robot that stands before an obstacle moves again by itself. A stop that comes while the path around it
    is being planned finds the robot standing: the trajectory that follows must not move it. Whatever comes
    before the path around, or in its place, therefore latches `Fault.OBSTACLE`.
    """

    def __init__(self, authority: CommandAuthority, stops: StopLatch) -> None:
        self._authority, self._stops = authority, stops
        self._id = self._reason = ''
        self._commanded = self._now

    @property
    def _now(self) -> tuple[str, str]:
        return self._authority.commander, self._authority.mode

    @property
    def waiting(self) -> bool:
        """A motion stands before an obstacle, and was not given up."""
        return bool(self._id) and not self._reason

    def put(self, id_: str) -> None:
        """A motion was stopped before an obstacle."""
        self._id, self._reason, self._commanded = id_, '', self._now

    def check(self, id_: str) -> None:
        """Check that a motion may begin: it is the path around, or no other one waits for its own.

        Raises:
            TrajectoryRefusedError: it would move the robot in the place of the path around, or is that of a
                motion that was given up.
        """
        reason = self._reason if id_ == self._id else ''
        if self.waiting:
            if id_ != self._id:
                reason = f'motion {id_} would take its place'
            elif self._commanded != self._now:
                reason = 'the commander of the robot or its mode has changed'
            if reason:
                self.stay(reason)
        if reason:
            raise TrajectoryRefusedError(f'the robot does not go around what is in its way: {reason}')

    def begin(self, id_: str) -> None:
        """A motion begins."""
        if id_ == self._id:
            self._id = ''

    def end(self, id_: str, reason: str) -> None:
        """A motion has ended without reaching its target; if it waits, it has no path around."""
        if self.waiting and id_ == self._id:
            self.stay(reason)

    def stay(self, reason: str) -> None:
        """The motion does not continue: the robot stays before the obstacle until it is reset."""
        self._reason = self._reason or reason
        text = reason if reason.startswith(BLOCKED) else f'{BLOCKED}, without a path around: {reason}'
        self._stops.trip(Fault.OBSTACLE, text)
