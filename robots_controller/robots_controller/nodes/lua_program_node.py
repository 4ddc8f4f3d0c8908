"""lua_program_node: runs a robot program in Lua against the nodes that move the robot."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Mapping
from dataclasses import asdict
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from diagnostic_msgs.msg import DiagnosticStatus
from std_msgs.msg import String

from robots_controller.cell.point_teaching import PointTeaching
from robots_controller.cell.program_host import ProgramHost
from robots_controller.defaults import ANALOG_SIZE, DIGITAL_SIZE
from robots_controller.editor.debug_adapter_server import DebugAdapterServer, new_token
from robots_controller.interpreter.debugger import STEPS, breakpoints_by_file
from robots_controller.io.fail_safe import parse_fail_safe
from robots_controller.io.io_image import IMAGES
from robots_controller.io.io_signals import LARGEST_INDEX
from robots_controller.nodes.autostart import Autostart
from robots_controller.nodes.io_services import IoServices
from robots_controller.nodes.ports.program.feedback_client import FeedbackClient
from robots_controller.nodes.ports.program.program_clock import LockstepTurns, ProgramClock
from robots_controller.nodes.ports.program.suite_motions import SuiteMotions
from robots_controller.program.joint_feedback import JointFeedback
from robots_controller.program.motions.motion_command import MotionCommand, OutputChange
from robots_controller.program.run_state import RunState
from robots_core.blocks.following.guide import Guide
from robots_core.cell_interface.driver_file import Driver, read_driver
from robots_core.errors import InvalidInputError, ProgramError, RobotsError
from robots_core.nodes.shared_parameters import payload_from_parameters
from robots_core.ros.messages import BUILD
from robots_core.ros.peers.heartbeat import FreshCommands, watchdog_parameter
from robots_core.ros.qos import make_publisher
from robots_core.ros.robot_node import PORTS, RobotNode
from robots_core.ros.running.run import run
from robots_core.status import Status
from robots_core.validation import one_of
from robots_planning.robot_command_state import RobotCommandState

if TYPE_CHECKING:
    from robots_controller.nodes.ports.program.primitive_action import PrimitiveAction

JOIN_TIMEOUT: Final = 5.0  # s
DEBUG_PORTS: Final = (-1, PORTS[1])
WATCH_PERIOD: Final = 0.1  # s
FILES: Final = ('program', 'points_file', 'frames_file')
STATUS_PERIOD: Final = 0.02  # s, after which a change that could not be reported at once is reported


class LuaProgramNode(RobotNode):
    """Opens, runs, pauses and stops a program; publishes what it commands, switches and prints.

    The program's text output goes to the log, from the child logger `print`.
    """

    diagnostics_group = 'program'

    def __init__(self, **options: Any) -> None:
        super().__init__('lua_program_node', **options)
        self.parameter('program', '', "the robot program's path, read at ~/open")
        convention = self.parameter(
            'orientation_convention',
            self.robot.orientation_convention,
            'order of the angles phi: zyx, xyz, zyz or XYZ',
        )
        sizes = {
            f'{kind}_size': self.parameter(
                f'{kind}_size', size, f'number of {kind} inputs, and of outputs', bounds=(0, LARGEST_INDEX)
            )
            for kind, size in (('digital', DIGITAL_SIZE), ('analog', ANALOG_SIZE))
        }
        channel_services = self.parameter(
            'channel_services', False, 'serve each digital channel by itself, as ~/digital_input_1/set'
        )
        labels = {image: self._names(image.removesuffix('s')) for image in IMAGES}
        timeout = self.parameter(
            'planner_timeout', 5.0, 'longest wait of a motion for planning_node, s', bounds=(0.1, 600.0)
        )
        payload_from_parameters(self)
        fail_safe = self.parameter(
            'fail_safe',
            [''],
            "values of outputs when no running program answers for them, as 'digital_output.3=hold'",
            read=parse_fail_safe,
        )
        text = "driver that takes motion primitives (YAML); '' moves the robot by planner and controller"
        driver = self.parameter('driver', '', text, read=lambda path: read_driver(path) if path else None)
        axes = self.robot.axes_data
        self._command_state_publisher = make_publisher(self, String, 'command_state')
        self._guide_publisher = make_publisher(self, String, 'guide')
        self._status_publisher = make_publisher(self, DiagnosticStatus, 'program_status')
        self._feedback = FeedbackClient(self, axes.names)
        self._watchdog = watchdog_parameter(self)
        self._fresh = FreshCommands(self, self._watchdog)
        motions = SuiteMotions(self, self._fresh.missed) if driver is None else self._driven(driver)
        self._motions: SuiteMotions | PrimitiveAction = motions
        self._turns = None if self.participant is None else LockstepTurns(self.participant)
        self.host = ProgramHost(
            self.robot,
            clock=ProgramClock(self) if self._turns is None else self._turns.clock,
            robot_port=self,
            planner=motions.planner,
            controller=motions.controller,
            observer=self,
            **sizes,
            io_labels=labels,
            orientation_convention=convention,
            planner_timeout=timeout,
            payload=tuple(self.get_parameter('payload').value),
            fail_safe=fail_safe,
            simulated=self._turns is not None,
        )
        self._program = self.host.program
        self.parameter('points_file', '', "where taught points stand; '' for a file beside the program")
        self.parameter('frames_file', '', "where tools and bases stand; '' for frames.yaml beside it")
        self.host.unopened = self._files
        self._take_over()
        text = "lines to hold at, as 'file.lua:12'; '' is none"
        self._set_breakpoints(self.parameter('breakpoints', [''], text, read=breakpoints_by_file))
        self.on_change('breakpoints', self._set_breakpoints)
        self.parameter(
            'step_mode', 'over', f'how far ~/step goes: {", ".join(STEPS)}', read=one_of('step', STEPS)
        )
        self.parameter('point', '', "name of the point that ~/teach stores; '' for the next free one")
        port = self.parameter(
            'debug_port',
            0,
            'port on this machine where editors connect; 0 for none, -1 for any',
            bounds=DEBUG_PORTS,
        )
        token = self.parameter('debug_token', '', 'what editors must give; empty for a new one')
        self.create_timer(WATCH_PERIOD, self.host.motions.watch)
        motions.report_to(self.host, self._changed, self._watchdog)
        self._status_timer = self.create_timer(STATUS_PERIOD, self._report_in_time)
        self._status_due = self.create_guard_condition(self._status_timer.reset)
        self._io = IoServices(self, self._program.io, self._on_inputs, channel_services=channel_services)
        host, teaching = self.host, PointTeaching(self.robot, self._program)
        handlers: dict[str, Callable[[], str]] = {
            'open': self._open,
            'close': host.close,
            'run': host.run,
            'pause': host.pause,
            'resume': host.resume,
            'step': lambda: host.step(self.get_parameter('step_mode').value),
            'stop': host.stop,
            'teach': lambda: teaching.teach(self.get_parameter('point').value, self._feedback.present()),
            'get_program': self._get_program,
            'get_call_stack': self._get_call_stack,
            'reset': host.reset,
            'get_command_state': lambda: self._program.command_state.value,
        }
        for name, handler in handlers.items():
            self.serve(name, partial(self._answer, name, handler))
        # Of a node that is refused before, it would take the name from the next one when it is collected.
        self._print_logger = self.journal.get_child('print')
        self.command_state(self._program.command_state)
        self.guide(Guide.NONE)
        host.reporter.report()
        self._debug_server = self._serve_editors(port, token) if port else None
        Autostart(self, motions.watch_readiness, self._start)
        self.ready()

    def _driven(self, driver: Driver) -> PrimitiveAction:
        # Imported on demand: it loads the planners, which no other robot needs in this process.
        module = import_module('robots_controller.nodes.ports.program.primitive_action')
        action: PrimitiveAction = module.PrimitiveAction(self, driver, self._feedback, self._fresh.missed)
        return action

    def _names(self, channel: str) -> tuple[str, ...]:
        text = f'names of the {channel.replace("_", " ")}s, from the first on; an empty one names none'
        # An empty list would have no type; one empty name means the same.
        return tuple(self.parameter(f'{channel}_names', [''], text))

    # -- services -------------------------------------------------------------------------------------

    def _answer(self, name: str, handler: Callable[[], str]) -> str:
        try:
            answer = handler()
        except RobotsError as error:
            self.journal.error(f'~/{name}: {error}')
            raise
        if self._turns is not None:
            self._turns.begun() if name == 'run' else self._turns.changed()
        return answer

    def _open(self) -> str:
        return self.host.open(*self._files)

    @property
    def _files(self) -> tuple[str, str, str]:
        program, points, frames = (self.get_parameter(name).value for name in FILES)
        return program, points, frames

    def _get_program(self) -> str:
        program = self._program
        files = self.host.unopened
        if program.path is not None:
            files = str(program.path), str(program.points_file or ''), str(program.frames_file or '')
        return json.dumps(dict(zip(FILES, files, strict=True)) | {'written': program.written})

    def _get_call_stack(self) -> str:
        stack = self._program.call_stack
        if not stack.frames:
            raise ProgramError('no program is held; pause it, or set breakpoints')
        return json.dumps(asdict(stack))

    def _serve_editors(self, port: int, token: str) -> DebugAdapterServer:
        program = self.get_parameter('program').value
        folder = Path(program).parent if program else Path.cwd()
        shown = token or new_token()
        server = DebugAdapterServer(self._program, token=shown, folder=folder, port=port)
        secret = '' if token else f' with token {shown}'
        self.journal.info(f'editors debug programs below {folder} at port {server.port}{secret}')
        return server

    def _set_breakpoints(self, lines: Mapping[str, Collection[int]]) -> None:
        for file in self._program.debugger.breakpoints.keys() | lines.keys():
            self._program.debugger.set_breakpoints(file, lines.get(file, ()))

    def _take_over(self) -> None:
        """Go on from what an earlier process of this node has left."""
        outputs = self.parameter(
            'outputs',
            [''],
            "values that outputs have at the start, as 'digital_output.3=1'",
            read=parse_fail_safe,
        )
        interrupted = self.parameter(
            'interrupted', '', 'what ended the program in an earlier process of this node'
        )
        for name, value in outputs.items():
            self._program.io.set_value(self._program.io.find(name), value or 0.0)
        if interrupted:
            try:
                self.host.reopen(*self._files, interrupted=interrupted)
            except RobotsError as error:
                self.journal.error(str(error))

    def _start(self) -> None:
        try:
            self._open()
            self.host.run()
            if self._turns is not None:
                self._turns.begun()
        except RobotsError as error:
            self.journal.error(f'autostart: {error}')

    # -- messages -------------------------------------------------------------------------------------

    def _changed(self) -> None:
        if self._turns is not None:
            self._turns.changed()

    def _on_inputs(self, topic: str, error: InvalidInputError | None) -> None:
        self._changed()
        if error is None:
            self.ready()
        else:
            self.refuse(topic, error)

    def held_up(self, silence: float) -> None:
        """The others have missed this node: its outputs have been made safe, and the robot was stopped."""
        if self._fresh.held_up(silence):
            self.host.held_up(silence)

    # -- the program's robot, from its thread -----------------------------------------------------

    def joint_feedback(self) -> JointFeedback:
        """See `RobotPort`; waits for feedback."""
        return self._feedback.measured(self.host.clock, lambda: self._program.stopping)

    def guide(self, guide: Guide) -> None:
        """See `RobotPort`."""
        self._motions.check_guide(guide)
        self._guide_publisher.publish(String(data=guide.value))

    # -- what the program does, from any thread -------------------------------------------------------

    def command_state(self, state: RobotCommandState) -> None:
        """See `ProgramObserver`."""
        self._command_state_publisher.publish(String(data=state.value))

    def status(self, _state: RunState, status: Status) -> None:
        """See `ProgramObserver`."""
        self._status_publisher.publish(BUILD.status(status, self.robot_name))

    def motion_sent(self, id_: str, command: MotionCommand, file: str) -> None:
        """See `ProgramObserver`; the status names it."""

    def motion_ended(self, id_: str, command: MotionCommand, error: RobotsError | None) -> None:
        """See `ProgramObserver`; the program's status names a failure."""

    def outputs_changed(self, _change: OutputChange) -> None:
        """See `ProgramObserver`."""
        if self.context.ok():  # else nothing can be published any more
            self._io.publish()

    def printed(self, text: str, line: int) -> None:
        """See `ProgramObserver`."""
        self._print_logger.info(text)
        if self._debug_server is not None:
            self._debug_server.adapter.on_print(text, line)

    def line_reached(self, _line: int) -> None:
        """See `ProgramObserver`; the status names it."""
        if not self._status_timer.is_canceled():
            return
        if self.participant is not None:
            self._status_timer.reset()
        elif self.host.reporter.due:  # an executor that waits sees no timer that begins meanwhile
            self._status_due.trigger()

    def _report_in_time(self) -> None:
        reporter = self.host.reporter
        reporter.report_in_time()
        if not reporter.due:
            self._status_timer.cancel()  # until the next line that is not reported at once
            if reporter.due:  # it came just now
                self._status_timer.reset()

    def held_changed(self) -> None:
        """See `ProgramObserver`."""
        if self._debug_server is not None:
            self._debug_server.adapter.on_held()

    def ended(self, error: ProgramError | None) -> None:
        """See `ProgramObserver`."""
        if not self.context.ok():  # nothing can be published any more
            return
        if error is None:
            self.journal.info(f'{self._program.file}: {self._program.run_state}')
        else:
            stack = error.details.get('stack', '')
            self.journal.error(f'{error}\n{stack}'.rstrip())
        if self._debug_server is not None:
            self._debug_server.adapter.on_finished(error)

    def destroy_node(self) -> None:
        """End the program before what it uses, and leave the outputs at their fail-safe values."""
        if self._debug_server is not None:
            self._debug_server.close()
        self._program.stop()
        if self._turns is not None:
            self._turns.clock.end()
        self._program.join(JOIN_TIMEOUT)
        self.host.make_outputs_safe()
        if self.context.ok():
            self._motions.end()
            self._io.finish()
        # ROS drops the name of a logger with it, and a later node in this process may have the same name.
        self._print_logger = self.journal
        super().destroy_node()


main: Final = partial(run, LuaProgramNode)
