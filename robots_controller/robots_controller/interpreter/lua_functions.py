"""The functions of robot programs (paper, table 2, and more in its style).

`LUA_FUNCTIONS` describes each once: registration, argument checks, the reference, the editor's help and the
check of a program are made from it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal

from robots_core.orientation import ORIENTATION_CONVENTIONS
from robots_planning.motion_kinds import KIND_OF_FUNCTION

Kind = Literal[
    'number',
    'time',
    'fraction',
    'scale',
    'positive',
    'switch',
    'text',
    'name',
    'frame',
    'comparison',
    'convention',
    'function',
    'pose',
    'digital index',
    'analog index',
]
Options = Literal['', 'cartesian', 'joint']

FRAMES: Final = ('base', 'tool')
COMPARISONS: Final = ('<', '<=', '>', '>=', '==', '~=')
ANCHORS: Final = ('distance_before_end', 'distance_after_start', 'time_before_end', 'time_after_start')


@dataclass(frozen=True)
class Argument:
    """One argument of a Lua function.

    Attributes:
        name: As in the paper.
        kind: Which values are valid.
        unit: '' for none.
        meaning: One line.
        per_axis: Comes once per axis, as name1, name2, ...
        repeated: Comes once or more, as name1, name2, ...
        optional: May be left out or nil.
    """

    name: str
    kind: Kind
    unit: str
    meaning: str
    per_axis: bool = False
    repeated: bool = False
    optional: bool = False


@dataclass(frozen=True)
class LuaFunction:
    """One function of robot programs.

    Attributes:
        name: The paper's name.
        arguments: In their order; those of a target or frame may come as one table.
        doc: What it does, for the reference.
        result: What it returns, '' for nothing.
        result_type: The same for the Lua language server.
        more: Further arguments of any kind may follow.
    """

    name: str
    arguments: tuple[Argument, ...]
    doc: str
    result: str = ''
    result_type: str = ''
    more: bool = False

    @property
    def options(self) -> Options:
        """Which table of options may follow the arguments: those of its kind of motion; '' for none."""
        kind = KIND_OF_FUNCTION.get(self.name)
        if kind is None:
            return ''
        return 'cartesian' if kind.cartesian else 'joint'

    @property
    def signature(self) -> str:
        """As in a program: name(arguments), those in brackets optional."""
        names = []
        for argument in self.arguments:
            name = argument.name
            if argument.per_axis or argument.repeated:
                name = f'{name}1, ..., {name}n'
            names.append(f'[{name}]' if argument.optional else name)
        if self.options:
            names.append('[options]')
        if self.more:
            names.append('...')
        return f'{self.name}({", ".join(names)})'


_ANGLES = tuple(
    Argument(f'phi{i}', 'number', 'deg', f"orientation angle {i} in the robot's convention")
    for i in (1, 2, 3)
)
_POSE = (
    *(Argument(axis, 'number', 'm', f'{axis} of the tool in the base frame') for axis in 'xyz'),
    *_ANGLES,
)
_FRAME = (*(Argument(axis, 'number', 'm', f'{axis} of the frame') for axis in 'xyz'), *_ANGLES)
_SWITCH = Argument('value', 'switch', '', '0 or false: off, 1 or true: on')
_TIMEOUT = Argument('timeout', 'time', 's', 'longest wait; without one it waits for ever', optional=True)
_DIGITAL_INPUT = Argument('index', 'digital index', '', 'number of the input, from 1')
_ANALOG_INPUT = Argument('index', 'analog index', '', 'number of the input, from 1')
_HANDED_OVER = (
    Argument('time', 'time', 's', 'longest time of it'),
    Argument('index', 'digital index', '', 'number of a digital input that ends it', optional=True),
    Argument('value', 'switch', '', 'the value of it that does', optional=True),
)
_DIGITAL_OUTPUT = Argument('index', 'digital index', '', 'number of the output, from 1')
_JOINTS = Argument('q', 'number', 'deg (m)', 'joint angle, in metres for a sliding axis', per_axis=True)


def _speeds(what: str, unit: str) -> tuple[Argument, ...]:
    return (
        Argument('fraction', 'fraction', '', f"part of the axes' limits of {what}", optional=True),
        Argument(
            'cartesian', 'positive', f'm/{unit}', f'{what} of the tool on Cartesian paths', optional=True
        ),
        Argument(
            'rotation',
            'positive',
            f'deg/{unit}',
            f'angular {what} of the tool on Cartesian paths',
            optional=True,
        ),
    )


_FUNCTIONS: Final = (
    LuaFunction(
        'ptpCartesianSpace',
        _POSE,
        'Moves the tool on a straight line to a pose; returns when the robot stands there.',
    ),
    LuaFunction(
        'ptpJointSpaceAngles',
        (_JOINTS,),
        'Moves all axes together to joint angles; returns when the robot stands there.',
    ),
    LuaFunction(
        'ptpJointSpacePosition',
        _POSE,
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
    LuaFunction(
        'setTool', _FRAME, 'Sets the tool: its tip seen from the flange (tool0); poses are of the tip.'
    ),
    LuaFunction(
        'setBase', _FRAME, "Sets the base: a frame seen from the robot's base; poses are seen from it."
    ),
    LuaFunction(
        'setOrientationConvention',
        (Argument('convention', 'convention', '', f'one of {", ".join(ORIENTATION_CONVENTIONS)}'),),
        "Sets what orientation angles mean; without it they follow the robot's maker.",
    ),
    LuaFunction(
        'setPayload',
        (
            Argument('mass', 'number', 'kg', 'mass of what the flange carries: tool and workpiece'),
            *(
                Argument(axis, 'number', 'm', f'{axis} of its centre of mass, seen from tool0', optional=True)
                for axis in 'xyz'
            ),
        ),
        'Sets what the flange carries, when the robot stands; it counts in all torques.',
    ),
    LuaFunction(
        'setOverride',
        (Argument('value', 'scale', '', 'speed scale of all motions, 0 to 1, at once'),),
        'Scales the speed, also of the motion under way; 0 stands still.',
    ),
    LuaFunction(
        'setSpeed', _speeds('speed', 's'), 'Sets speed limits of the next motions; nil leaves one as it is.'
    ),
    LuaFunction(
        'setAcceleration',
        _speeds('acceleration', 's^2'),
        'Sets acceleration limits of the next motions; nil leaves one as it is.',
    ),
    LuaFunction(
        'getJointAngles',
        (),
        'Reads where the joints are, in degrees, in metres for sliding axes.',
        'a table of n numbers',
        'number[]',
    ),
    LuaFunction(
        'getCartesianPosition',
        (),
        'Reads where the tool is, seen from the base: {x, y, z, phi1, phi2, phi3}.',
        'a table of 6 numbers',
        'number[]',
    ),
    LuaFunction('setDigitalOutput', (_DIGITAL_OUTPUT, _SWITCH), 'Switches a digital output.'),
    LuaFunction('getDigitalInput', (_DIGITAL_INPUT,), 'Reads a digital input.', 'true or false', 'boolean'),
    LuaFunction(
        'setAnalogOutput',
        (
            Argument('index', 'analog index', '', 'number of the output, from 1'),
            Argument('value', 'number', '', 'value of the output'),
        ),
        'Sets an analog output.',
    ),
    LuaFunction('getAnalogInput', (_ANALOG_INPUT,), 'Reads an analog input.', 'a number', 'number'),
    LuaFunction(
        'waitDigitalInput',
        (_DIGITAL_INPUT, _SWITCH, _TIMEOUT),
        'Waits until a digital input has a value.',
        'true, or false after `timeout`',
        'boolean',
    ),
    LuaFunction(
        'waitAnalogInput',
        (
            _ANALOG_INPUT,
            Argument('comparison', 'comparison', '', f'one of {" ".join(COMPARISONS)}'),
            Argument('value', 'number', '', 'what the input is compared with'),
            _TIMEOUT,
        ),
        "Waits until an analog input compares: waitAnalogInput(1, '>', 2.5).",
        'true, or false after `timeout`',
        'boolean',
    ),
    LuaFunction(
        'pulseDigitalOutput',
        (_DIGITAL_OUTPUT, Argument('time', 'time', 's', 'how long it is on')),
        'Switches a digital output on, and off again after a time; the program goes on meanwhile.',
    ),
    LuaFunction(
        'onDigitalInput',
        (
            _DIGITAL_INPUT,
            _SWITCH,
            Argument('handler', 'function', '', "called at the change; it may return 'abort'"),
        ),
        'Lets a change of an input interrupt the program: the robot brakes on its path, `handler` runs, the '
        "motion goes on, or ends there if it returned 'abort'.",
    ),
    LuaFunction(
        'call',
        (
            Argument(
                'program', 'name', '', 'file of the subprogram, seen from the folder of the main program'
            ),
        ),
        'Runs another program as subprogram; it has the same globals, and further arguments as `...`.',
        'what the subprogram returns',
        '...',
        more=True,
    ),
    LuaFunction(
        'teach',
        (Argument('name', 'name', '', 'name of the point'),),
        'Writes where the robot is to the points file under a name.',
    ),
    LuaFunction(
        'getTaughtPoint',
        (Argument('name', 'name', '', 'name of the point'),),
        'Reads a taught point: its joint angles, and the pose of the flange {x, y, z, phi1, phi2, phi3}.',
        'two tables',
        'number[], number[]',
    ),
    LuaFunction(
        'followReference',
        _HANDED_OVER,
        'Lets `reference_pose` guide the robot (state TRAJECTORY).',
        'true if the input ended it, false after `time`',
        'boolean',
    ),
    LuaFunction(
        'jog',
        _HANDED_OVER,
        'Lets a person jog the robot (state TEACH).',
        'true if the input ended it, false after `time`',
        'boolean',
    ),
    LuaFunction('wait', (Argument('time', 'time', 's', 'how long, not counting pauses'),), 'Waits.'),
    LuaFunction(
        'print',
        (Argument('string', 'text', '', 'any values; several are separated by tabs'),),
        "Writes a line to the program's output.",
    ),
)

LUA_FUNCTIONS: Final[Mapping[str, LuaFunction]] = MappingProxyType({f.name: f for f in _FUNCTIONS})
"""All functions of robot programs, by name."""

PAPER_FUNCTIONS: Final = (
    'ptpCartesianSpace',
    'ptpJointSpaceAngles',
    'ptpJointSpacePosition',
    'setDigitalOutput',
    'getDigitalInput',
    'setAnalogOutput',
    'getAnalogInput',
    'wait',
    'print',
)
"""Those of the paper's table 2."""
