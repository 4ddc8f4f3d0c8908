"""Motions: how a program moves its robot."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from robots_controller.degrees import for_program
from robots_controller.interpreter import argument_kinds as kinds
from robots_controller.interpreter.functions.common_arguments import JOINTS, POSE, WHOSE_AXES, six_numbers
from robots_controller.interpreter.functions.lua_function import Argument, lua_function
from robots_controller.interpreter.functions.poses import moved
from robots_controller.interpreter.functions.run_context import Family, RunContext
from robots_controller.interpreter.lua_arguments import Arguments
from robots_controller.interpreter.lua_sandbox import LuaCallError, Waiting
from robots_controller.interpreter.motion_options import Condition, MotionOptions
from robots_controller.program.motions.motion_command import MotionCommand
from robots_core.errors import RobotsError
from robots_core.pose import Pose
from robots_core.validation import Array, read_only
from robots_planning.motion_kinds import KIND_OF_FUNCTION


@dataclass
class _Handler:
    """A handler that runs: whether the robot was held before it, and motions to be commanded again."""

    held: bool
    interrupted: list[MotionCommand] = field(default_factory=list)


class Motions(Family):
    """Commands motions, waits for them, and holds them for handlers of inputs.

    Args:
        motion_ended: A motion that the program waited for has ended well.
    """

    def __init__(self, run: RunContext, motion_ended: Callable[[], None]) -> None:
        super().__init__(run)
        self._state, self._motion_ended = run.state, motion_ended
        self.waiting = run.state.waiting
        self.error: RobotsError | None = None
        """Why the last motion that failed did."""
        self.error_text = ''
        self._handlers: list[_Handler] = []
        self._found: Pose | None = None  # where it came true

    @lua_function(*POSE)
    def ptpCartesianSpace(self, *values: float, options: MotionOptions) -> Waiting:
        """Moves the tool on a straight line to a pose; returns when the robot stands there."""
        return self._move('ptpCartesianSpace', options, pose=self._run.view.pose(values))

    @lua_function(JOINTS)
    def ptpJointSpaceAngles(self, *q: float, options: MotionOptions) -> Waiting:
        """Moves all axes together to joint angles; returns when the robot stands there."""
        return self._move('ptpJointSpaceAngles', options, q=read_only(q))

    @lua_function(*POSE)
    def ptpJointSpacePosition(self, *values: float, options: MotionOptions) -> Waiting:
        """Moves all axes together to a pose; returns when the robot stands there."""
        return self._move('ptpJointSpacePosition', options, pose=self._run.view.pose(values))

    @lua_function(
        Argument('via', kinds.POSE, '', 'pose on the arc: its position is passed'),
        Argument('target', kinds.POSE, '', 'pose at the end of the arc'),
    )
    def circCartesianSpace(self, *poses: Sequence[float], options: MotionOptions) -> Waiting:
        """Moves the tool on an arc through `via` to `target`, each {x, y, z, phi1, phi2, phi3}."""
        return self._move('circCartesianSpace', options, path=poses)

    @lua_function(Argument('pose', kinds.POSE, '', 'pose on the curve', repeated=True))
    def splineCartesianSpace(self, *poses: Sequence[float], options: MotionOptions) -> Waiting:
        """Moves the tool on a smooth curve through poses, each {x, y, z, phi1, phi2, phi3}."""
        return self._move('splineCartesianSpace', options, path=poses)

    @lua_function(*six_numbers('displacement along {}', 'turn by orientation angle {}'), WHOSE_AXES)
    def linearRelative(self, *shift_and_frame: Any, options: MotionOptions) -> Waiting:
        """Moves the tool on a straight line, relative to the last target."""
        if not self._run.target.known:
            yield from self.standstill()
        *shift, frame = shift_and_frame
        pose = moved(self._run.target.pose(), self._run.view.pose(shift), frame)
        return (yield from self._move('linearRelative', options, pose=pose))

    @lua_function(
        Argument(
            'q',
            kinds.NUMBER,
            'deg (m)',
            'displacement of the joint, in metres for a sliding axis',
            per_axis=True,
        )
    )
    def ptpJointSpaceAnglesRelative(self, *shift: float, options: MotionOptions) -> Waiting:
        """Moves all axes together by joint angles, relative to the last target."""
        if not self._run.target.in_joints:
            yield from self.standstill()
        q = read_only(self._run.target.joints() + np.array(shift))
        return (yield from self._move('ptpJointSpaceAnglesRelative', options, q=q))

    def _move(
        self,
        function: str,
        options: MotionOptions,
        *,
        q: Array | None = None,
        pose: Pose | None = None,
        path: Sequence[Sequence[float]] = (),
    ) -> Waiting:
        poses = tuple(self._run.view.pose(values) for values in path)
        pose = poses[-1] if poses else pose
        kind = KIND_OF_FUNCTION[function]
        blend, before = options.blend, self._state.motions
        chained = bool(before and before[-1].blend)
        if blend:
            self._run.change(
                blend_zone=blend if kind.cartesian else 0.0, joint_blend_zone=0.0 if kind.cartesian else blend
            )
        elif not chained and 'blend_zone' in self._run.settings:
            self._run.change(blend_zone=0.0, joint_blend_zone=0.0)
        settings = dict(self._run.settings)
        if options.avoid is not None:
            settings['avoid'] = options.avoid
        if options.on_blocked is not None:
            if options.on_blocked == 'replan' and not settings.get('avoid'):
                raise LuaCallError(
                    f"{function}: on_blocked = 'replan' leads around obstacles; "
                    'it needs avoid = true, here or by setAvoid'
                )
            settings['on_blocked'] = options.on_blocked
        command = MotionCommand(
            kind,
            self._run.line,
            function,
            q=q,
            pose=pose,
            path=poses,
            settings=MappingProxyType(settings),
            blend=blend,
            switches=options.switches,
        )
        if self._handlers and self._state.braked:
            self._handlers[-1].interrupted += self._abort_motions()
        yield from self._run.guided.interrupt()
        self._raise_failure(None)
        self._send(command)
        self._run.target.set(q, pose)
        if chained and not blend:
            # Switched off before, blending would end the chain before its last motion.
            self._run.cell.flush()
        if not blend:
            yield from self.standstill(command, options.until)
            self._motion_ended()
        return None

    def until(
        self, condition: Condition, name: str, arguments: Arguments
    ) -> Generator[None, None, Pose | None]:
        """Make a motion, by the name of its function, until a condition holds that does not hold yet.

        Returns:
            Where the tool was when it came true, seen from the base; None if it did not.
        """
        self._found = None
        assert arguments.options is not None
        options = replace(arguments.options, until=condition)
        motion = self.handlers[name](*arguments.values, options=options)
        assert isinstance(motion, Generator)
        yield from motion
        return self._found

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
        return self._run.target.seen(self._run.cell.kinematics.direct(command.q))

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
            self._found = self._run.tool_pose()
            self._abort_motions()
        self._raise_failure(command)

    def _raise_failure(self, current: MotionCommand | None) -> None:
        failure = self._state.take_motion_error()
        if failure is not None:
            raise self._failure(*failure, current) from failure[1]

    def _failure(
        self, command: MotionCommand, error: RobotsError, current: MotionCommand | None
    ) -> LuaCallError:
        self._run.target.forget()
        where = command.function if command is current else f'{command.function} of line {command.line}'
        angles = () if command.pose is None else self._run.shown(command.pose)[3:]
        self.error, self.error_text = error, f'{where}: {for_program(error, pose_angles=angles)}'
        return LuaCallError(self.error_text)

    def begin_handler(self) -> int:
        """Begin the handler that is due; the motion under way is held. Returns the handler's number."""
        self._handlers.append(_Handler(self._state.braked))
        self._state.set_braked(braked=bool(self._state.motions))
        return self._state.interrupts.begin()

    def handled(self, *, abort: bool) -> None:
        """The handler that began last has ended: the motion under way continues, or ends there."""
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
            self._run.guided.handled(abort=abort)
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
