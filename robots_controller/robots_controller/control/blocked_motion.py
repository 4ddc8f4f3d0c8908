"""BlockedMotion: the motion that was stopped before an obstacle, and whether it may go on."""

from __future__ import annotations

from robots_controller.control.command_authority import CommandAuthority
from robots_core.errors import TrajectoryRefusedError


class BlockedMotion:
    """Permits the way around an obstacle as long as nobody else has stopped or taken the robot meanwhile.

    A robot that stands before an obstacle moves again by itself. Whoever stops it while its way around is
    being planned has stopped a robot that stands already: the trajectory that comes then must not move it.

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
        """The motion goes on no more; the first reason counts."""
        if self._id and not self._reason:
            self._reason = reason

    def begin(self, id_: str) -> None:
        """A motion is to be followed.

        Raises:
            TrajectoryRefusedError: it is the one that was stopped before an obstacle, and was given up since.
        """
        if id_ != self._id:
            self.give_up(f'motion {id_} has taken its place')
            return
        if self._commanded != self._now:
            self.give_up('another one commands the robot, or its mode has changed')
        if self._reason:
            raise TrajectoryRefusedError(f'it does not go around what is in its way: {self._reason}')
        self._id = ''
