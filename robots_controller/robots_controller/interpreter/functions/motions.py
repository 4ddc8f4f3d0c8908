"""Motions: how a program moves its robot."""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Final

import numpy as np

from robots_controller.degrees import in_degrees
from robots_controller.interpreter.functions.common_arguments import JOINTS, POSE
from robots_controller.interpreter.functions.lua_function import Argument, LuaFunction
from robots_controller.interpreter.functions.poses import moved
from robots_controller.interpreter.functions.run_context import Handlers, RunContext
from robots_controller.interpreter.lua_arguments import Arguments
from robots_controller.interpreter.lua_sandbox import LuaCallError, Waiting
from robots_controller.interpreter.motion_options import Condition
from robots_controller.program.guided_motion import GuidedMotion
from robots_controller.program.motion_command import MotionCommand
from robots_core.errors import RobotsError
from robots_core.pose import Pose
from robots_core.validation import Array, read_only
from robots_planning.motion_kinds import KIND_OF_FUNCTION

MOTIONS: Final = (
    LuaFunction(
        'ptpCartesianSpace',
        POSE,
        'Moves the tool on a straight line to a pose; returns when the robot stands there.',
    ),
    LuaFunction(
        'ptpJointSpaceAngles',
        (JOINTS,),
        'Moves all axes together to joint angles; returns when the robot stands there.',
    ),
    LuaFunction(
        'ptpJointSpacePosition',
        POSE,
        'Moves all axes together to a pose; returns when the robot stands there.',
    ),
    LuaFunction(
        'circCartesianSpace',
        (
            Argument('via', 'pose', '', 'pose on the arc: its position is passed'),
            Argument('target', 'pose', '', 'pose at the end of the arc'),
        ),
        'Moves the tool on an arc through `via` to `target`, each {x, y, z, phi1, phi2, phi3}.',
    ),
    LuaFunction(
        'splineCartesianSpace',
        (Argument('pose', 'pose', '', 'pose on the curve', repeated=True),),
        'Moves the tool on a smooth curve through poses, each {x, y, z, phi1, phi2, phi3}.',
    ),
    LuaFunction(
        'linearRelative',
        (
            *(Argument(axis, 'number', 'm', f'way along {axis}') for axis in 'xyz'),
            *(Argument(f'phi{i}', 'number', 'deg', f'turn by orientation angle {i}') for i in (1, 2, 3)),
            Argument('frame', 'frame', '', "'base' (default) or 'tool': whose axes are meant", optional=True),
        ),
        'Moves the tool on a straight line, relative to the last target.',
    ),
    LuaFunction(
        'ptpJointSpaceAnglesRelative',
        (
            Argument(
                'q', 'number', 'deg (m)', 'way of the joint, in metres for a sliding axis', per_axis=True
            ),
        ),
        'Moves all axes together by joint angles, relative to the last target.',
    ),
)
"""Motions."""


@dataclass
class _Handler:
    """A handler that runs: whether the robot was held before it, and motions to be commanded anew."""

    held: bool
    interrupted: list[MotionCommand] = field(default_factory=list)


class Motions:
    """Commands motions, waits for them, and holds them for handlers of inputs.

    Args:
        run: The run.
        guided_motion: Gives the robot back before a motion.
        motion_ended: A motion that the program waited for has ended well.
    """

    def __init__(
        self, run: RunContext, guided_motion: GuidedMotion, motion_ended: Callable[[], None]
    ) -> None:
        self._run, self._state = run, run.state
        self._guided_motion = guided_motion
        self._motion_ended = motion_ended
        self.error: RobotsError | None = None
        """Why the last motion that failed did."""
        self.error_text = ''
        self._handlers: list[_Handler] = []
        self._found: Pose | None = None  # where it came true
        self.handlers: Handlers = {
            'ptpCartesianSpace': self._to_pose('ptpCartesianSpace'),
            'ptpJointSpaceAngles': self._to_joints,
            'ptpJointSpacePosition': self._to_pose('ptpJointSpacePosition'),
            'circCartesianSpace': self._along('circCartesianSpace'),
            'splineCartesianSpace': self._along('splineCartesianSpace'),
            'linearRelative': self._linear_relative,
            'ptpJointSpaceAnglesRelative': self._joints_relative,
        }

    def _to_pose(self, function: str) -> Callable[[Arguments], Waiting]:
        def move(arguments: Arguments) -> Waiting:
            return self._move(function, arguments, pose=self._run.view.pose(arguments.values))

        return move

    def _to_joints(self, arguments: Arguments) -> Waiting:
        q = read_only(arguments.values)
        return self._move('ptpJointSpaceAngles', arguments, q=q)

    def _along(self, function: str) -> Callable[[Arguments], Waiting]:
        def move(arguments: Arguments) -> Waiting:
            path = tuple(self._run.view.pose(values) for values in arguments.values)
            return self._move(function, arguments, pose=path[-1], path=path)

        return move

    def _linear_relative(self, arguments: Arguments) -> Waiting:
        if not self._run.target.known:
            yield from self.standstill()
        way, frame = self._run.view.pose(arguments.values[:6]), arguments.values[6]
        start = self._run.target.pose()
        return (yield from self._move('linearRelative', arguments, pose=moved(start, way, frame)))

    def _joints_relative(self, arguments: Arguments) -> Waiting:
        if not self._run.target.in_joints:
            yield from self.standstill()
        q = read_only(self._run.target.joints() + np.array(arguments.values))
        return (yield from self._move('ptpJointSpaceAnglesRelative', arguments, q=q))

    def _move(
        self,
        function: str,
        arguments: Arguments,
        *,
        q: Array | None = None,
        pose: Pose | None = None,
        path: tuple[Pose, ...] = (),
    ) -> Waiting:
        kind = KIND_OF_FUNCTION[function]
        blend, before = arguments.options.blend, self._state.motions
        chained = bool(before and before[-1].blend)
        if blend:
            self._run.change(
                blend_zone=blend if kind.cartesian else 0.0, joint_blend_zone=0.0 if kind.cartesian else blend
            )
        elif not chained and 'blend_zone' in self._run.settings:
            self._run.change(blend_zone=0.0, joint_blend_zone=0.0)
        command = MotionCommand(
            kind,
            self._run.line,
            function,
            q=q,
            pose=pose,
            path=path,
            settings=MappingProxyType(dict(self._run.settings)),
            blend=blend,
            switches=arguments.options.switches,
        )
        if self._handlers and self._state.braked:
            self._handlers[-1].interrupted += self._abort_motions()
        yield from self._guided_motion.interrupt()
        self._raise_failure(None)
        self._send(command)
        self._run.target.set(q, pose)
        if chained and not blend:
            # Switched off before, blending would end the chain before its last motion.
            self._run.cell.flush()
        if not blend:
            yield from self.standstill(command, arguments.options.until)
            self._motion_ended()
        return None

    def until(
        self, condition: Condition, name: str, arguments: Arguments
    ) -> Generator[None, None, Pose | None]:
        """Make a motion until a condition holds.

        Args:
            condition: Holds not yet.
            name: The motion's function.
            arguments: Its arguments.

        Returns:
            Where the tool was when it came true, seen from the base; None if it did not.
        """
        self._found = None
        options = replace(arguments.options, until=condition)
        motion = self.handlers[name](replace(arguments, options=options))
        assert isinstance(motion, Generator)
        yield from motion
        return self._found

    def tool_pose(self) -> Pose:
        """Where the tool is, seen from the base."""
        return self._run.target.seen(self._run.view.flange(self._run.view.position()))

    def _send(self, command: MotionCommand) -> None:
        try:
            self._state.command_motion(command, self._reference_pose(command))
            try:
                self._run.cell.command(command)
            except BaseException:
                self._state.finish_motion()
                raise
        except RobotsError as error:
            raise self._failure(command, error, command) from error

    def _reference_pose(self, command: MotionCommand) -> Pose | None:
        if command.q is None:
            return command.pose
        try:
            return self._run.target.seen(self._run.view.flange(command.q))
        except RobotsError:  # a cell without kinematics; the motion itself needs none
            return None

    def standstill(
        self, command: MotionCommand | None = None, condition: Condition | None = None
    ) -> Generator[None, None, None]:
        """Wait until the robot stands at its last target.

        Raises:
            LuaCallError: a motion has failed.
            ProgramStopped: the program shall stop.
        """
        motions = self._state.motions
        if motions and motions[-1].blend:
            self._run.cell.flush()
        met, period = (condition.met, condition.period) if condition else (lambda: False, None)

        def ready() -> bool:
            return not self._state.motions or self._state.braked or met()

        while not (yield from self._state.waiting(ready, period)):
            pass
        if condition is not None and self._state.motions:
            self._found = self.tool_pose()
            self._abort_motions()
        self._raise_failure(command)

    def waiting(
        self, ready: Callable[[], bool], duration: float | None = None
    ) -> Generator[None, None, bool]:
        """Wait for a condition; see `ProgramState.waiting`."""
        return self._state.waiting(ready, duration)

    def _raise_failure(self, current: MotionCommand | None) -> None:
        failure = self._state.take_motion_error()
        if failure is not None:
            raise self._failure(*failure, current) from failure[1]

    def _failure(
        self, command: MotionCommand, error: RobotsError, current: MotionCommand | None
    ) -> LuaCallError:
        self._run.target.forget()
        where = command.function if command is current else f'{command.function} of line {command.line}'
        self.error, self.error_text = error, f'{where}: {in_degrees(error.message)}'
        return LuaCallError(self.error_text)

    def begin_handler(self) -> int:
        """Begin the handler that is due; the motion under way is held. Returns the handler's number."""
        self._handlers.append(_Handler(self._state.braked))
        self._state.set_braked(braked=bool(self._state.motions))
        return self._state.interrupts.begin()

    def handled(self, *, abort: bool) -> None:
        """The handler that began last has ended: the motion under way goes on, or ends there."""
        handler = self._handlers.pop()
        if self._state.braked and abort:
            self._abort_motions()
        self._state.interrupts.end()
        if handler.held and handler.interrupted and not abort:
            self._handlers[-1].interrupted += handler.interrupted  # held for the handler outside too
        elif not abort:
            for command in handler.interrupted:  # the handler moved the robot: from where it stands now
                self._send(command)
            if handler.interrupted:
                self._run.cell.flush()  # what is held for a blend: the program waits for these already
        if not self._handlers or abort:
            self._guided_motion.handled(abort=abort)
        self._state.set_braked(braked=handler.held and bool(self._state.motions))

    def _abort_motions(self) -> list[MotionCommand]:
        motions = list(self._state.motions)
        if motions:
            self._run.cell.abort()
            self._state.wait_for_standstill()
            self._state.take_motion_error()
            self._run.target.forget()
        self._state.set_braked(braked=False)
        return motions
