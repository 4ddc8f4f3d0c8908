"""Arguments that several functions have."""

from typing import Final

from robots_controller.interpreter.functions.lua_function import COMPARISONS, Argument

_ANGLES: Final = tuple(
    Argument(f'phi{i}', 'number', 'deg', f"orientation angle {i} in the robot's convention")
    for i in (1, 2, 3)
)
FRAME: Final = (*(Argument(axis, 'number', 'm', f'{axis} of the frame') for axis in 'xyz'), *_ANGLES)
POSE: Final = (
    *(Argument(axis, 'number', 'm', f'{axis} of the tool in the base frame') for axis in 'xyz'),
    *_ANGLES,
)
JOINTS: Final = Argument('q', 'number', 'deg (m)', 'joint angle, in metres for a sliding axis', per_axis=True)
SWITCH: Final = Argument('value', 'switch', '', '0 or false: off, 1 or true: on')
DIGITAL_INPUT: Final = Argument('index', 'digital input', '', 'number of the input, from 1, or its name')
ANALOG_INPUT: Final = Argument('index', 'analog input', '', 'number of the input, from 1, or its name')
DIGITAL_OUTPUT: Final = Argument('index', 'digital output', '', 'number of the output, from 1, or its name')
ANALOG_OUTPUT: Final = Argument('index', 'analog output', '', 'number of the output, from 1, or its name')
COMPARISON: Final = Argument('comparison', 'comparison', '', f'one of {" ".join(COMPARISONS)}')
MOMENT: Final = Argument(
    'moment',
    'moment',
    '',
    "'now' (default), or 'arrival': when the robot is at the last target, also where it runs through",
    optional=True,
)
TIMEOUT: Final = Argument(
    'timeout', 'time', 's', 'longest wait; without one it waits for ever', optional=True
)
