"""lua_program_node: runs a robot program in Lua against the nodes that move the robot."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable
from functools import partial
from typing import Any, Final

from diagnostic_msgs.msg import DiagnosticStatus
from std_msgs.msg import Float64MultiArray, String, UInt8MultiArray
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory

from robots_controller.interpreter.lua_program import ANALOG_SIZE, DIGITAL_SIZE, LuaProgram
from robots_controller.interpreter.program_state import MotionCommand, OutputChange
from robots_controller.nodes.motion_client import MotionClient
from robots_core.errors import InvalidInputError, ProgramError, RobotsError
from robots_core.nodes.messages import diagnostic_status, doubles
from robots_core.nodes.qos import STATE, STREAM, subscribe_state
from robots_core.nodes.robot_node import RobotNode, bounded
from robots_core.nodes.run import run

# Lines of a loop that computes change thousands of times a second; nobody reads faster than this.
STATUS_PERIOD: Final = 0.02  # s
AUTOSTART_PERIOD: Final = 0.1  # s
PRINT_LIMIT: Final = 10_000  # characters
JOIN_TIMEOUT: Final = 5.0  # s

Handler = Callable[[], str]
"""Does what a service is asked for and says so; raises a RobotsError."""


class LuaProgramNode(RobotNode):
    """Opens, runs, pauses and stops a program; publishes what it commands, switches and prints.

    The program's text output goes to the log, from the child logger `print`.

    Parameters:
        program: The robot program's path, read at `~/open`.
        orientation_convention: Order of the angles phi; the robot's own by default.
        digital_size: Number of digital inputs, and of digital outputs.
        analog_size: Number of analog inputs, and of analog outputs.
        planner_timeout: Longest wait of a motion for planning_node, s.
        autostart: Open and run the program as soon as somebody plans motions and the controller works.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__('lua_program_node', **options)
        self.parameter('program', '', "the robot program's path, read at ~/open")
        convention = self.parameter(
            'orientation_convention',
            self.robot.orientation_convention,
            'order of the angles phi: zyx, xyz, zyz or XYZ',
            read_only=True,
        )
        sizes = {
            name: self.parameter(name, size, text, read_only=True)
            for name, size, text in (
                ('digital_size', DIGITAL_SIZE, 'number of digital inputs, and of digital outputs'),
                ('analog_size', ANALOG_SIZE, 'number of analog inputs, and of analog outputs'),
            )
        }
        timeout = self.parameter(
            'planner_timeout',
            5.0,
            'longest wait of a motion for planning_node, s',
            check=bounded(0.1, 600.0, 's'),
            read_only=True,
        )
        autostart = self.parameter(
            'autostart', False, 'open and run the program as soon as the robot can move', read_only=True
        )
        axes = self.robot.axes_data
        self._program = LuaProgram(
            axes.num_axes,
            **sizes,
            orientation_convention=convention,
            prismatic=axes.prismatic,
            on_command=self._on_command,
            on_output=self._on_output,
            on_print=self._on_print,
            on_line=self._on_line,
            on_finished=self._on_finished,
        )
        self._status_lock = threading.Lock()
        self._status_time = -STATUS_PERIOD
        self._status_due = False
        self._open_error = ''
        self._print_logger = self.get_logger().get_child('print')  # type: ignore[no-untyped-call]
        self._command_state_publisher = self.create_publisher(String, 'command_state', STATE)
        self._status_publisher = self.create_publisher(DiagnosticStatus, 'program_status', STATE)
        self._digital_publisher = self.create_publisher(UInt8MultiArray, 'digital_outputs', STATE)
        self._analog_publisher = self.create_publisher(Float64MultiArray, 'analog_outputs', STATE)
        self._motions = MotionClient(
            self, joint_names=axes.names, planner_timeout=timeout, on_result=self._on_motion_result
        )
        subscribe_state(self, UInt8MultiArray, 'digital_inputs', partial(self._on_inputs, 'digital_inputs'))
        subscribe_state(self, Float64MultiArray, 'analog_inputs', partial(self._on_inputs, 'analog_inputs'))
        handlers: dict[str, Handler] = {
            'open': self._open,
            'run': self._run,
            'pause': self._pause,
            'resume': self._resume,
            'stop': self._stop,
            'reset': self._reset,
            'get_command_state': lambda: self._program.command_state.value,
        }
        for name, handler in handlers.items():
            self.create_service(Trigger, f'~/{name}', partial(self._serve, name, handler))
        self.create_timer(STATUS_PERIOD, self._publish_due_status)
        self._publish_command_state()
        self._publish_outputs('digital')
        self._publish_outputs('analog')
        self._publish_status()
        self._controller_works = False
        if autostart:
            self._autostart = self.create_timer(AUTOSTART_PERIOD, self._start)
            self._reference = self.create_subscription(
                JointTrajectory, 'joint_reference', self._on_reference, STREAM
            )
        self.ready()

    # -- services -------------------------------------------------------------------------------------

    def _serve(
        self, name: str, handler: Handler, _: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        try:
            response.success, response.message = True, handler()
        except RobotsError as error:
            response.success, response.message = False, str(error)
            self.get_logger().error(f'~/{name}: {error}')  # type: ignore[no-untyped-call]
        return response

    def _open(self) -> str:
        path = self.get_parameter('program').value
        try:
            if not path:
                raise ProgramError("parameter 'program' is empty; set it to the path of a Lua program")
            self._program.open(path)
        except RobotsError as error:
            self._open_error = str(error)
            self._publish_status()
            raise
        self._open_error = ''
        self._publish_status()
        return f'{self._program.file} is open'

    def _run(self) -> str:
        self._program.run()
        self._open_error = ''
        self._publish_status()
        return f'{self._program.file} runs'

    def _pause(self) -> str:
        if not self._program.pause():
            raise ProgramError('no program is running')
        self._motions.ask_controller('pause')
        self._publish_status()
        return f'{self._program.file} is paused'

    def _resume(self) -> str:
        if not self._program.resume():
            raise ProgramError('no program is paused')
        self._motions.ask_controller('resume')
        self._publish_status()
        return f'{self._program.file} goes on'

    def _stop(self) -> str:
        if not self._program.stop():
            raise ProgramError('no program is running')
        self._motions.stop()
        return f'{self._program.file} stops'

    def _reset(self) -> str:
        self._program.reset()
        self._open_error = ''
        self._publish_status()
        return f'{self._program.file} is at its start'

    def _start(self) -> None:
        if not (self._controller_works and self._motions.planner_listens()):
            return
        self.destroy_timer(self._autostart)
        self.destroy_subscription(self._reference)
        try:
            self._open()
            self._run()
        except RobotsError as error:
            self.get_logger().error(f'autostart: {error}')  # type: ignore[no-untyped-call]

    def _on_reference(self, _: JointTrajectory) -> None:
        # A motion is planned from the reference: without one it would be refused.
        self._controller_works = True

    # -- messages -------------------------------------------------------------------------------------

    def _on_inputs(self, topic: str, message: UInt8MultiArray | Float64MultiArray) -> None:
        try:
            if topic == 'digital_inputs':
                self._program.digital_inputs = message.data
            else:
                self._program.analog_inputs = message.data
        except InvalidInputError as error:
            self.refuse(topic, error)
            return
        self.ready()

    def _on_motion_result(self, error: RobotsError | None) -> None:
        # IDLE is published before the program can command the next motion.
        self._command_state_publisher.publish(String(data='IDLE'))
        self._program.finish_motion(error)

    # -- the program's thread -----------------------------------------------------------------------

    def _on_command(self, command: MotionCommand) -> None:
        self._publish_due_status()
        self._publish_command_state()
        self._motions.send(command)
        if self._program.stopping:  # the stop came before there was a motion to stop
            self._motions.stop()

    def _on_output(self, change: OutputChange) -> None:
        self._publish_due_status()
        self._publish_outputs(change.kind)

    def _on_print(self, text: str, _line: int) -> None:
        if len(text) > PRINT_LIMIT:
            text = f'{text[:PRINT_LIMIT]}... ({len(text)} characters)'
        self._print_logger.info(text)

    def _on_line(self, _line: int) -> None:
        self._status_due = True
        if time.monotonic() - self._status_time >= STATUS_PERIOD:
            self._publish_due_status()

    def _on_finished(self, error: ProgramError | None) -> None:
        if not self.context.ok():  # nobody listens any more
            return
        if error is None:
            self.get_logger().info(  # type: ignore[no-untyped-call]
                f'{self._program.file}: {self._program.run_state}'
            )
        else:
            stack = error.details.get('stack', '')
            self.get_logger().error(f'{error}\n{stack}'.rstrip())  # type: ignore[no-untyped-call]
        self._publish_status()

    # -- state, from any thread -----------------------------------------------------------------------

    def _publish_command_state(self) -> None:
        self._command_state_publisher.publish(String(data=self._program.command_state.value))

    def _publish_outputs(self, kind: str) -> None:
        if kind == 'digital':
            values = self._program.digital_outputs
            self._digital_publisher.publish(UInt8MultiArray(data=values.tobytes()))
        else:
            self._analog_publisher.publish(Float64MultiArray(data=doubles(self._program.analog_outputs)))

    def _publish_due_status(self) -> None:
        if self._status_due:
            self._publish_status()

    def _publish_status(self) -> None:
        with self._status_lock:
            self._status_due = False
            self._status_time = time.monotonic()
            program = self._program
            state, line = program.run_state, program.line
            error = str(program.error or self._open_error)
            self._status_publisher.publish(
                diagnostic_status(
                    'program',
                    error or f'{program.file or "no program"}: {state}',
                    level=DiagnosticStatus.ERROR if error else DiagnosticStatus.OK,
                    hardware_id=self.robot_name,
                    state=state.value,
                    file=program.file,
                    line=line,
                    source=program.source_line(line),
                    error=error,
                )
            )

    def destroy_node(self) -> None:
        """End the program before what it uses."""
        self._program.stop()
        self._program.join(JOIN_TIMEOUT)
        super().destroy_node()  # type: ignore[no-untyped-call]


def main() -> None:
    """Start the node."""
    sys.exit(run(LuaProgramNode))


if __name__ == '__main__':
    main()
