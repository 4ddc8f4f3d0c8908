"""lua_program_node: runs a robot program in Lua against the nodes that move the robot."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any, Final

import numpy as np
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64, String
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory

from robots_controller.editor.debug_adapter_server import DebugAdapterServer
from robots_controller.interpreter.debugger import STEPS, breakpoints_by_file
from robots_controller.interpreter.lua_program import ANALOG_SIZE, DIGITAL_SIZE, LuaProgram
from robots_controller.io.io_image import IMAGES
from robots_controller.nodes.io_services import IoServices
from robots_controller.nodes.motion_client import MotionClient
from robots_controller.nodes.path_switching import PathSwitching
from robots_controller.nodes.program_status import ProgramStatus
from robots_controller.program.program_state import MotionCommand, OutputChange, RunState
from robots_core.errors import InvalidInputError, ProgramError, RobotsError
from robots_core.pose import Pose
from robots_core.ros.messages import joint_values
from robots_core.ros.polled_subscription import PolledSubscription
from robots_core.ros.qos import SENSOR, STATE, STREAM
from robots_core.ros.robot_node import RobotNode, bounded
from robots_core.ros.run import run
from robots_core.validation import Array

AUTOSTART_PERIOD: Final = 0.1  # s
JOIN_TIMEOUT: Final = 5.0  # s
# Drives tell their position far more often; a program that asks at its start waits for the first one.
FEEDBACK_TIMEOUT: Final = 2.0  # s
FEEDBACK_PERIOD: Final = 0.005  # s

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
        digital_input_names, digital_output_names, analog_input_names, analog_output_names: Names of the
            channels, from the first on; '' names none.
        planner_timeout: Longest wait of a motion for planning_node, s.
        autostart: Open and run the program as soon as somebody plans motions and the controller works.
        points_file: Where taught points stand; '' for the program's name with .points.yaml.
        breakpoints: Lines to hold at, as 'file.lua:12'.
        step_mode: How far `~/step` goes: over, in, out (lines) or motion.
        debug_port: Port on this machine where editors connect (Debug Adapter Protocol); 0 for none.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__('lua_program_node', **options)
        # Kinematics load their compiled code when they are first used: in a motion, this node would be deaf.
        self.robot.direct_kinematics(np.array(self.robot.home))
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
        labels = {image: self._names(image.removesuffix('s')) for image in IMAGES}
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
            io_labels=labels,
            orientation_convention=convention,
            prismatic=axes.prismatic,
            joint_position=self._joint_position,
            direct_kinematics=lambda q: Pose(*self.robot.direct_kinematics(q)),
            on_command=self._on_command,
            on_flush=self._on_flush,
            on_abort=self._on_abort,
            on_guided=lambda state: self._command_state_publisher.publish(String(data=state.value)),
            on_hold=self._on_hold,
            on_override=lambda value: self._override_publisher.publish(Float64(data=value)),
            on_output=self._on_output,
            on_print=self._on_print,
            on_line=self._on_line,
            on_held=self._on_held,
            on_finished=self._on_finished,
        )
        self.parameter('points_file', '', "where taught points stand; '' for a file beside the program")
        self.parameter(
            'breakpoints',
            [''],
            "lines to hold at, as 'file.lua:12'; '' is none",
            check=breakpoints_by_file,
        )
        self.add_post_set_parameters_callback(lambda _: self._set_breakpoints())
        self._set_breakpoints()
        self.parameter('step_mode', 'over', f'how far ~/step goes: {", ".join(STEPS)}', check=_known_step)
        port = self.parameter(
            'debug_port', 0, 'port on this machine where editors connect; 0 for none', read_only=True
        )
        self._status = ProgramStatus(self, self._program, self.robot_name)
        self._print_logger = self.get_logger().get_child('print')  # type: ignore[no-untyped-call]
        self._command_state_publisher = self.create_publisher(String, 'command_state', STATE)
        self._override_publisher = self.create_publisher(Float64, 'override', STATE)
        self._feedback: PolledSubscription[JointState] = PolledSubscription(
            self, JointState, 'joint_states', SENSOR
        )
        self._measured: Array | None = None
        self._files: dict[MotionCommand, str] = {}  # the programs of motions that were not sent yet
        self._switching = PathSwitching(
            self,
            joint_names=axes.names,
            direct_kinematics=lambda q: Pose(*self.robot.direct_kinematics(q)),
            switch=self._program.switch_output,
        )
        self._motions = MotionClient(
            self,
            joint_names=axes.names,
            planner_timeout=timeout,
            on_sent=self._on_sent,
            on_result=self._on_motion_result,
        )
        self._io = IoServices(self, self._program.io, self._on_inputs)
        handlers: dict[str, Handler] = {
            'open': self._open,
            'run': self._run,
            'pause': self._pause,
            'resume': self._resume,
            'step': self._step,
            'stop': self._stop,
            'get_call_stack': self._get_call_stack,
            'reset': self._reset,
            'get_command_state': lambda: self._program.command_state.value,
        }
        for name, handler in handlers.items():
            self.create_service(Trigger, f'~/{name}', partial(self._serve, name, handler))
        self._publish_command_state()
        self._status.publish()
        self._debug_server = DebugAdapterServer(self._program, port=port) if port else None
        if self._debug_server is not None:
            self._debug_server.start()
            self.get_logger().info(  # type: ignore[no-untyped-call]
                f'editors debug programs at port {self._debug_server.port}'
            )
        self._controller_works = False
        if autostart:
            self._autostart = self.create_timer(AUTOSTART_PERIOD, self._start)
            self._reference = self.create_subscription(
                JointTrajectory, 'joint_reference', self._on_reference, STREAM
            )
        self.ready()

    def _names(self, channel: str) -> tuple[str, ...]:
        text = f'names of the {channel.replace("_", " ")}s, from the first on; an empty one names none'
        # An empty list would have no type; one empty name says the same.
        return tuple(self.parameter(f'{channel}_names', [''], text, read_only=True))

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
            points = self.get_parameter('points_file').value
            self._program.points_file = Path(points) if points else None
        except RobotsError as error:
            self._status.open_error = str(error)
            self._status.publish()
            raise
        self._status.open_error = ''
        self._status.publish()
        return f'{self._program.file} is open'

    def _run(self) -> str:
        self._program.run()
        self._status.open_error = ''
        self._status.publish()
        return f'{self._program.file} runs'

    def _pause(self) -> str:
        if not self._program.pause():
            raise ProgramError('no program is running')
        self._status.publish()
        return f'{self._program.file} is paused'

    def _resume(self) -> str:
        if not self._program.resume():
            raise ProgramError('no program is paused')
        self._status.publish()
        return f'{self._program.file} goes on'

    def _step(self) -> str:
        if self._program.run_state is RunState.OPENED:
            self._program.run(hold=True)
            return f'{self._program.file} is held before its first line'
        if not self._program.step(self.get_parameter('step_mode').value):
            raise ProgramError('no program is held; pause it, or set breakpoints')
        self._status.publish()
        return f'{self._program.file} makes a step'

    def _get_call_stack(self) -> str:
        stack = self._program.call_stack
        if not stack.frames:
            raise ProgramError('no program is held; pause it, or set breakpoints')
        return json.dumps(asdict(stack))

    def _set_breakpoints(self) -> None:
        lines = breakpoints_by_file(self.get_parameter('breakpoints').value)
        for file in self._program.debugger.breakpoints.keys() | lines.keys():
            self._program.debugger.set_breakpoints(file, lines.get(file, ()))

    def _stop(self) -> str:
        if not self._program.stop():
            raise ProgramError('no program is running')
        self._motions.stop()
        return f'{self._program.file} stops'

    def _reset(self) -> str:
        self._program.reset()
        self._status.open_error = ''
        self._status.publish()
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

    def _on_inputs(self, topic: str, error: InvalidInputError | None) -> None:
        if error is None:
            self.ready()
        else:
            self.refuse(topic, error)

    def _on_motion_result(self, id_: str, command: MotionCommand, error: RobotsError | None) -> None:
        self._switching.finish(id_, ok=error is None)
        self._files.pop(command, None)
        # IDLE is published before the program can command the next motion.
        if error is not None or command in self._program.motions[-1:]:
            self._command_state_publisher.publish(String(data='IDLE'))
        self._program.finish_motion(error, command)

    # -- the program's thread -----------------------------------------------------------------------

    def _on_command(self, command: MotionCommand) -> None:
        self._status.publish_if_due()
        self._publish_command_state()
        self._files[command] = self._program.line_file
        self._motions.send(command)
        if self._program.stopping:  # the stop came before there was a motion to stop
            self._motions.stop()

    def _on_sent(self, id_: str, command: MotionCommand) -> None:
        self._switching.watch(id_, command)
        # The program may be far ahead of the motions that it blends: whoever reads along is told their lines.
        self._status.motion_sent(id_, self._files.pop(command, ''), command.line)

    def _joint_position(self) -> Array:
        end = time.monotonic() + FEEDBACK_TIMEOUT
        while True:
            message = self._feedback.take()
            if message is not None:
                self._measured = joint_values(
                    message.name, message.position, self.robot.axes_data.names, 'joint_states'
                )
            if self._measured is not None:
                return self._measured
            if time.monotonic() > end or self._program.stopping:
                raise ProgramError('no joint_states received: is drive_node running?')
            time.sleep(FEEDBACK_PERIOD)

    def _on_flush(self) -> None:
        self._motions.flush()

    def _on_abort(self) -> None:
        self._motions.stop()

    def _on_hold(self, held: bool) -> None:  # noqa: FBT001  # a callback's only argument
        self._motions.ask_controller('pause' if held else 'resume')

    def _on_held(self) -> None:
        self._status.publish()
        if self._debug_server is not None:
            self._debug_server.on_held()

    def _on_output(self, _: OutputChange) -> None:
        self._status.publish_if_due()
        self._io.publish()

    def _on_print(self, text: str, line: int) -> None:
        self._print_logger.info(text)
        if self._debug_server is not None:
            self._debug_server.on_print(text, line)

    def _on_line(self, _line: int) -> None:
        self._status.line_changed()

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
        self._status.publish()
        if self._debug_server is not None:
            self._debug_server.on_finished(error)

    # -- state, from any thread -----------------------------------------------------------------------

    def _publish_command_state(self) -> None:
        self._command_state_publisher.publish(String(data=self._program.command_state.value))

    def destroy_node(self) -> None:
        """End the program before what it uses."""
        if self._debug_server is not None:
            self._debug_server.close()
        self._program.stop()
        self._program.join(JOIN_TIMEOUT)
        super().destroy_node()  # type: ignore[no-untyped-call]


def _known_step(step: str) -> None:
    if step not in STEPS:
        raise InvalidInputError(f'{step!r} is no step; steps are {", ".join(STEPS)}')


def main() -> None:
    """Start the node."""
    sys.exit(run(LuaProgramNode))


if __name__ == '__main__':
    main()
