"""ProgramHost: runs a robot program in a cell, whatever the transport is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Final

from robots_controller.cell.path_switching import PathSwitching
from robots_controller.cell.ports import ControllerPort, PlannerPort, ProgramObserver, RobotPort
from robots_controller.cell.program_motions import ProgramMotions
from robots_controller.cell.program_reporter import ProgramReporter
from robots_controller.cell.run_permission import RunPermission
from robots_controller.defaults import ANALOG_SIZE, DIGITAL_SIZE
from robots_controller.interpreter.debugger import Step
from robots_controller.interpreter.lua_program import LuaProgram
from robots_controller.io.fail_safe import FailSafe, safe_value
from robots_controller.program.clock import Clock
from robots_controller.program.motions.modal_settings import PLANNING_NODE
from robots_controller.program.motions.motion_command import MotionCommand, OutputChange
from robots_controller.program.motions.path_switches import warm_up
from robots_controller.program.robot_kinematics import RobotKinematics
from robots_controller.program.run_state import RunState
from robots_core.blocks.following.guide import Guide
from robots_core.cell_interface.operating_modes import OperatingMode
from robots_core.errors import ProgramError, RobotsError
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_planning.motion_settings import NOTHING
from robots_planning.robot_command_state import STATE_OF_GUIDE, RobotCommandState

WATCHED_NODES: Final = (PLANNING_NODE, 'controller_node')
"""The nodes without which no program moves the robot."""


class ProgramHost:
    """A program, its motions, the outputs that they switch, and the reports of all that.

    It is the cell (`CellPort`) of its `program`. A transport calls `result` with the ends of motions,
    `switching` with plans and progress, `motions.watch` and `reporter.report_in_time` regularly, and
    `permission`, `stop_changed`, `mode_changed` and `run_enabled` with what the controller reports.

    Args:
        digital_size, analog_size, io_labels: As of `LuaProgram`.
        orientation_convention: Order of the angles phi; the robot's own by default.
        planner_timeout: Longest wait of a motion for a planner, s.
        fail_safe: Values of outputs when no program controls them, see `make_outputs_safe`.

    Raises:
        InvalidInputError: as `LuaProgram`, or a fail-safe value of an output that there is not.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        *,
        clock: Clock,
        robot_port: RobotPort,
        planner: PlannerPort,
        controller: ControllerPort,
        observer: ProgramObserver,
        digital_size: int = DIGITAL_SIZE,
        analog_size: int = ANALOG_SIZE,
        io_labels: Mapping[str, Sequence[str]] = MappingProxyType({}),
        orientation_convention: str = '',
        planner_timeout: float = 5.0,
        fail_safe: FailSafe = MappingProxyType({}),
        payload: tuple[float, ...] = NOTHING,
        simulated: bool = False,
    ) -> None:
        self.payload, self.simulated = payload, simulated
        self.clock = clock
        self._robot, self.kinematics = robot, RobotKinematics(robot)
        self.robot, self.controller = robot_port, controller
        self._observer = observer
        self.program = LuaProgram(
            robot.num_axes,
            self,
            digital_size=digital_size,
            analog_size=analog_size,
            io_labels=io_labels,
            orientation_convention=orientation_convention or robot.orientation_convention,
            prismatic=robot.axes_data.prismatic,
        )
        for name in fail_safe:
            self.program.io.find(name)
        self.unopened: tuple[str, str, str] = ('', '', '')
        """Where no program is open: the one that could not be opened, its points file and its frames file, as
        `open` was given them; '' without one."""
        self._fail_safe = fail_safe
        self._unsafe = False  # the program was interrupted, and its outputs are as it left them
        self.reporter = ProgramReporter(self.program, clock, observer.status)
        self.switching = PathSwitching(robot.direct_kinematics, self.program.switch_output)
        self.motions = ProgramMotions(
            planner,
            partial(controller.request, 'cancel'),
            clock,
            planner_timeout=planner_timeout,
            on_sent=self._sent,
            on_result=self._ended,
            on_blocked=self.switching.blocked,
        )
        self.permission = RunPermission(self.lose_robot)
        self._files: dict[MotionCommand, str] = {}  # the programs of motions that were not sent yet

    # -- operation ------------------------------------------------------------------------------------

    def open(self, path: Path | str, points_file: Path | str = '', frames_file: Path | str = '') -> str:
        """Open a program.

        Args:
            path: Its file.
            points_file: Where taught points stand; '' for the program's name with .points.yaml.
            frames_file: Where tools and bases stand; '' for frames.yaml in the program's folder.

        Returns:
            What has happened, for a person; as all operations.

        Raises:
            ProgramError: see `LuaProgram.open`.
        """
        try:
            if not path:
                raise ProgramError("parameter 'program' is empty; set it to the path of a Lua program")
            self.program.open(path)
        except RobotsError as error:
            if path and self.program.path is None:
                self.unopened = str(path), str(points_file), str(frames_file)
            self.reporter.open_error = str(error)
            self.reporter.report()
            raise
        self.program.points_file = Path(points_file) if points_file else None
        self.program.frames_file = Path(frames_file) if frames_file else None
        self._report_well()
        return f'{self.program.file} is open'

    def reopen(self, *files: Path | str, interrupted: str) -> str:
        """As `open`, for a program that the end of its process has interrupted, as its status then says."""
        opened = self.open(*files)
        self.reporter.open_error = interrupted
        self.reporter.report()
        return opened

    def run(self, *, hold: bool = False) -> str:
        """Run the program from its start; with `hold`, hold it before its first line.

        Raises:
            RobotsError: as `RunPermission.check`; so do `resume` and `step`.
            ProgramError: no program is open, one is running, the robot still moves.
        """
        self.permission.check()
        self.program.run(hold=hold)
        self.clock.program_started()
        return f'{self.program.file} is held before its first line' if hold else f'{self.program.file} runs'

    def pause(self) -> str:
        """Hold the program, and the robot on its path.

        Raises:
            ProgramError: no program is running.
        """
        if not self.program.pause():
            raise ProgramError('no program is running')
        self.reporter.report()
        return f'{self.program.file} is paused'

    def resume(self) -> str:
        """Let the program continue.

        Raises:
            ProgramError: no program is held.
        """
        self.permission.check()
        if not self.program.resume():
            raise ProgramError('no program is paused')
        self.reporter.report()
        return f'{self.program.file} goes on'

    def step(self, step: Step) -> str:
        """Let the program continue for one step; one that is open begins and is held before its first line.

        Raises:
            ProgramError: no program is open or held.
        """
        self.permission.check()
        if self.program.run_state is RunState.OPENED:
            return self.run(hold=True)
        if not self.program.step(step):
            raise ProgramError('no program is held; pause it, or set breakpoints')
        self.reporter.report()
        return f'{self.program.file} makes a step'

    def stop(self) -> str:
        """Stop the program for good, and the robot on its path.

        Raises:
            ProgramError: no program is running.
        """
        if not self.program.stop():
            raise ProgramError('no program is running')
        self.motions.cancel()
        return f'{self.program.file} stops'

    def reset(self) -> str:
        """Set the program back to its start.

        Raises:
            ProgramError: no program is open, it is running, or the robot still moves.
        """
        self.program.reset()
        self._report_well()
        return f'{self.program.file} is at its start'

    def close(self) -> str:
        """Close the program.

        Raises:
            ProgramError: no program is open, it is running, or the robot still moves.
        """
        closed = self.program.file
        self.program.close()
        self.unopened = '', '', ''
        self._report_well()
        return f'{closed} is closed'

    def make_outputs_safe(self) -> None:
        """Set all outputs to their fail-safe values, and switch nothing more on the path of a motion."""
        self._unsafe = False
        self.switching.drop()
        io = self.program.io
        for channel in io.set_outputs(lambda output, value: safe_value(self._fail_safe, output, value)):
            value, line = io.value(channel), self.program.line
            self._observer.outputs_changed(OutputChange(channel.kind, channel.index, value, line))

    # -- reports of the controller --------------------------------------------------------------------

    def stop_changed(self, reason: str) -> None:
        """A fault stops the robot: a program that runs fails, outputs get fail-safe; '' after its reset."""
        self.permission.stop_reason = reason
        if reason and not self.lose_robot(reason):
            self.make_outputs_safe()

    def held_up(self, silence: float) -> None:
        """Others have made the outputs safe while the process was frozen, for so long (s)."""
        if not self.lose_robot(f'the program was held up for {silence:.3g} s; its outputs were made safe'):
            self.make_outputs_safe()

    def run_enabled(self, *, enabled: bool) -> None:
        """Motions of programs may continue: otherwise the program is held."""
        self.permission.enabled = enabled
        self._hold_by_permission()

    def mode_changed(self, mode: OperatingMode) -> None:
        """The operating mode: a program that has waited for run does not continue by a change of it."""
        if self.permission.mode_changed(mode):  # it is reported with each commander too
            self._hold_by_permission()

    def _hold_by_permission(self) -> None:
        if self.permission.suspended:
            self.program.suspend()
        else:
            self.program.set_enabled(enabled=not self.permission.run_missing)
        self.reporter.report()

    def lose_robot(self, reason: str) -> bool:
        """A program that runs fails, for this reason; False if none does."""
        running = self.program.fail(reason)
        if running:
            self.motions.cancel()
            self.make_outputs_safe()  # the program's thread may take a while to end
        return running

    def node_changed(self, name: str, reason: str) -> None:
        """One of `WATCHED_NODES` is lost, or back: ''; without a controller all outputs get fail-safe."""
        if name == PLANNING_NODE:
            self.motions.lose_planner(reason)
        if reason and not self.lose_robot(reason) and name != PLANNING_NODE:
            self.make_outputs_safe()

    def _report_well(self) -> None:
        self.reporter.open_error = ''
        self.reporter.report()

    # -- the motions ----------------------------------------------------------------------------------

    def _sent(self, id_: str, command: MotionCommand) -> None:
        file = self._files.pop(command, '')
        self.switching.sent(id_, command)
        self._observer.motion_sent(id_, command, file)
        self.reporter.motion_sent(id_, file, command.line)

    def _ended(self, id_: str, command: MotionCommand, error: RobotsError | None) -> None:
        self.switching.finish(id_, ok=error is None)
        self._files.pop(command, None)
        self._observer.motion_ended(id_, command, error)
        # IDLE is reported before the program can command the next motion.
        if error is not None or command in self.program.motions[-1:]:
            self._observer.command_state(RobotCommandState.IDLE)
        self.program.finish_motion(error, command)
        self._switch_left(command, ok=error is None)
        if self._unsafe and not self.motions.going_on:
            self.make_outputs_safe()

    # -- the program's cell ---------------------------------------------------------------------------

    def command(self, command: MotionCommand) -> None:
        """See `CellPort`."""
        self.controller.wait_for_command()
        self.reporter.report_if_due()
        self._observer.command_state(self.program.command_state)
        self._files[command] = self.program.line_file
        if command.switches or command.blend:  # outputs may be switched on their way
            warm_up(self._robot)
        self.motions.send(command)
        if self.program.stopping:  # the stop came before there was a motion to stop
            self.motions.cancel()

    def flush(self) -> None:
        """See `CellPort`."""
        self.motions.flush()

    def abort(self) -> None:
        """See `CellPort`."""
        self.motions.cancel()

    def guide(self, guide: Guide) -> None:
        """See `CellPort`."""
        self.controller.wait_for_command()
        self.robot.guide(guide)
        self._observer.command_state(STATE_OF_GUIDE[guide])

    def hold(self, *, held: bool) -> None:
        """See `CellPort`."""
        if not held and self.permission.suspended:
            self.controller.command(taken=True)
        self.controller.request('pause' if held else 'resume')

    def output_changed(self, change: OutputChange) -> None:
        """See `CellPort`."""
        self.reporter.report_if_due()
        self._observer.outputs_changed(change)

    def switch_at_target(self, change: OutputChange) -> None:
        """See `CellPort`."""
        motions = self.program.motions
        if not motions:
            self.program.switch_output(change)
            return
        warm_up(self._robot)
        self.switching.switch_at_target(motions[-1], change)
        if motions[-1] not in self.program.motions:  # it has ended meanwhile
            self._switch_left(motions[-1], ok=True)

    def _switch_left(self, command: MotionCommand, *, ok: bool) -> None:
        left = self.switching.left(command)
        for change in left if ok else ():
            self.program.switch_output(change)

    def printed(self, text: str, line: int) -> None:
        """See `CellPort`."""
        self._observer.printed(text, line)

    def started(self) -> None:
        """See `CellPort`."""
        if self._unsafe:
            self.make_outputs_safe()
        self.controller.command(taken=True)
        self._report_well()
        try:
            self.permission.check()
        except RobotsError as error:  # not asked by `run`, but by an editor
            self.program.fail(str(error))

    def line_reached(self, line: int) -> None:
        """See `CellPort`."""
        self.reporter.line_changed()
        self._observer.line_reached(line)

    def held_changed(self) -> None:
        """See `CellPort`."""
        self.reporter.report()
        self._observer.held_changed()

    def interrupted(self) -> None:
        """See `CellPort`; motions that continue to their ends switch their outputs until then."""
        self._unsafe = True
        if self.program.stopping or not self.motions.going_on:
            self.make_outputs_safe()

    def ended(self, error: ProgramError | None) -> None:
        """See `CellPort`."""
        try:
            self.controller.command(taken=False)
            self._observer.ended(error)
            self.reporter.report()
        finally:  # even if the middleware was shut down meanwhile: the cell waits for it
            self.clock.program_ended()
