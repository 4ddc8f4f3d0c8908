"""RunPermission: whether a program may run now."""

from collections.abc import Callable

from robots_core.cell_interface.operating_modes import MODES, Commander, OperatingMode, check_command
from robots_core.errors import CommandRefusedError, ProgramError


class RunPermission:
    """What the controller has reported last.

    Args:
        on_lost: Gets the reason when a program may have the robot no longer.
    """

    def __init__(self, on_lost: Callable[[str], object]) -> None:
        self._on_lost = on_lost
        self._commander = Commander.NOBODY
        self._mode: OperatingMode | None = None
        self.stop_reason = ''
        """The fault that stops the robot until it is reset; '' for none."""
        self.remedy = 'controller_node/reset lets the robot move again'
        """What ends the fault, for a person."""
        self.enabled = True
        """Motions of programs may continue."""

    def commander_changed(self, commander: Commander) -> None:
        """The commander of the robot."""
        self._commander = commander
        self._update()

    def mode_changed(self, mode: OperatingMode) -> bool:
        """The operating mode; True if it is another one than before."""
        before, self._mode = self._mode, mode
        self._update()
        return mode is not before

    @property
    def run_missing(self) -> bool:
        """A person has to hold run, and does not."""
        return not self.enabled and (self._mode is None or MODES[self._mode].held)

    @property
    def suspended(self) -> bool:
        """A program waits until it is resumed, and has to take the robot anew: the mode has changed."""
        return not self.enabled and not self.run_missing

    def check(self) -> None:
        """Check that a program may run.

        Raises:
            CommandRefusedError: another one commands the robot, or the mode excludes programs.
            ProgramError: a fault stops the robot, or run is not held.
        """
        if self.stop_reason:
            raise ProgramError(f'{self.stop_reason}; {self.remedy}')
        self._check_commander()
        if self.run_missing:
            raise ProgramError(
                f'in operating mode {self._mode} programs run only while run is held: '
                'true on topic hold_to_run, again and again'
            )

    def _check_commander(self) -> None:
        check_command(Commander.PROGRAM, commander=self._commander, mode=self._mode)

    def _update(self) -> None:
        try:
            self._check_commander()
        except CommandRefusedError as error:
            self._on_lost(error.message)
