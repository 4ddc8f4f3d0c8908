"""TaskControl: the robot program as the task control of OPC 40010-1 has it, its states and methods."""

from __future__ import annotations

from collections.abc import Callable
from enum import IntEnum
from pathlib import Path
from typing import Final

from robots_controller.pendant.pendant_port import ProgramPort
from robots_controller.pendant.pendant_state import PendantState
from robots_controller.pendant.programs import program_files
from robots_controller.program.run_state import RunState
from robots_core.errors import InvalidInputError, NoAnswerError, NotNowError, RobotsError


class Status(IntEnum):
    """What a method answers."""

    OK = 0
    SYSTEM_STATE = 1
    """The cell is not in a state in which it can do that, or refuses it."""
    UNEXPECTED_ERROR = 2
    ACTIVE_ALARM = 3
    """A fault holds the robot."""


class StopMode(IntEnum):
    """How Stop ends the execution."""

    DEFAULT = 0
    """As END."""
    HOLD = 1
    """The robot stops on its path; Start continues."""
    END = 2
    """The robot stops on its path, and the program ends; Start begins anew."""


STOP_SERVICES: Final = {StopMode.HOLD: 'pause', StopMode.END: 'stop', StopMode.DEFAULT: 'stop'}


def operation_state(state: RunState) -> str:
    """State of the TaskControlStateMachine."""
    if state is RunState.IDLE:
        return 'Idle'
    return 'Executing' if state is RunState.RUNNING else 'Ready'


def ready_state(state: RunState) -> str:
    """State of the ReadySubstateMachine; '' where it is not active."""
    if operation_state(state) != 'Ready':
        return ''
    return 'Suspended' if state is RunState.PAUSED else 'AtProgramStart'


class TaskControl:
    """The methods; each waits for the cell's answer.

    `state` gives what is known of the cell now; `log` gets what the cell has refused, and why.
    """

    def __init__(
        self,
        port: ProgramPort,
        programs: Path,
        state: Callable[[], PendantState],
        log: Callable[[str], object],
    ) -> None:
        self._port, self._programs, self._state, self._log = port, programs, state, log
        self._loaded: tuple[str, PendantState | None] = '', None
        """The program that was loaded here last, and what was known of the cell before."""

    def start(self) -> Status:
        """Run the program, or continue it where it was held."""
        if self._state().fault:
            self._log(f'Start is refused: {self._state().fault}')
            return Status.ACTIVE_ALARM
        # What is known of the program may be older than what the cell does.
        held = self._state().program.state is RunState.PAUSED
        first, second = ('resume', 'run') if held else ('run', 'resume')
        return self._done('Start', lambda: self._either(first, second))

    def _either(self, first: str, second: str) -> None:
        try:
            self._port.call(f'lua_program_node/{first}')
        except NotNowError as error:
            try:
                self._port.call(f'lua_program_node/{second}')
            except NotNowError:
                raise error from None

    def stop(self, mode: int) -> Status:
        """Hold or end the program.

        Raises:
            InvalidInputError: no such mode.
        """
        if mode not in [*StopMode]:
            raise InvalidInputError(
                f'StopMode = {mode} must be one of {", ".join(map(str, map(int, StopMode)))}'
            )
        return self._call('Stop', STOP_SERVICES[StopMode(mode)])

    def name(self, path: str) -> str:
        """How LoadByName names a program; its file's name where it is not of the folder."""
        file = Path(path).resolve() if path else Path()
        return str(file.relative_to(self._programs)) if file.is_relative_to(self._programs) else file.name

    def load(self, name: str) -> Status:
        """Open a program of the folder.

        Raises:
            InvalidInputError: it has none of that name.
        """
        self._check(name)
        status = self._done('Load', lambda: self._port.open_program(str(self._programs / name)))
        if status is Status.OK:
            self._loaded = name, self._state()
        return status

    def unload(self, name: str | None = None) -> Status:
        """Close the program, so that none is loaded; with a name only if that one is.

        Raises:
            InvalidInputError: a name that is neither loaded nor in the folder.
        """
        loaded = self._loaded_name()
        if name is not None and (not loaded or name != loaded):
            self._check(name)
            self._log(
                f'Unload is refused: {name!r} is not loaded; {f"{loaded!r} is" if loaded else "none is"}'
            )
            return Status.SYSTEM_STATE
        return self._call('Unload', 'close')

    def _loaded_name(self) -> str:
        """The program that is loaded, '' for none: one that a client has just loaded may not be shown yet."""
        state = self._state()
        name, shown = self._loaded
        if shown is state:
            return name
        return '' if state.program.state is RunState.IDLE else self.name(state.program.path)

    def _check(self, name: str) -> None:
        if name not in (found := program_files(self._programs)):
            some = ', '.join(found[:10]) or 'none'
            raise InvalidInputError(f'there is no program {name!r} in {self._programs}; there are {some}')

    def reset(self) -> Status:
        """Set the program to its start."""
        return self._call('ResetToProgramStart', 'reset')

    def _call(self, method: str, service: str) -> Status:
        return self._done(method, lambda: self._port.call(f'lua_program_node/{service}'))

    def _done(self, method: str, work: Callable[[], object]) -> Status:
        try:
            work()
        except NoAnswerError as error:
            self._log(f'{method}: {error}')
            return Status.UNEXPECTED_ERROR
        except RobotsError as error:
            self._log(f'{method} is refused: {error}')
            return Status.SYSTEM_STATE
        return Status.OK
