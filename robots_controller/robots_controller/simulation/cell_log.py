"""CellLog: what happens in a simulated cell, as events for the run and as messages for the bag."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

from robots_controller.control.controller import MotionResult
from robots_controller.control.streamed_reference import StreamPoint
from robots_controller.interpreter.lua_program import LuaProgram
from robots_controller.io.io_image import Channel, IoImage
from robots_controller.program.motion_command import MotionCommand, OutputChange
from robots_controller.program.program_position import TellingPace, told_place
from robots_controller.program.program_state import RunState
from robots_controller.simulation import ros_messages as ros
from robots_controller.simulation.collision_watch import Clearness
from robots_controller.simulation.cost import Cost
from robots_controller.simulation.events import (
    CommandStateChanged,
    InputChanged,
    LineReached,
    OutputChanged,
    OverrideChanged,
    ProgramStateChanged,
    TextPrinted,
)
from robots_controller.simulation.guide_recording import GuidingMessage
from robots_controller.simulation.recording import Recording
from robots_controller.simulation.simulated_bag import START, SimulatedBag
from robots_controller.simulation.simulated_clock import SimulatedClock
from robots_controller.simulation.simulated_motions import MotionEnd, motion_settings
from robots_core.errors import RobotsError
from robots_core.motion_result import MotionResult
from robots_planning.command_planner import PlannedCommands
from robots_planning.motion_settings import MotionSettings, settings_as_text

LONGEST_TEXT: Final = 10_000  # characters of a print; as lua_program_node
STATUS_TYPE: Final = 'diagnostic_msgs/msg/DiagnosticStatus'


class CellLog:
    """Called by whoever has the turn, see `SimulatedClock`.

    Args:
        recording: Takes the events.
        bag: Takes the messages; None for none.
        clock: Tells the time.
        cost: Takes what writing costs.
        robot: The robot's name.
        joints: Names of its axes.
    """

    def __init__(
        self,
        recording: Recording,
        bag: SimulatedBag | None,
        clock: SimulatedClock,
        cost: Cost,
        *,
        robot: str,
        joints: tuple[str, ...],
    ) -> None:
        self._events = recording.events
        self._bag, self._clock, self._cost = bag, clock, cost
        self._robot, self._joints = robot, joints
        self._status_due = False
        self._pace = TellingPace()
        self._motion: dict[str, object] = {}
        self._progress = -1.0
        self._last_stamp = 0
        self._settings: MotionSettings | None = None

    def begin(
        self, program: LuaProgram, labels: Mapping[str, Sequence[str]], inputs: Mapping[str, int]
    ) -> None:
        """Tell what is so at the start.

        Args:
            program: The program.
            labels: Names of inputs and outputs, by image; in a live cell they are parameters of a node.
            inputs: Images of the inputs that the PLC sets, and how many inputs it tells of each.
        """
        if self._bag is not None and labels:
            names = {f'{image.removesuffix("s")}_names': names for image, names in labels.items()}
            event = ros.string_parameters(START + self._clock.nanoseconds, '/lua_program_node', names)
            self._write('/parameter_events', 'rcl_interfaces/msg/ParameterEvent', event)
        if self._bag is not None:
            status = ros.diagnostic_status(
                'forced inputs', 'no input is forced', '/lua_program_node', ros.OK, {}
            )
            self._write('forced_inputs', STATUS_TYPE, status)
        for image in ('digital_outputs', 'analog_outputs'):
            self.image(program.io, image)
        self.command_state(program.command_state.value)
        self.finished(done=False)
        for image, size in inputs.items():
            self.image(program.io, image, size=size)
        for image in ('digital_inputs', 'analog_inputs'):
            self.image(program.io, image, 'lua_program_node/')

    # -- the program ------------------------------------------------------------------------------

    def state(self, program: LuaProgram, state: RunState, error: str = '') -> None:
        """The program's run state has changed."""
        self._events.append(ProgramStateChanged(self._clock.now(), state.value))
        self._tell_status(program, state, error)

    def line(self, program: LuaProgram, line: int) -> None:
        """The program is on another line."""
        self._events.append(LineReached(self._clock.now(), line))
        self._status_due = True
        self.status_in_time(program)

    def status_in_time(self, program: LuaProgram) -> None:
        """Tell where the program is, if that has changed and was not told just now."""
        if self._status_due and self._pace.passes(self._clock.now()):
            self._tell_status(program, program.run_state)

    @property
    def status_due(self) -> bool:
        """The program is on a line that was not told yet."""
        return self._status_due

    def status(self, program: LuaProgram, nanoseconds: int | None = None) -> None:
        """Tell where the program is, if that has changed; at that time since the start, or now."""
        if self._status_due:
            self._tell_status(program, program.run_state, nanoseconds=nanoseconds)

    def commanded(self, program: LuaProgram, command: MotionCommand) -> str:
        """Tell of a motion, and of which line of which file it is; returns its id."""
        # The stamp is the id: unique even while time stands still.
        stamp = self._last_stamp = max(START + self._clock.nanoseconds, self._last_stamp + 1)
        id_ = ros.id_of(stamp)
        self._motion = {'motion': id_, 'motion_file': program.line_file, 'motion_line': command.line}
        self._tell_status(program, program.run_state, nanoseconds=stamp - START)
        self.command_state(program.command_state.value)
        self._command(stamp, command)
        return id_

    def _tell_status(
        self, program: LuaProgram, state: RunState, error: str = '', nanoseconds: int | None = None
    ) -> None:
        self._status_due = False
        if self._bag is None:
            return
        words = error or f'{program.file}: {state}'
        status = ros.diagnostic_status(
            'program',
            words,
            self._robot,
            ros.ERROR if error else ros.OK,
            told_place(program, state, error) | self._motion,
        )
        self._write('program_status', STATUS_TYPE, status, nanoseconds)

    def printed(self, text: str, line: int) -> None:
        """The program printed."""
        if len(text) > LONGEST_TEXT:
            text = f'{text[:LONGEST_TEXT]}... ({len(text)} characters)'
        self._events.append(TextPrinted(self._clock.now(), line, text))
        if self._bag is not None:
            log = ros.log(START + self._clock.nanoseconds, 'lua_program_node.print', text)
            self._write('/rosout', 'rcl_interfaces/msg/Log', log)

    def command_state(self, state: str) -> None:
        """The robot is commanded to do something else."""
        self._events.append(CommandStateChanged(self._clock.now(), state))
        if self._bag is not None:
            self._write('command_state', 'std_msgs/msg/String', ros.text(state))

    def override(self, value: float) -> None:
        """The program scales the speed."""
        self._events.append(OverrideChanged(self._clock.now(), value))
        if self._bag is not None:
            self._write('override', 'std_msgs/msg/Float64', ros.message('std_msgs/msg/Float64', value))

    # -- inputs and outputs -----------------------------------------------------------------------

    def output(self, io: IoImage, change: OutputChange) -> None:
        """The program, or the path for it, has switched an output."""
        event = OutputChanged(self._clock.now(), change.kind, change.index, change.value, change.line)
        self._events.append(event)
        self.image(io, f'{change.kind}_outputs')

    def input(self, io: IoImage, channel: Channel, value: float, size: int) -> None:
        """The PLC, which tells so many inputs, has set one."""
        self._events.append(InputChanged(self._clock.now(), channel.kind, channel.index, value))
        self.image(io, channel.image, size=size)
        self.image(io, channel.image, 'lua_program_node/')

    def image(self, io: IoImage, image: str, prefix: str = '', *, size: int | None = None) -> None:
        """Tell an image, whole or its first values."""
        if self._bag is None:
            return
        kind, values = image.split('_', maxsplit=1)[0], io.numbers(image)[:size]
        # The node names the channels of what it publishes; a PLC does not.
        own = bool(prefix) or image.endswith('outputs')
        label = f'{image.removesuffix("s")}.1..{values.size}' if own else ''
        type_name = f'std_msgs/msg/{"UInt8" if kind == "digital" else "Float64"}MultiArray'
        self._write(prefix + image, type_name, ros.image(kind, label, values))

    # -- motions ----------------------------------------------------------------------------------

    def _command(self, nanoseconds: int, command: MotionCommand) -> None:
        if self._bag is None:
            return
        # Commands of one instant have stamps of their own: each comes after its settings by these.
        since_start = nanoseconds - START
        self._tell_settings(since_start, command)
        message: Any
        if command.q is not None:
            message = ros.joint_state(nanoseconds, self._joints, command.q)
        elif command.path:
            message = ros.path(nanoseconds, command.path)
        else:
            assert command.pose is not None
            message = ros.pose_stamped(nanoseconds, command.pose)
        self._write(command.kind.topic, command.kind.message_type, message, since_start)

    def _tell_settings(self, nanoseconds: int, command: MotionCommand) -> None:
        try:
            settings = motion_settings(command.settings)
        except RobotsError:  # refused: the motion's result says why
            return
        if settings != self._settings:
            self._settings = settings
            status = ros.diagnostic_status(
                'motion settings', '', self._robot, ros.OK, settings_as_text(settings)
            )
            self._write('motion_settings', STATUS_TYPE, status, nanoseconds)

    def planned(self, planned: PlannedCommands) -> None:
        """A plan goes to the controller."""
        if self._bag is None:
            return
        seconds, nanoseconds = planned.orders[-1].id.split('.')
        stamp = int(seconds) * ros.NANOSECONDS + int(nanoseconds)
        self.finished(done=False)
        message = ros.planned_trajectory(stamp, self._joints, planned.motion.trajectory)
        self._write('joint_trajectory', 'trajectory_msgs/msg/JointTrajectory', message)

    def result(self, end: MotionEnd | MotionResult) -> None:
        """A command has its result, or a stream of references has ended."""
        if self._bag is None:
            return
        ended = ros.id_of(START + self._clock.nanoseconds)
        values: Mapping[str, object] = {'id': end.id, **end.details, 'ended': ended}
        level = ros.OK if end.ok else ros.ERROR
        status = ros.diagnostic_status('motion', end.message, self._robot, level, values)
        self._write('motion_result', STATUS_TYPE, status)

    def guided(self, message: GuidingMessage, type_name: str) -> None:
        """What guides the robot was heard."""
        if self._bag is not None:
            before = self._cost.switch('recording')
            self._bag.write_serialized(message.topic, type_name, self._clock.nanoseconds, message.data)
            self._cost.switch(before)

    def streamed(self, point: StreamPoint, period: float) -> str:
        """A point, `period` (s) before the next one, goes to the controller; returns its id."""
        stamp = START + self._clock.nanoseconds
        if self._bag is not None:
            after = round(ros.NANOSECONDS * period)
            row = (after, point.position, point.velocity, point.acceleration)
            message = ros.joint_trajectory(stamp, self._joints, [row])
            self._write('joint_trajectory', 'trajectory_msgs/msg/JointTrajectory', message)
        return ros.id_of(stamp)

    def finished(self, *, done: bool) -> None:
        """The planner has sent a motion, or all have reached their targets."""
        if self._bag is not None:
            self._write('finished', 'std_msgs/msg/Bool', ros.message('std_msgs/msg/Bool', done))

    def progress(self, progress: float, *, due: bool) -> None:
        """Done part of the current path; told when it is due, and always at its ends."""
        if self._bag is None or progress == self._progress:
            return
        if due or progress in (0.0, 1.0):
            self._progress = progress
            self._bag.progress(self._clock.nanoseconds, progress)

    def clearness(self, seen: Clearness) -> None:
        """Tell how close the robot is to something."""
        if self._bag is not None:
            level = ros.ERROR if seen.near else ros.OK
            status = ros.diagnostic_status('collision', seen.words, self._robot, level, seen.values)
            self._write(
                'min_distance', 'std_msgs/msg/Float64', ros.message('std_msgs/msg/Float64', seen.distance)
            )
            self._write('collision_status', STATUS_TYPE, status)

    def _write(self, topic: str, type_name: str, message: Any, nanoseconds: int | None = None) -> None:
        assert self._bag is not None
        before = self._cost.switch('recording')
        at = self._clock.nanoseconds if nanoseconds is None else nanoseconds
        self._bag.write(topic, type_name, at, message)
        self._cost.switch(before)
