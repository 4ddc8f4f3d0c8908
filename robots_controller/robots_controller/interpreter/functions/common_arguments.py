"""Arguments that several functions have."""

from typing import Final

from robots_controller.interpreter import argument_kinds as kinds
from robots_controller.interpreter.functions.lua_function import Argument


def six_numbers(shift: str, turn: str, *, optional_turn: bool = False) -> tuple[Argument, ...]:
    """Position and orientation angles of a pose; with `optional_turn` the angles may be left out."""
    return (
        *(Argument(axis, kinds.NUMBER, 'm', shift.format(axis)) for axis in 'xyz'),
        *(
            Argument(f'phi{i}', kinds.NUMBER, 'deg', turn.format(i), optional=optional_turn)
            for i in (1, 2, 3)
        ),
    )


FRAME: Final = six_numbers('{} of the frame', "orientation angle {} in the robot's convention")
POSE: Final = six_numbers(
    '{} of the tool in the base frame', "orientation angle {} in the robot's convention"
)
WHOSE_AXES: Final = Argument(
    'frame', kinds.FRAME, '', "'base' (default) or 'tool': whose axes are meant", optional=True
)
JOINTS: Final = Argument(
    'q', kinds.NUMBER, 'deg (m)', 'joint angle, in metres for a sliding axis', per_axis=True
)
SWITCH: Final = Argument('value', kinds.SWITCH, '', '0 or false: off, 1 or true: on')
DIGITAL_INPUT, ANALOG_INPUT, DIGITAL_OUTPUT, ANALOG_OUTPUT = (
    Argument('index', kind, '', f'number of the {kind.channel.split()[1]}, from 1, or its name')
    for kind in (kinds.DIGITAL_INPUT, kinds.ANALOG_INPUT, kinds.DIGITAL_OUTPUT, kinds.ANALOG_OUTPUT)
)
COMPARISON: Final = (
    Argument('comparison', kinds.COMPARISON, '', f'one of {" ".join(kinds.COMPARISONS)}'),
    Argument('value', kinds.NUMBER, '', 'what the input is compared with'),
)
MOMENT: Final = Argument(
    'moment',
    kinds.MOMENT,
    '',
    "'now' (default), or 'arrival': when the robot is at the last target, also where it runs through",
    optional=True,
)
TIMEOUT: Final = Argument(
    'timeout', kinds.TIME, 's', 'longest wait; without one it waits for ever', optional=True
)
