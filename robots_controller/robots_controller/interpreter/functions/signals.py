"""Signals: inputs and outputs."""

import operator
from collections.abc import Callable, Mapping
from typing import Final

from robots_controller.interpreter.functions.common_arguments import (
    ANALOG_INPUT,
    ANALOG_OUTPUT,
    COMPARISON,
    DIGITAL_INPUT,
    DIGITAL_OUTPUT,
    MOMENT,
    SWITCH,
    TIMEOUT,
)
from robots_controller.interpreter.functions.lua_function import Argument, LuaFunction
from robots_controller.interpreter.functions.run_context import Handlers, RunContext, Waits
from robots_controller.interpreter.lua_arguments import Arguments
from robots_controller.interpreter.lua_sandbox import Waiting
from robots_controller.program.motion_command import Kind, OutputChange
from robots_controller.program.output_pulses import OutputPulses

COMPARE: Final[Mapping[str, Callable[[float, float], bool]]] = {
    '<': operator.lt,
    '<=': operator.le,
    '>': operator.gt,
    '>=': operator.ge,
    '==': operator.eq,
    '~=': operator.ne,
}

SIGNALS: Final = (
    LuaFunction(
        'setDigitalOutput',
        (DIGITAL_OUTPUT, SWITCH, MOMENT),
        'Switches a digital output, now or when the robot is at the last target; the program goes on.',
    ),
    LuaFunction('getDigitalInput', (DIGITAL_INPUT,), 'Reads a digital input.', 'true or false', 'boolean'),
    LuaFunction(
        'getDigitalOutput', (DIGITAL_OUTPUT,), 'Reads a digital output back.', 'true or false', 'boolean'
    ),
    LuaFunction(
        'setAnalogOutput',
        (ANALOG_OUTPUT, Argument('value', 'number', '', 'value of the output'), MOMENT),
        'Sets an analog output, now or when the robot is at the last target; the program goes on.',
    ),
    LuaFunction('getAnalogInput', (ANALOG_INPUT,), 'Reads an analog input.', 'a number', 'number'),
    LuaFunction('getAnalogOutput', (ANALOG_OUTPUT,), 'Reads an analog output back.', 'a number', 'number'),
    LuaFunction(
        'waitDigitalInput',
        (DIGITAL_INPUT, SWITCH, TIMEOUT),
        'Waits until a digital input has a value.',
        'true, or false after `timeout`',
        'boolean',
    ),
    LuaFunction(
        'waitAnalogInput',
        (
            ANALOG_INPUT,
            COMPARISON,
            Argument('value', 'number', '', 'what the input is compared with'),
            TIMEOUT,
        ),
        "Waits until an analog input compares: waitAnalogInput(1, '>', 2.5).",
        'true, or false after `timeout`',
        'boolean',
    ),
    LuaFunction(
        'pulseDigitalOutput',
        (DIGITAL_OUTPUT, Argument('time', 'time', 's', 'how long it is on')),
        'Switches a digital output on, and off again after a time; the program goes on meanwhile.',
    ),
)
"""Inputs and outputs."""


class Signals:
    """Reads inputs and outputs, waits for inputs, and switches outputs.

    Args:
        run: The run.
        waits: How its functions wait.
        pulses: Outputs that switch off by themselves.
    """

    def __init__(self, run: RunContext, waits: Waits, pulses: OutputPulses) -> None:
        self._run, self._waits = run, waits
        self.handlers: Handlers = {
            'setDigitalOutput': lambda a: self._set_output('digital', a),
            'getDigitalInput': lambda a: bool(run.input('digital', a.values[0])),
            'getDigitalOutput': lambda a: bool(run.output('digital', a.values[0])),
            'setAnalogOutput': lambda a: self._set_output('analog', a),
            'getAnalogInput': lambda a: run.input('analog', a.values[0]),
            'getAnalogOutput': lambda a: run.output('analog', a.values[0]),
            'waitDigitalInput': self._wait_digital_input,
            'waitAnalogInput': self._wait_analog_input,
            'pulseDigitalOutput': lambda a: pulses.start(int(a.values[0]), a.values[1]),
        }

    def _set_output(self, kind: Kind, arguments: Arguments) -> None:
        index, value, moment = arguments.values
        if moment == 'arrival':
            self._run.cell.switch_at_target(OutputChange(kind, int(index), value, self._run.line))
        else:
            self._run.set_output(kind, int(index), value)

    def _wait_digital_input(self, arguments: Arguments) -> Waiting:
        index, value, timeout = arguments.values
        yield from self._waits.standstill()
        return (yield from self._waits.waiting(lambda: self._run.input('digital', index) == value, timeout))

    def _wait_analog_input(self, arguments: Arguments) -> Waiting:
        index, comparison, value, timeout = arguments.values
        yield from self._waits.standstill()
        compare = COMPARE[comparison]
        return (
            yield from self._waits.waiting(lambda: compare(self._run.input('analog', index), value), timeout)
        )
