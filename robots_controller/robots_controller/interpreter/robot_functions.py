"""RobotFunctions: serves the calls of one run of a robot program."""

from __future__ import annotations

import operator
from collections.abc import Callable, Generator, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any, Final

import numpy as np

from robots_controller.degrees import in_degrees, joints_to_program, pose_to_program
from robots_controller.interpreter.lua_arguments import Arguments, Sizes, check_arguments
from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS
from robots_controller.interpreter.lua_sandbox import LuaArgument, LuaCallError, Result, Waiting
from robots_controller.program.cell_port import CellPort
from robots_controller.program.guided_motion import GuidedMotion
from robots_controller.program.motion_command import Kind, MotionCommand, OutputChange
from robots_controller.program.motion_target import MotionTarget, RobotView
from robots_controller.program.output_pulses import OutputPulses
from robots_controller.program.program_state import ProgramState
from robots_controller.program.taught_points import TaughtPoint, read_points, write_points
from robots_core.blocks.following.guide import Guide
from robots_core.blocks.multibody.payload import payload_of
from robots_core.errors import ProgramError, RobotsError
from robots_core.pose import Pose
from robots_core.validation import Array, read_only
from robots_planning.motion_kinds import KIND_OF_FUNCTION

_COMPARE: Final[Mapping[str, Callable[[float, float], bool]]] = {
    '<': operator.lt,
    '<=': operator.le,
    '>': operator.gt,
    '>=': operator.ge,
    '==': operator.eq,
    '~=': operator.ne,
}


class RobotFunctions:
    """The functions of `LUA_FUNCTIONS`, for one run.

    Args:
        state: What the program shares with its cell.
        cell: The cell.
        view: What the program sees of the robot.
        subprogram: Gives a subprogram's name and text.
        motion_ended: A motion that the program waited for has ended well.
    """

    def __init__(
        self,
        state: ProgramState,
        cell: CellPort,
        view: RobotView,
        *,
        subprogram: Callable[[str], tuple[str, str]],
        motion_ended: Callable[[], None],
    ) -> None:
        self.state = state
        self.cell = cell
        self.view = view
        self.line = 0
        self.error: RobotsError | None = None
        """What the last motion that failed was told."""
        self.error_text = ''
        self.target = MotionTarget(view)
        self._subprogram = subprogram
        self._motion_ended = motion_ended
        self._settings: dict[str, object] = {}
        self.pulses = OutputPulses(state, lambda index, value: self._set_output('digital', index, value))
        self._interrupted: list[MotionCommand] = []
        self._guidance = GuidedMotion(state, view.position, cell.guide)
        sizes = state.io
        self._sizes = Sizes(
            state.num_axes, sizes.size('digital_inputs'), sizes.size('analog_inputs'), view.prismatic
        )
        self._handlers: dict[str, Callable[[Arguments], Result | Waiting]] = {
            'ptpCartesianSpace': self._to_pose('ptpCartesianSpace'),
            'ptpJointSpaceAngles': self._to_joints,
            'ptpJointSpacePosition': self._to_pose('ptpJointSpacePosition'),
            'circCartesianSpace': self._along('circCartesianSpace'),
            'splineCartesianSpace': self._along('splineCartesianSpace'),
            'linearRelative': self._linear_relative,
            'ptpJointSpaceAnglesRelative': self._joints_relative,
            'setTool': self._set_tool,
            'setBase': self._set_base,
            'setOrientationConvention': self._set_convention,
            'setPayload': self._set_payload,
            'setOverride': self._set_override,
            'setSpeed': self._set_limits('speed'),
            'setAcceleration': self._set_limits('acceleration'),
            'getJointAngles': self._get_joint_angles,
            'getCartesianPosition': self._get_cartesian_position,
            'setDigitalOutput': lambda a: self._set_output('digital', int(a.values[0]), a.values[1]),
            'getDigitalInput': lambda a: bool(self._input('digital', a)),
            'setAnalogOutput': lambda a: self._set_output('analog', int(a.values[0]), a.values[1]),
            'getAnalogInput': lambda a: self._input('analog', a),
            'waitDigitalInput': self._wait_digital_input,
            'waitAnalogInput': self._wait_analog_input,
            'pulseDigitalOutput': lambda a: self.pulses.start(int(a.values[0]), a.values[1]),
            'onDigitalInput': self._on_digital_input,
            'call': self._call,
            'teach': self._teach,
            'getTaughtPoint': self._get_taught_point,
            'followReference': self._guided(Guide.SENSOR),
            'jog': self._guided(Guide.PERSON),
            'wait': self._wait,
        }

    def serve(self, name: str, arguments: list[LuaArgument]) -> Waiting:
        """Serve one call from Lua.

        Raises:
            LuaCallError: wrong arguments, or a motion that failed.
            ProgramStopped: the program shall stop.
        """
        while self.state.needs_attention():
            yield
        if name == 'print':
            self.cell.printed(_text(arguments), self.line)
            return None
        checked = check_arguments(LUA_FUNCTIONS[name], arguments, self._sizes)
        try:
            result = self._handlers[name](checked)
            if isinstance(result, Generator):
                result = yield from result
        except RobotsError as error:
            raise LuaCallError(f'{name}: {in_degrees(str(error))}') from error
        return result

    def finish(self) -> Waiting:
        """Wait until the robot stands and the last pulse is over."""
        yield from self._standstill()
        yield from self.state.waiting(lambda: not self.pulses.any)
        return None

    # -- motions --------------------------------------------------------------------------------

    def _to_pose(self, function: str) -> Callable[[Arguments], Waiting]:
        def move(arguments: Arguments) -> Waiting:
            return self._move(function, arguments, pose=self.view.pose(arguments.values))

        return move

    def _to_joints(self, arguments: Arguments) -> Waiting:
        q = read_only(arguments.values)
        return self._move('ptpJointSpaceAngles', arguments, q=q)

    def _along(self, function: str) -> Callable[[Arguments], Waiting]:
        def move(arguments: Arguments) -> Waiting:
            path = tuple(self.view.pose(values) for values in arguments.values)
            return self._move(function, arguments, pose=path[-1], path=path)

        return move

    def _linear_relative(self, arguments: Arguments) -> Waiting:
        if not self.target.known:
            yield from self._standstill()
        way, frame = self.view.pose(arguments.values[:6]), arguments.values[6] or 'base'
        start = self.target.pose()
        pose = start @ way if frame == 'tool' else Pose(start.r + way.r, way.T @ start.T)
        return (yield from self._move('linearRelative', arguments, pose=pose))

    def _joints_relative(self, arguments: Arguments) -> Waiting:
        if not self.target.in_joints:
            yield from self._standstill()
        q = read_only(self.target.joints() + np.array(arguments.values))
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
        blend, before = arguments.options.blend, self.state.motions
        chained = bool(before and before[-1].blend)
        if blend:
            self._settings |= {
                'blend_zone': blend if kind.cartesian else 0.0,
                'joint_blend_zone': 0.0 if kind.cartesian else blend,
            }
        elif not chained and 'blend_zone' in self._settings:
            self._settings |= {'blend_zone': 0.0, 'joint_blend_zone': 0.0}
        command = MotionCommand(
            kind,
            self.line,
            function,
            q=q,
            pose=pose,
            path=path,
            settings=MappingProxyType(dict(self._settings)),
            blend=blend,
            switches=arguments.options.switches,
        )
        if self.state.interrupts.serving is not None and self.state.braked:
            self._interrupted += self._abort_motions()
        yield from self._guidance.interrupt()
        self._raise_failure(None)
        self._send(command)
        self.target.set(q, pose)
        if chained and not blend:
            # Switched off before, blending would end the chain before its last motion.
            self.cell.flush()
        if not blend:
            yield from self._standstill(command)
            self._motion_ended()
        return None

    def _send(self, command: MotionCommand) -> None:
        try:
            self.state.command_motion(command, self._reference_pose(command))
            try:
                self.cell.command(command)
            except BaseException:
                self.state.finish_motion()
                raise
        except RobotsError as error:
            raise self._failure(command, error, command) from error

    def _reference_pose(self, command: MotionCommand) -> Pose | None:
        if command.q is None:
            return command.pose
        try:
            return self.target.seen(self.view.flange(command.q))
        except RobotsError:  # a cell without kinematics; the motion itself needs none
            return None

    def _standstill(self, command: MotionCommand | None = None) -> Generator[None, None, None]:
        motions = self.state.motions
        if motions and motions[-1].blend:
            self.cell.flush()
        yield from self.state.waiting(lambda: not self.state.motions or self.state.braked)
        self._raise_failure(command)

    def _raise_failure(self, current: MotionCommand | None) -> None:
        failure = self.state.take_motion_error()
        if failure is not None:
            raise self._failure(*failure, current) from failure[1]

    def _failure(
        self, command: MotionCommand, error: RobotsError, current: MotionCommand | None
    ) -> LuaCallError:
        self.target.forget()
        where = command.function if command is current else f'{command.function} of line {command.line}'
        self.error, self.error_text = error, f'{where}: {in_degrees(error.message)}'
        return LuaCallError(self.error_text)

    # -- interrupts -----------------------------------------------------------------------------

    def handled(self, *, abort: bool) -> None:
        """The handler of an input has ended: the motion under way goes on, or ends there."""
        interrupted, self._interrupted = self._interrupted, []
        if self.state.braked and abort:
            self._abort_motions()
        self.state.interrupts.end()
        if not abort:
            for command in interrupted:  # the handler moved the robot: from where it stands now
                self._send(command)
            if interrupted:
                self.cell.flush()  # what is held for a blend: the program waits for these already
        self._guidance.handled(abort=abort)
        self.state.set_braked(braked=False)

    def _abort_motions(self) -> list[MotionCommand]:
        motions = list(self.state.motions)
        if motions:
            self.cell.abort()
            self.state.wait_for_standstill()
            self.state.take_motion_error()
            self.target.forget()
        self.state.set_braked(braked=False)
        return motions

    # -- settings -------------------------------------------------------------------------------

    def _set_tool(self, arguments: Arguments) -> None:
        self.target.tool = self.view.pose(arguments.values)
        self._settings['tool'] = _seven(self.target.tool)

    def _set_base(self, arguments: Arguments) -> None:
        self.target.base = self.view.pose(arguments.values)
        self._settings['base'] = _seven(self.target.base)

    def _set_convention(self, arguments: Arguments) -> None:
        self.view = replace(self.view, convention=arguments.values[0])

    def _set_payload(self, arguments: Arguments) -> Waiting:
        payload = tuple(value or 0.0 for value in arguments.values)
        payload_of(payload)
        yield from self._standstill()
        self._settings['payload'] = payload
        return None

    def _set_override(self, arguments: Arguments) -> None:
        self.state.set_overrides(np.full(self.state.num_axes, arguments.values[0]))
        self.cell.set_override(arguments.values[0])

    def _set_limits(self, what: str) -> Callable[[Arguments], None]:
        names = (f'{what}_fraction', f'cartesian_{what}', f'rotation_{what}')

        def set_limits(arguments: Arguments) -> None:
            given = zip(names, arguments.values, strict=True)
            self._settings |= {name: value for name, value in given if value is not None}

        return set_limits

    # -- position -------------------------------------------------------------------------------

    def _get_joint_angles(self, _: Arguments) -> Waiting:
        yield from self._standstill()
        return (joints_to_program(self.view.position(), self.view.prismatic),)

    def _get_cartesian_position(self, _: Arguments) -> Waiting:
        yield from self._standstill()
        pose = self.target.seen(self.view.flange(self.view.position()))
        return (pose_to_program(pose.r, pose.angles(self.view.convention)),)

    def _teach(self, arguments: Arguments) -> Waiting:
        yield from self._standstill()
        q = self.view.position()
        points = read_points(self.view.points_file, self.state.num_axes)
        points[arguments.values[0]] = TaughtPoint(q, self.view.flange(q))
        write_points(self.view.points_file, points)
        return None

    def _get_taught_point(self, arguments: Arguments) -> Result:
        name, file = arguments.values[0], self.view.points_file
        points = read_points(file, self.state.num_axes)
        if name not in points:
            known = ', '.join(sorted(points)) or 'none'
            raise ProgramError(f'no point is named {name!r} in {file.name}; points are {known}')
        point = points[name]
        return (
            joints_to_program(point.q, self.view.prismatic),
            pose_to_program(point.pose.r, point.pose.angles(self.view.convention)),
        )

    # -- inputs, outputs, time --------------------------------------------------------------------

    def _input(self, kind: Kind, arguments: Arguments) -> float:
        return self.state.io.value(self.state.io.channel(kind, 'input', int(arguments.values[0])))

    def _wait_digital_input(self, arguments: Arguments) -> Waiting:
        _, value, timeout = arguments.values
        yield from self._standstill()
        return (yield from self.state.waiting(lambda: self._input('digital', arguments) == value, timeout))

    def _wait_analog_input(self, arguments: Arguments) -> Waiting:
        _, comparison, value, timeout = arguments.values
        yield from self._standstill()
        compare = _COMPARE[comparison]
        return (
            yield from self.state.waiting(lambda: compare(self._input('analog', arguments), value), timeout)
        )

    def _guided(self, guide: Guide) -> Callable[[Arguments], Waiting]:
        def serve(arguments: Arguments) -> Waiting:
            duration, index, value = arguments.values
            yield from self._standstill()
            inputs, wanted = Arguments([index, value], arguments.options), 1.0 if value is None else value

            def ended() -> bool:
                return index is not None and self._input('digital', inputs) == wanted

            result = yield from self._guidance.run(guide, ended, duration)
            self.target.forget()
            return result

        return serve

    def _wait(self, arguments: Arguments) -> Waiting:
        yield from self._standstill()
        yield from self.state.waiting(lambda: False, arguments.values[0])
        return None

    def _set_output(self, kind: Kind, index: int, value: float) -> None:
        if self.state.set_output(kind, index, value):
            self.cell.output_changed(OutputChange(kind, index, value, self.line))

    def _on_digital_input(self, arguments: Arguments) -> Result:
        index, value, _ = arguments.values
        with self.state.condition:
            return self.state.interrupts.add(int(index), bool(value), self.state.digital_inputs)

    def _call(self, arguments: Arguments) -> Result:
        name, text = self._subprogram(arguments.values[0])
        return f'{name}\n{text}'.encode()


def _seven(pose: Pose) -> tuple[float, ...]:
    return (*pose.r.tolist(), *pose.quaternion().tolist())


def _text(arguments: list[LuaArgument]) -> str:
    value: Any = arguments[0].value if arguments else b''
    return value.decode(errors='replace') if isinstance(value, bytes) else str(value)
