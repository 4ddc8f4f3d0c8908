"""The functions of robot programs (paper, table 2).

`LUA_FUNCTIONS` describes each once: registration, argument checks and the reference are made from it.
Programs speak degrees and metres; this is the one file that knows degrees.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final, Literal

import numpy as np

from robots_controller.interpreter.lua_sandbox import LuaArgument, LuaCallError
from robots_controller.interpreter.program_state import MotionCommand, OutputChange, ProgramState
from robots_core.errors import RobotsError
from robots_core.pose import Pose
from robots_core.validation import read_only
from robots_planning.robot_command_state import RobotCommandState

Kind = Literal['number', 'time', 'switch', 'text', 'digital index', 'analog index']


@dataclass(frozen=True)
class Argument:
    """One argument of a Lua function.

    Attributes:
        name: As in the paper.
        kind: Which values are valid.
        unit: '' for none.
        meaning: One line.
        per_axis: Comes once per axis, as name1, name2, ...
    """

    name: str
    kind: Kind
    unit: str
    meaning: str
    per_axis: bool = False


@dataclass(frozen=True)
class LuaFunction:
    """One function of robot programs.

    Attributes:
        name: The paper's name.
        arguments: In their order; a motion also takes them as one table.
        doc: What it does, for the reference.
        result: What it returns, '' for nothing.
    """

    name: str
    arguments: tuple[Argument, ...]
    doc: str
    result: str = ''

    @property
    def signature(self) -> str:
        """As in a program: name(arguments)."""
        names = [f'{a.name}1, ..., {a.name}n' if a.per_axis else a.name for a in self.arguments]
        return f'{self.name}({", ".join(names)})'


_POSE = (
    *(Argument(name, 'number', 'm', f'{name} of tool0 in the base frame') for name in 'xyz'),
    *(
        Argument(f'phi{i}', 'number', 'deg', f"orientation angle {i} in the robot's convention")
        for i in (1, 2, 3)
    ),
)
_SWITCH = Argument('value', 'switch', '', '0 or false: off, 1 or true: on')

LUA_FUNCTIONS: Final[Mapping[str, LuaFunction]] = MappingProxyType(
    {
        function.name: function
        for function in (
            LuaFunction(
                'ptpCartesianSpace',
                _POSE,
                'Moves tool0 on a straight line to a pose; returns when the robot stands there.',
            ),
            LuaFunction(
                'ptpJointSpaceAngles',
                (Argument('q', 'number', 'deg (m)', 'joint angle, in metres for a sliding axis', True),),
                'Moves all axes together to joint angles; returns when the robot stands there.',
            ),
            LuaFunction(
                'ptpJointSpacePosition',
                _POSE,
                'Moves all axes together to a pose; returns when the robot stands there.',
            ),
            LuaFunction(
                'setDigitalOutput',
                (Argument('index', 'digital index', '', 'number of the output, from 1'), _SWITCH),
                'Switches a digital output.',
            ),
            LuaFunction(
                'getDigitalInput',
                (Argument('index', 'digital index', '', 'number of the input, from 1'),),
                'Reads a digital input.',
                'true or false',
            ),
            LuaFunction(
                'setAnalogOutput',
                (
                    Argument('index', 'analog index', '', 'number of the output, from 1'),
                    Argument('value', 'number', '', 'value of the output'),
                ),
                'Sets an analog output.',
            ),
            LuaFunction(
                'getAnalogInput',
                (Argument('index', 'analog index', '', 'number of the input, from 1'),),
                'Reads an analog input.',
                'a number',
            ),
            LuaFunction(
                'wait',
                (Argument('time', 'time', 's', 'how long, not counting pauses'),),
                'Waits.',
            ),
            LuaFunction(
                'print',
                (Argument('string', 'text', '', 'any values; several are separated by tabs'),),
                "Writes a line to the program's output.",
            ),
        )
    }
)
"""Table 2 of the paper, by name."""


@dataclass(frozen=True)
class ProgramEvents:
    """What the host wants to hear; everything is called from the program's thread.

    Attributes:
        command: A motion is commanded; the host ends it with `finish_motion`.
        output: An output changed.
        printed: A line of text, and the program's line.
        line: The program calls a robot function on another line than before.
    """

    command: Callable[[MotionCommand], None]
    output: Callable[[OutputChange], None]
    printed: Callable[[str, int], None]
    line: Callable[[int], None]


@dataclass
class RobotFunctions:
    """Serves the calls of one run of a program.

    Attributes:
        state: What the robot's side sees.
        events: What it hears.
        orientation_convention: Order of the angles phi.
        prismatic: (n,) which axes slide; () for none.
    """

    state: ProgramState
    events: ProgramEvents
    orientation_convention: str
    prismatic: tuple[bool, ...] = ()
    line: int = 0
    error: RobotsError | None = None
    """What the last motion that failed was told."""
    error_text: str = ''
    _handlers: dict[str, Callable[[list[float]], bool | float | None]] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        self._handlers = {
            'ptpCartesianSpace': self._ptp_cartesian_space,
            'ptpJointSpaceAngles': self._ptp_joint_space_angles,
            'ptpJointSpacePosition': self._ptp_joint_space_position,
            'setDigitalOutput': lambda a: self._set_output('digital', a),
            'getDigitalInput': lambda a: bool(self.state.digital_inputs[int(a[0]) - 1]),
            'setAnalogOutput': lambda a: self._set_output('analog', a),
            'getAnalogInput': lambda a: float(self.state.analog_inputs[int(a[0]) - 1]),
            'wait': lambda a: self.state.sleep(a[0]),
        }

    def call(self, name: str, line: int, arguments: list[LuaArgument]) -> bool | float | None:
        """Serve one call from Lua.

        Raises:
            LuaCallError: wrong arguments, or a motion that failed.
            ProgramStopped: the program shall stop.
        """
        self.state.hold()
        if line != self.line:
            self.line = line
            self.events.line(line)
        if name == 'print':
            self.events.printed(_text(arguments), line)
            return None
        values = self._check_arguments(LUA_FUNCTIONS[name], arguments)
        return self._handlers[name](values)

    # -- motions --------------------------------------------------------------------------------

    def _ptp_cartesian_space(self, values: list[float]) -> None:
        command = MotionCommand(
            RobotCommandState.PTPCARTESIAN, self.line, 'ptpCartesianSpace', pose=self._pose(values)
        )
        self._move(command)

    def _ptp_joint_space_position(self, values: list[float]) -> None:
        command = MotionCommand(
            RobotCommandState.PTPJOINT_CARTESIAN,
            self.line,
            'ptpJointSpacePosition',
            pose=self._pose(values),
        )
        self._move(command)

    def _ptp_joint_space_angles(self, values: list[float]) -> None:
        slides = np.array(self.prismatic or (False,) * len(values))
        q = np.where(slides, values, np.radians(values))
        command = MotionCommand(
            RobotCommandState.PTPJOINT_JOINT, self.line, 'ptpJointSpaceAngles', q=read_only(q)
        )
        self._move(command)

    def _pose(self, values: list[float]) -> Pose:
        return Pose.from_angles(values[:3], np.radians(values[3:]), self.orientation_convention)

    def _move(self, command: MotionCommand) -> None:
        try:
            self.state.command_motion(command)
            try:
                self.events.command(command)
            except BaseException:
                self.state.finish_motion()
                raise
            self.state.wait_for_motion()
        except RobotsError as error:
            self.error, self.error_text = error, f'{command.function}: {in_degrees(error)}'
            raise LuaCallError(self.error_text) from error

    # -- outputs --------------------------------------------------------------------------------

    def _set_output(self, kind: Literal['digital', 'analog'], values: list[float]) -> None:
        index = int(values[0])
        if self.state.set_output(kind, index, values[1]):
            self.events.output(OutputChange(kind, index, values[1], self.line))

    # -- arguments ------------------------------------------------------------------------------

    def _check_arguments(self, function: LuaFunction, arguments: Sequence[LuaArgument]) -> list[float]:
        wanted = self._wanted(function)
        if len(arguments) != len(wanted):
            if function.arguments[0].per_axis:
                raise LuaCallError(
                    f'{function.name}: got {len(arguments)} joint angles, the robot has {len(wanted)} axes'
                )
            names = ', '.join(f'{name} ({a.unit})' if a.unit else name for name, a in wanted)
            raise LuaCallError(
                f'{function.name}: got {len(arguments)} arguments, needed are {len(wanted)}: {names}'
            )
        return [
            self._check(function.name, name, argument, given)
            for (name, argument), given in zip(wanted, arguments, strict=True)
        ]

    def _wanted(self, function: LuaFunction) -> list[tuple[str, Argument]]:
        first = function.arguments[0]
        if first.per_axis:
            return [(f'{first.name}{i}', first) for i in range(1, self.state.num_axes + 1)]
        return [(argument.name, argument) for argument in function.arguments]

    def _check(self, function: str, name: str, argument: Argument, given: LuaArgument) -> float:
        valid, number = _VALID[argument.kind], math.nan
        high = math.inf
        if argument.kind == 'switch' and isinstance(given.value, bool):
            return float(given.value)
        if given.type == 'number' and isinstance(given.value, (int, float)):
            number = float(given.value)
        if argument.kind in ('digital index', 'analog index'):
            digital = argument.kind == 'digital index'
            high = (self.state.digital_inputs if digital else self.state.analog_inputs).size
            valid = f'a whole number in 1..{high}'
        if not (math.isfinite(number) and _CHECKS[argument.kind](number) and number <= high):
            unit = f' {argument.unit}' if argument.unit and given.type == 'number' else ''
            raise LuaCallError(f'{function}: {name} = {_shown(given)}{unit}; valid is {valid}')
        return number


_CHECKS: Final[Mapping[Kind, Callable[[float], bool]]] = {
    'number': lambda _: True,
    'time': lambda value: value >= 0.0,
    'switch': lambda value: value in (0.0, 1.0),
    'digital index': lambda value: value >= 1.0 and value.is_integer(),
    'analog index': lambda value: value >= 1.0 and value.is_integer(),
}

_VALID: Final[Mapping[Kind, str]] = {
    'number': 'a finite number',
    'time': 'a finite number of at least 0',
    'switch': '0, 1, true or false',
    'digital index': '',
    'analog index': '',
}

_SHOWN_TEXT = 40


def _shown(given: LuaArgument) -> str:
    value = given.value
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, bytes):
        text = value.decode(errors='replace')
        return f"the string '{text[:_SHOWN_TEXT]}{'...' if len(text) > _SHOWN_TEXT else ''}'"
    if value is None:
        return 'nil' if given.type == 'nil' else f'a {given.type}'
    return f'{value:.10g}' if isinstance(value, float) else str(value)


def _text(arguments: Sequence[LuaArgument]) -> str:
    value = arguments[0].value if arguments else b''
    return value.decode(errors='replace') if isinstance(value, bytes) else str(value)


def in_degrees(error: RobotsError) -> str:
    """The error's message as a program's author writes angles: in degrees.

    An error with details `joint`, `value`, `lower`, `upper` and `unit` 'rad' is said anew; others keep
    their words. The details may be text, as they are in messages.
    """
    details = error.details
    if details.get('unit') != 'rad' or not {'joint', 'value', 'lower', 'upper'} <= details.keys():
        return error.message
    try:
        value, lower, upper = np.degrees([float(details[key]) for key in ('value', 'lower', 'upper')])
    except ValueError:
        return error.message
    return (
        f'{details["joint"]} = {_angle(value)} deg is outside its limits '
        f'[{_angle(lower)}, {_angle(upper)}] deg'
    )


def _angle(degrees: float) -> str:
    # Six decimals are finer than any robot's resolution and hide the rounding of radians.
    return str(round(float(degrees), 6))
