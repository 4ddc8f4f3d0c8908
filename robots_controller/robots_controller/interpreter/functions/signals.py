"""Signals: inputs and outputs."""

import operator
from collections.abc import Callable, Mapping
from typing import Final

from robots_controller.interpreter import argument_kinds as kinds
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
from robots_controller.interpreter.functions.lua_function import (
    A_NUMBER,
    TRUE_OR_FALSE,
    Argument,
    lua_function,
)
from robots_controller.interpreter.functions.run_context import Family
from robots_controller.interpreter.lua_sandbox import Result, Waiting
from robots_controller.program.motion_command import Kind, OutputChange

COMPARE: Final[Mapping[str, Callable[[float, float], bool]]] = {
    '<': operator.lt,
    '<=': operator.le,
    '>': operator.gt,
    '>=': operator.ge,
    '==': operator.eq,
    '~=': operator.ne,
}
_CAME: Final = ('true, or false after `timeout`', 'boolean')


class Signals(Family):
    """Reads inputs and outputs, waits for inputs, and switches outputs."""

    @lua_function(
        'setDigitalOutput',
        'Switches a digital output, now or when the robot is at the last target; the program goes on.',
        DIGITAL_OUTPUT,
        SWITCH,
        MOMENT,
    )
    def _set_digital_output(self, index: float, value: float, moment: str | None) -> None:
        self._set_output('digital', index, value, moment)

    @lua_function('getDigitalInput', 'Reads a digital input.', DIGITAL_INPUT, returns=TRUE_OR_FALSE)
    def _get_digital_input(self, index: float) -> Result:
        return bool(self._run.input('digital', index))

    @lua_function('getDigitalOutput', 'Reads a digital output back.', DIGITAL_OUTPUT, returns=TRUE_OR_FALSE)
    def _get_digital_output(self, index: float) -> Result:
        return bool(self._run.output('digital', index))

    @lua_function(
        'setAnalogOutput',
        'Sets an analog output, now or when the robot is at the last target; the program goes on.',
        ANALOG_OUTPUT,
        Argument('value', kinds.NUMBER, '', 'value of the output'),
        MOMENT,
    )
    def _set_analog_output(self, index: float, value: float, moment: str | None) -> None:
        self._set_output('analog', index, value, moment)

    @lua_function('getAnalogInput', 'Reads an analog input.', ANALOG_INPUT, returns=A_NUMBER)
    def _get_analog_input(self, index: float) -> Result:
        return self._run.input('analog', index)

    @lua_function('getAnalogOutput', 'Reads an analog output back.', ANALOG_OUTPUT, returns=A_NUMBER)
    def _get_analog_output(self, index: float) -> Result:
        return self._run.output('analog', index)

    @lua_function(
        'waitDigitalInput',
        'Waits until a digital input has a value.',
        DIGITAL_INPUT,
        SWITCH,
        TIMEOUT,
        returns=_CAME,
    )
    def _wait_digital_input(self, index: float, value: float, timeout: float | None) -> Waiting:
        yield from self._run.waits.standstill()
        return (
            yield from self._run.waits.waiting(lambda: self._run.input('digital', index) == value, timeout)
        )

    @lua_function(
        'waitAnalogInput',
        "Waits until an analog input compares: waitAnalogInput(1, '>', 2.5).",
        ANALOG_INPUT,
        *COMPARISON,
        TIMEOUT,
        returns=_CAME,
    )
    def _wait_analog_input(
        self, index: float, comparison: str, value: float, timeout: float | None
    ) -> Waiting:
        yield from self._run.waits.standstill()
        compare = COMPARE[comparison]
        return (
            yield from self._run.waits.waiting(
                lambda: compare(self._run.input('analog', index), value), timeout
            )
        )

    @lua_function(
        'pulseDigitalOutput',
        'Switches a digital output on, and off again after a time; the program goes on meanwhile.',
        DIGITAL_OUTPUT,
        Argument('time', kinds.TIME, 's', 'how long it is on'),
    )
    def _pulse_digital_output(self, index: float, time: float) -> None:
        self._run.pulses.start(int(index), time)

    def _set_output(self, kind: Kind, index: float, value: float, moment: str | None) -> None:
        if moment == 'arrival':
            self._run.cell.switch_at_target(OutputChange(kind, int(index), value, self._run.line))
        else:
            self._run.set_output(kind, int(index), value)
