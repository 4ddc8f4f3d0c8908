"""Kinds of arguments of Lua functions: which values are valid, for checks, messages and editors."""

from __future__ import annotations

import operator
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final, get_args

from robots_controller.io.io_image import IoImage
from robots_controller.program.files.cell_frames import FrameKind
from robots_controller.program.motions.motion_command import Anchor
from robots_core.blocks.inverse_kinematics.hold import HOLDS
from robots_core.orientation import ORIENTATION_CONVENTIONS
from robots_core.robot_model.analytic.configuration import CONFIGURATIONS
from robots_planning.motion_kinds import KIND_OF_FUNCTION
from robots_planning.motion_settings import ON_BLOCKED as ON_BLOCKED_CHOICES
from robots_planning.planner_choice import available_planners

COMPARISONS: Final[Mapping[str, Callable[[float, float], bool]]] = {
    '<': operator.lt,
    '<=': operator.le,
    '>': operator.gt,
    '>=': operator.ge,
    '==': operator.eq,
    '~=': operator.ne,
}
ANCHORS: Final[tuple[Anchor, ...]] = get_args(Anchor)


@dataclass(frozen=True)
class Sizes:
    """What bounds arguments.

    Attributes:
        num_axes: n.
        digital: Number of digital inputs, and of outputs.
        analog: Number of analog inputs, and of outputs.
        prismatic: (n,) which axes slide; () for none.
        names: Indices of inputs and outputs by their names, for the name of each channel's kind; None where
            names are not known, and any may be valid.
        frames_file: The frames file with the names of tools and bases; None where any may be valid.
    """

    num_axes: int
    digital: int
    analog: int
    prismatic: tuple[bool, ...] = ()
    names: Mapping[str, Mapping[str, int]] | None = None
    frames_file: Path | None = None

    @classmethod
    def of(cls, num_axes: int, io: IoImage, prismatic: tuple[bool, ...] = ()) -> Sizes:
        """Those of a program with these inputs and outputs."""
        names: dict[str, dict[str, int]] = {kind.channel: {} for kind in CHANNELS}
        for channel in io.channels:
            if channel.label:
                names[f'{channel.kind} {channel.direction}'][channel.label] = channel.index
        return cls(num_axes, io.size('digital_inputs'), io.size('analog_inputs'), prismatic, names)

    def count(self, channel: str) -> int:
        """Number of inputs or outputs of a channel's kind."""
        return self.digital if channel.startswith('digital') else self.analog


@dataclass(frozen=True, eq=False)
class ArgumentKind:
    """Which values an argument can have.

    Attributes:
        valid: The valid ones, for messages; some depend on the cell.
        lua_type: The same for the Lua language server.
        number: Whether a number is valid; None for no number.
        text: Whether a text is valid; None for no text.
        channel: 'digital input' and so on, of which the argument is the index or the name; '' for others.
        frame: 'tool' or 'base', of which the argument is the name; None for others.
    """

    valid: str | Callable[[Sizes], str]
    lua_type: str = 'number'
    number: Callable[[float], bool] | None = None
    text: Callable[[str], bool] | None = None
    channel: str = ''
    frame: FrameKind | None = None

    def describe(self, sizes: Sizes) -> str:
        """The valid values, for a message."""
        return self.valid if isinstance(self.valid, str) else self.valid(sizes)


def _choice(choices: Collection[str], separator: str = ', ') -> ArgumentKind:
    return ArgumentKind(
        separator.join(f"'{choice}'" for choice in choices),
        '|'.join(f'"{choice}"' for choice in choices),
        text=choices.__contains__,
    )


def _planner(setting: str) -> ArgumentKind:
    return ArgumentKind(
        lambda _: ', '.join(f"'{planner}'" for planner in available_planners(setting)),
        'string',
        text=lambda text: text in available_planners(setting),
    )


def _channel(channel: str) -> ArgumentKind:
    def valid(sizes: Sizes) -> str:
        names = ''.join(f" or '{name}'" for name in (sizes.names or {}).get(channel, ()))
        return f'a whole number in 1..{sizes.count(channel)}{names}'

    return ArgumentKind(valid, 'integer|string', _whole_number, channel=channel)


def _whole_number(value: float) -> bool:
    return value >= 1.0 and value.is_integer()


NUMBER: Final = ArgumentKind('a finite number', number=lambda _: True)
TIME: Final = ArgumentKind('a finite number of at least 0', number=lambda value: value >= 0.0)
FRACTION: Final = ArgumentKind('a number above 0, at most 1', number=lambda value: 0.0 < value <= 1.0)
SCALE: Final = ArgumentKind('a number in 0..1', number=lambda value: 0.0 <= value <= 1.0)
POSITIVE: Final = ArgumentKind('a finite number above 0', number=lambda value: value > 0.0)
COUNT: Final = ArgumentKind('a whole number of at least 1', 'integer', _whole_number)
SWITCH: Final = ArgumentKind('0, 1, true or false', 'boolean|0|1', lambda value: value in (0.0, 1.0))

TEXT: Final = ArgumentKind('a string', 'any', text=lambda _: True)
NAME: Final = ArgumentKind('a string that is not empty', 'string', text=bool)
TOOL: Final = ArgumentKind('the name of a tool', 'string', text=bool, frame='tool')
BASE: Final = ArgumentKind('the name of a base', 'string', text=bool, frame='base')
FRAME: Final = _choice(('base', 'tool'), ' or ')
MOMENT: Final = _choice(('now', 'arrival'), ' or ')
COMPARISON: Final = _choice(COMPARISONS)
CONVENTION: Final = _choice(ORIENTATION_CONVENTIONS)
HOLD: Final = _choice(HOLDS)
ON_BLOCKED: Final = _choice(ON_BLOCKED_CHOICES)
CONFIGURATION: Final = _choice(CONFIGURATIONS)
JOINT_PLANNER: Final = _planner('joint_planner')
CARTESIAN_PLANNER: Final = _planner('cartesian_planner')
MOTION: Final = ArgumentKind(
    f'a function that moves the robot: {", ".join(KIND_OF_FUNCTION)}',
    'function',
    text=KIND_OF_FUNCTION.__contains__,
)

DIGITAL_INPUT: Final = _channel('digital input')
DIGITAL_OUTPUT: Final = _channel('digital output')
ANALOG_INPUT: Final = _channel('analog input')
ANALOG_OUTPUT: Final = _channel('analog output')
CHANNELS: Final = (DIGITAL_INPUT, DIGITAL_OUTPUT, ANALOG_INPUT, ANALOG_OUTPUT)

FUNCTION: Final = ArgumentKind('a function', 'fun(): "abort"|nil')
POSE: Final = ArgumentKind('a table {x, y, z, phi1, phi2, phi3}', 'Pose|number[]')
JOINTS: Final = ArgumentKind('a table with a number per axis', 'number[]')
CONDITION: Final = ArgumentKind('a table with a condition', 'Condition')
VALUE: Final = ArgumentKind(
    'a finite number, a string, true, false, nil or a list of numbers',
    'number|string|boolean|number[]',
    text=lambda _: True,
)
