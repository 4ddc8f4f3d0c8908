"""ProgramClient: the robot program of a cell."""

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Final

from diagnostic_msgs.msg import DiagnosticStatus
from rcl_interfaces.msg import Log
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter

from robots_controller.client.cell_services import CellServices
from robots_controller.program.run_state import RunState
from robots_core.errors import InvalidInputError, NoAnswerError, ProgramError
from robots_core.ros.messages import diagnostic_values, number_in
from robots_core.ros.qos import subscribe

ENDED: Final = frozenset({RunState.FINISHED, RunState.FAILED, RunState.STOPPED})


def set_parameters(services: CellServices, node: str, **values: object) -> None:
    """Set parameters of a node of the cell.

    Raises:
        InvalidInputError: it refuses one.
    """
    parameters = [Parameter(name, value=value).to_parameter_msg() for name, value in values.items()]
    request = SetParameters.Request(parameters=parameters)
    for result in services.answer(f'{node}/set_parameters', SetParameters, request).results:
        if not result.successful:
            raise InvalidInputError(result.reason)


def open_program(services: CellServices, path: Path | str, points_file: Path | str = '') -> None:
    """Open a program, see `ProgramClient.open`."""
    points = str(Path(points_file).resolve()) if points_file else ''
    set_parameters(services, 'lua_program_node', program=str(Path(path).resolve()), points_file=points)
    services.trigger('lua_program_node/open')


class ProgramClient:
    """Opens, runs, holds and stops the program, as a person does at a pendant.

    Methods raise a RobotsError if lua_program_node refuses or does not answer.
    """

    def __init__(self, connection: CellServices) -> None:
        self._connection = connection
        self._changed = threading.Condition()
        self._status: dict[str, str] = {}
        self.on_print: Callable[[str], object] | None = None
        """Called with each text that the program prints, in the client's thread."""
        subscribe(connection.node, DiagnosticStatus, 'program_status', self._on_status)
        subscribe(connection.node, Log, '/rosout', self._on_log)
        namespace = connection.node.get_namespace().strip('/').replace('/', '.')
        self._printer = f'{namespace}.lua_program_node.print'.lstrip('.')

    @property
    def state(self) -> RunState | None:
        """What the program does, or how it has ended; None where the cell has not reported it yet."""
        text = self._status.get('state')
        return None if text is None else RunState(text)

    @property
    def line(self) -> int:
        """Line of the program, counted from 1; 0 for none."""
        return int(number_in(self._status, 'line', 0.0))

    @property
    def error(self) -> str:
        """Why the program has failed; '' if it has not."""
        return self._status.get('error', '')

    def open(self, path: Path | str, points_file: Path | str = '') -> None:
        """Open a program.

        Args:
            path: Lua robot program, on the machine of the cell.
            points_file: Its taught points; '' for the file beside it.
        """
        open_program(self._connection, path, points_file)

    def run(self) -> None:
        """Run the program that is open, until the cell reports that it has begun; `wait` for its end."""
        self._await_status(lambda: 'run' in self._status)
        before = self._status['run']
        self._call('run')
        # `wait` must not see how the program ended before.
        self._await_status(lambda: self._status['run'] != before)

    def pause(self) -> None:
        """Hold the program, and the robot on its path."""
        self._call('pause')

    def resume(self) -> None:
        """Go on after `pause`."""
        self._call('resume')

    def stop(self) -> None:
        """Stop the program, and the robot on its path."""
        self._call('stop')

    def reset(self) -> None:
        """Go back to the start of the program."""
        self._call('reset')

    def wait(self, timeout: float | None = None) -> bool:
        """Wait until the program has ended.

        Args:
            timeout: Longest wait, s; without end by default.

        Returns:
            False if it still runs.

        Raises:
            ProgramError: it has failed, or was stopped.
        """
        with self._changed:
            if not self._changed.wait_for(lambda: self.state in ENDED, timeout):
                return False
            if self.state is not RunState.FINISHED:
                raise ProgramError(self.error or 'the program was stopped')
            return True

    def _await_status(self, condition: Callable[[], bool]) -> None:
        patience = self._connection.patience
        with self._changed:
            if not self._changed.wait_for(condition, patience):
                raise NoAnswerError(f'lua_program_node has not reported the program for {patience:g} s')

    def _call(self, service: str) -> None:
        self._connection.trigger(f'lua_program_node/{service}')

    def _on_status(self, message: DiagnosticStatus) -> None:
        with self._changed:
            self._status = diagnostic_values(message)
            self._changed.notify_all()

    def _on_log(self, message: Log) -> None:
        if self.on_print is not None and message.name == self._printer:
            self.on_print(message.msg)
