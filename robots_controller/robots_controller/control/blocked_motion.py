"""BlockedMotion: the motion that was stopped before an obstacle, and whether it may continue."""

from __future__ import annotations

from robots_controller.control.command_authority import CommandAuthority
from robots_core.errors import TrajectoryRefusedError


class BlockedMotion:
    """Permits the way around an obstacle unless the robot was stopped or taken meanwhile.

    A robot that stands before an obstacle moves again by itself. A stop that comes while the way around it is
    being planned finds the robot standing: the trajectory that follows must not move it.

    Args:
        authority: Who commands the robot, in which mode.
    """

    def __init__(self, authority: CommandAuthority) -> None:
        self._authority = authority
        self._id = self._reason = ''
        self._commanded = self._now

    @property
    def _now(self) -> tuple[str, str]:
        return self._authority.commander, self._authority.mode

    def put(self, id_: str) -> None:
        """A motion was stopped before an obstacle."""
        self._id, self._reason, self._commanded = id_, '', self._now

    def give_up(self, reason: str) -> None:
        """The motion does not continue; the first reason counts."""
        if self._id and not self._reason:
            self._reason = reason

    def begin(self, id_: str) -> None:
        """A motion is to be followed.

        Raises:
            TrajectoryRefusedError: it was stopped before an obstacle, and was given up since.
        """
        if id_ != self._id:
            self.give_up(f'motion {id_} has taken its place')
            return
        if self._commanded != self._now:
            self.give_up('the commander of the robot or its mode has changed')
        if self._reason:
            raise TrajectoryRefusedError(f'it does not go around what is in its way: {self._reason}')
        self._id = ''
