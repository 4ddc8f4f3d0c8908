"""CellLog: what happens in a simulated cell, as events for the run and as messages for the bag."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from robots_controller.cell.guide_recording import GuidingMessage
from robots_controller.control.streamed_reference import StreamPoint
from robots_controller.io.io_image import Channel, IoImage, forced_status
from robots_controller.program.motions.motion_command import MotionCommand, OutputChange
from robots_controller.program.run_state import RunState
from robots_controller.simulation.cell_parts import CellParts
from robots_controller.simulation.cost import Cost
from robots_controller.simulation.record import ros_messages as ros
from robots_controller.simulation.record.events import (
    CommandStateChanged,
    Event,
    InputChanged,
    LineReached,
    OutputChanged,
    OverrideChanged,
    ProgramStateChanged,
    TextPrinted,
)
from robots_controller.simulation.record.ros_messages import BUILD
from robots_controller.simulation.record.simulated_bag import SimulatedBag
from robots_controller.simulation.simulated_clock import START, SimulatedClock
from robots_controller.simulation.simulation_run import SimulatedMotion
from robots_core.base_frames import BASE_FRAME
from robots_core.blocks.following.guide import Guide
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.cell_interface.operating_modes import Commander, OperatingMode
from robots_core.errors import ProgramError, RobotsError
from robots_core.pose import Pose
from robots_core.status import Level, Status
from robots_core.validation import Array
from robots_planning.commands.motion_plan import MotionPlan
from robots_planning.motion_settings import MotionSettings, settings_status
from robots_planning.robot_command_state import RobotCommandState


class MotionRecords:
    """What became of each motion command of a program; all times in s since its start."""

    def __init__(self) -> None:
        self._motions: dict[str, SimulatedMotion] = {}
        self._open: set[str] = set()

    @property
    def all(self) -> tuple[SimulatedMotion, ...]:
        """In the order of their commands."""
        return tuple(self._motions.values())

    @property
    def any_open(self) -> bool:
        """A command has no result yet."""
        return bool(self._open)

    def commanded(self, id_: str, command: MotionCommand, file: str, now: float) -> None:
        """A motion of a program or subprogram was commanded."""
        self._motions[id_] = SimulatedMotion(id_, command, file, now)
        self._open.add(id_)

    def configured(self, id_: str, settings: MotionSettings) -> None:
        """The planner has these settings for a motion."""
        self._change(id_, settings=settings)

    def refused(self, command: MotionCommand, error: RobotsError, now: float) -> None:
        """A command was refused before it had an id."""
        id_ = f'refused {len(self._motions)}'
        self.commanded(id_, command, '', now)
        self.ended(MotionResult.refused(id_, error), now)

    def planned(self, plan: MotionPlan) -> None:
        """A chain of commands was planned.

        Some of them may be in an earlier plan too, which this one carries on.
        """
        ends = plan.ends
        for id_, (start, end) in zip(ends, pairwise((0.0, *ends.values())), strict=True):
            places = {'start_on_plan': start, 'end_on_plan': end}
            self._change(id_, plan=plan.motion, chain=tuple(ends), started=math.nan, **places)

    def started(self, id_: str, now: float) -> None:
        """The controller follows the plan with the id of this command."""
        first = self._motions[id_]
        if math.isnan(first.started):
            for member in first.chain:
                if self._motions[member].plan is first.plan:
                    self._change(member, started=now)

    def ended(self, result: MotionResult, now: float) -> None:
        """A motion has its result."""
        if result.id in self._open:
            self._open.remove(result.id)
            self._change(result.id, ended=now, ok=result.ok, message=result.message)

    def _change(self, id_: str, **changes: Any) -> None:
        self._motions[id_] = replace(self._motions[id_], **changes)


class CellLog:
    """Called by the thread that has the turn, see `SimulatedClock`."""

    def __init__(self, parts: CellParts, bag: SimulatedBag | None, clock: SimulatedClock, cost: Cost) -> None:
        self.events: list[Event] = []
        """What has happened besides motion, in the order of time."""
        self.motions = MotionRecords()
        """What became of each motion."""
        self._bag, self._clock, self._cost = bag, clock, cost
        self._labels, self._robot = parts.cell_io.labels, parts.robot_name
        self._joints = parts.robot.axes_data.names
        self._state: RunState | None = None
        self._latest = 0  # ns, of the messages that were written
        self._last_command = -1  # ns
        self._settings: MotionSettings | None = None
        self.io: IoImage | None = None
        """The program's inputs and outputs."""
        self.on_output: Callable[[str, float], None] = lambda *_: None
        """Gets the name and the value of each output that changes."""
        self.given_up: ProgramError | None = None
        """Why the cell stopped the program, if it did: the program has failed."""

    def begin(
        self,
        io: IoImage,
        inputs: Mapping[str, int],
        mode: OperatingMode,
    ) -> None:
        """Write the state at the start.

        Args:
            io: The program's inputs and outputs.
            inputs: Images of the inputs that the PLC sets, and the number of its inputs in each.
            mode: The operating mode.
        """
        self.io = io
        if self._bag is not None and self._labels:
            # In a live cell they are parameters of a node.
            names = {f'{image.removesuffix("s")}_names': names for image, names in self._labels.items()}
            event = ros.string_parameters(self._clock.stamp, '/lua_program_node', names)
            self._write('/parameter_events', event)
        self.report('forced_inputs', forced_status({}), owner='/lua_program_node')
        for image in ('digital_outputs', 'analog_outputs'):
            self.image(image)
        self.command_state(RobotCommandState.IDLE)
        self.value('guide', Guide.NONE.value)
        self.value('operating_mode', mode.value)
        self.value('commander', Commander.NOBODY.value)
        self.value('finished', False)
        for image, size in inputs.items():
            self.image(image, size=size)
        for image in ('digital_inputs', 'analog_inputs'):
            self.image(image, 'lua_program_node/')

    # -- the program ------------------------------------------------------------------------------

    def status(self, state: RunState, status: Status) -> None:
        """See `ProgramObserver`."""
        if state is RunState.STOPPED and self.given_up is not None:
            state, error = RunState.FAILED, str(self.given_up)
            values = {**status.values, 'state': state.value, 'error': error}
            status = replace(status, text=error, level=Level.ERROR, values=values)
        if state is not self._state:
            self._state = state
            self.events.append(ProgramStateChanged(self._clock.elapsed, state.value))
        self.report('program_status', status)

    def line_reached(self, line: int) -> None:
        """See `ProgramObserver`."""
        self.events.append(LineReached(self._clock.elapsed, line))

    def printed(self, text: str, line: int) -> None:
        """See `ProgramObserver`."""
        self.events.append(TextPrinted(self._clock.elapsed, line, text))
        if self._bag is not None:
            self._write('/rosout', ros.log(self._clock.stamp, 'lua_program_node.print', text))

    def command_state(self, state: RobotCommandState) -> None:
        """See `ProgramObserver`."""
        self.events.append(CommandStateChanged(self._clock.elapsed, state.value))
        self.value('command_state', state.value)

    def motion_sent(self, id_: str, command: MotionCommand, file: str) -> None:
        """See `ProgramObserver`."""
        self.motions.commanded(id_, command, file, self._clock.elapsed)

    def motion_ended(self, id_: str, command: MotionCommand, error: RobotsError | None) -> None:
        """See `ProgramObserver`."""
        if not id_ and error is not None:
            self.motions.refused(command, error, self._clock.elapsed)

    def held_changed(self) -> None:
        """See `ProgramObserver`; a simulation shows no editor."""

    def ended(self, error: ProgramError | None) -> None:
        """See `ProgramObserver`; the state of the program says it."""

    def override(self, value: float) -> None:
        """The program scales the speed."""
        self.events.append(OverrideChanged(self._clock.elapsed, value))
        self.value('override', value)

    # -- inputs and outputs -----------------------------------------------------------------------

    def outputs_changed(self, change: OutputChange) -> None:
        """See `ProgramObserver`."""
        event = OutputChanged(self._clock.elapsed, change.kind, change.index, change.value, change.line)
        self.events.append(event)
        self.image(f'{change.kind}_outputs')
        self.on_output(f'{change.kind}_output.{change.index}', change.value)

    def input(self, channel: Channel, value: float, size: int) -> None:
        """The PLC, which publishes so many inputs, has set one."""
        self.events.append(InputChanged(self._clock.elapsed, channel.kind, channel.index, value))
        self.image(channel.image, size=size)
        self.image(channel.image, 'lua_program_node/')

    def image(self, image: str, prefix: str = '', *, size: int | None = None) -> None:
        """Write an image, whole or its first values."""
        if self._bag is None:
            return
        assert self.io is not None
        # The node names the channels of what it publishes; a PLC does not.
        own = bool(prefix) or image.endswith('outputs')
        self._write(prefix + image, BUILD.image(image, self.io.numbers(image)[:size], labelled=own))

    # -- motions ----------------------------------------------------------------------------------

    def settings(self, settings: MotionSettings) -> None:
        """The modal settings were set."""
        if self._bag is not None and settings != self._settings:
            self._settings = settings
            # After the command before, and not after its own.
            self._latest = max(self._latest, self._last_command + 1)
            self.report('motion_settings', settings_status(settings))

    def command(self, id_: str, command: MotionCommand, settings: MotionSettings) -> None:
        """A motion was commanded; its stamp is its id."""
        self.motions.configured(id_, settings)
        if self._bag is None:
            return
        stamp = _nanoseconds(id_)
        self.settings(settings)
        # Commands of one instant have stamps of their own.
        self._last_command = stamp - START
        self._write(command.kind.topic, command.message(BUILD, stamp, self._joints), stamp - START)

    def planned(self, plan: MotionPlan) -> None:
        """A plan goes to the controller."""
        self.motions.planned(plan)
        if self._bag is not None:
            self.report('motion_plan', plan.status)
            times, rows = plan.trajectory.points_of_message(plan.join_time)
            points = zip(times.tolist(), *rows, strict=True)
            message = BUILD.joint_trajectory(_nanoseconds(plan.id), self._joints, points, BASE_FRAME)
            self._write('joint_trajectory', message)

    def guided(self, message: GuidingMessage, type_name: str) -> None:
        """A message that guides the robot has arrived."""
        if self._bag is not None:
            before = self._cost.switch('recording')
            data = message.data or _serialized(message)
            self._bag.write_serialized(message.topic, type_name, self._clock.nanoseconds, data)
            self._cost.switch(before)

    def streamed(self, point: StreamPoint, sent: int, period: int) -> str:
        """A point was sent to the controller at `sent`, `period` before the next one (ns); returns its id."""
        if self._bag is not None:
            before = self._cost.switch('recording')
            row = (period, point.position, point.velocity, point.acceleration)
            message = BUILD.joint_trajectory(sent, self._joints, [row])
            self._bag.write('joint_trajectory', sent - START, message)
            self._cost.switch(before)
        return ros.id_of(sent)

    def wrench(self, wrench: Array) -> None:
        """A force/torque sensor has measured a wrench (6,), N and N m, on the tool."""
        if self._bag is not None:
            self._bag.add_row('measured_wrench', self._clock.nanoseconds, wrench)

    # -- the rest ---------------------------------------------------------------------------------

    def progress(self, progress: float) -> None:
        """Done part of the current path."""
        if self._bag is not None:
            self._bag.add_row('motion_progress', self._clock.nanoseconds, progress)

    def value(self, topic: str, value: bool | float | str) -> None:  # noqa: FBT001
        """Write a state of the cell that is one value."""
        if self._bag is not None:
            self._write(topic, BUILD.value(value))

    def report(self, topic: str, status: Status, owner: str = '') -> None:
        """Write a status of the robot, or of another owner."""
        if self._bag is not None:
            self._write(topic, BUILD.status(status, owner or self._robot))

    def record(self, messages: Iterable[tuple[str, Any]]) -> None:
        """Write messages, each with its topic."""
        if self._bag is not None:
            for topic, message in messages:
                self._write(topic, message)

    def _write(self, topic: str, message: Any, nanoseconds: int = 0) -> None:
        assert self._bag is not None
        before = self._cost.switch('recording')
        # Commands of one instant have stamps of their own: what follows them comes after them.
        self._latest = max(self._latest, self._clock.nanoseconds, nanoseconds)
        self._bag.write(topic, self._latest, message)
        self._cost.switch(before)


def _serialized(message: GuidingMessage) -> memoryview:
    if isinstance(message.value, Pose):
        return ros.serialized(BUILD.pose_stamped(message.valid, message.value))
    assert isinstance(message.value, np.ndarray)
    return ros.serialized(BUILD.twist_stamped(message.valid, message.value))


def _nanoseconds(id_: str) -> int:
    return int(id_.replace('.', ''))
