"""CommandAuthority: one commander at a time, and the operating mode."""

import math
from typing import Final

from robots_core.cell_interface.operating_modes import (
    MODES,
    Commander,
    OperatingMode,
    check_command,
    check_mode,
)
from robots_core.errors import CommandRefusedError

HOLD_TIMEOUT: Final = 0.2  # s


class CommandAuthority:
    """The commander of the robot, the operating mode, and whether a person holds the run button.

    One thread calls `take` and `give_back`; another one may call `enabled`.

    Args:
        mode: The operating mode.
        hold_timeout: Run counts as held for this long after the last sign of it, s; 0: not needed.
    """

    def __init__(
        self, mode: OperatingMode = OperatingMode.AUTOMATIC, *, hold_timeout: float = HOLD_TIMEOUT
    ) -> None:
        self.mode = mode
        """The operating mode."""
        self._hold_timeout = hold_timeout
        self._held_at = -math.inf
        self._suspended = False  # a program that ran in a mode in which run is held
        self.commander = Commander.NOBODY
        """The commander of the robot."""

    def set_mode(self, mode: OperatingMode) -> None:
        """Change the mode, while the robot stands; a commander that it excludes loses the robot.

        A program that leaves a mode in which run is held moves the robot again when it has taken it anew.
        """
        # Before the mode: the thread that reads `enabled` must not see the new one alone.
        if self.commander is Commander.PROGRAM and MODES[self.mode].held:
            self._suspended = True
        self.mode = mode
        self._held_at = -math.inf
        if self.commander not in MODES[mode].commanders:
            self.commander = Commander.NOBODY

    def take(self, commander: Commander, *, standing: bool) -> None:
        """Take a free robot; its commander may take it again.

        Raises:
            CommandRefusedError: another one commands it, it moves, or the mode excludes the commander.
        """
        check_command(commander, commander=self.commander, mode=self.mode)
        if self.commander is Commander.NOBODY and not standing:
            raise CommandRefusedError(
                f'{commander} cannot take the robot while it moves; it can when the robot stands'
            )
        self.commander, self._suspended = commander, False

    def give_back(self, commander: Commander) -> None:
        """Give the robot back.

        Raises:
            CommandRefusedError: another one commands it.
        """
        if self.commander not in (commander, Commander.NOBODY):
            raise CommandRefusedError(f'{self.commander} commands the robot, not {commander}')
        self.commander, self._suspended = Commander.NOBODY, False

    def take_over(self, commander: Commander) -> None:
        """Take the robot from any commander, see `ControlLoop.take_over`.

        Raises:
            CommandRefusedError: the mode excludes the commander.
        """
        check_mode(commander, self.mode)
        self.commander, self._suspended = commander, False

    def hold(self, now: float, *, held: bool) -> None:
        """A person holds run, or has released it; now in s, on the clock of `enabled`."""
        self._held_at = now if held else -math.inf

    def enabled(self, now: float) -> bool:
        """Motions of programs may continue at a time, s."""
        if not MODES[self.mode].held:
            return not self._suspended
        return self._hold_timeout <= 0.0 or now - self._held_at <= self._hold_timeout

    def stream_enabled(self, now: float) -> bool:
        """Streams may continue. Jogging is held by its key, guidance for a program by the run button."""
        return self.commander is not Commander.PROGRAM or self.enabled(now)

    def speed_limit(self, limit: float) -> float:
        """The lower one of a limit of the tool's speed and the mode's, m/s; 0 is none."""
        limits = [one for one in (limit, MODES[self.mode].tool_speed_limit) if one > 0.0]
        return min(limits, default=0.0)
