"""Signals: inputs and outputs."""

from collections.abc import Callable
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
from robots_controller.program.motions.motion_command import Kind, OutputChange

_CAME: Final = ('true, or false after `timeout`', 'boolean')


class Signals(Family):
    """Reads inputs and outputs, waits for inputs, and switches outputs."""

    @lua_function(DIGITAL_OUTPUT, SWITCH, MOMENT)
    def setDigitalOutput(self, index: float, value: float, moment: str | None) -> None:
        """Switches a digital output, now or when the robot is at the last target; the program continues."""
        self._set_output('digital', index, value, moment)

    @lua_function(DIGITAL_INPUT, returns=TRUE_OR_FALSE)
    def getDigitalInput(self, index: float) -> Result:
        """Reads a digital input."""
        return bool(self._run.input('digital', index))

    @lua_function(DIGITAL_OUTPUT, returns=TRUE_OR_FALSE)
    def getDigitalOutput(self, index: float) -> Result:
        """Reads a digital output back."""
        return bool(self._run.output('digital', index))

    @lua_function(ANALOG_OUTPUT, Argument('value', kinds.NUMBER, '', 'value of the output'), MOMENT)
    def setAnalogOutput(self, index: float, value: float, moment: str | None) -> None:
        """Sets an analog output, now or when the robot is at the last target; the program continues."""
        self._set_output('analog', index, value, moment)

    @lua_function(ANALOG_INPUT, returns=A_NUMBER)
    def getAnalogInput(self, index: float) -> Result:
        """Reads an analog input."""
        return self._run.input('analog', index)

    @lua_function(ANALOG_OUTPUT, returns=A_NUMBER)
    def getAnalogOutput(self, index: float) -> Result:
        """Reads an analog output back."""
        return self._run.output('analog', index)

    @lua_function(DIGITAL_INPUT, SWITCH, TIMEOUT, returns=_CAME)
    def waitDigitalInput(self, index: float, value: float, timeout: float | None) -> Waiting:
        """Waits until a digital input has a value."""
        return self._wait(lambda: self._run.input('digital', index) == value, timeout)

    @lua_function(ANALOG_INPUT, *COMPARISON, TIMEOUT, returns=_CAME)
    def waitAnalogInput(self, index: float, comparison: str, value: float, timeout: float | None) -> Waiting:
        """Waits until an analog input compares.

        As waitAnalogInput(1, '>', 2.5).
        """
        compare = kinds.COMPARISONS[comparison]
        return self._wait(lambda: compare(self._run.input('analog', index), value), timeout)

    @lua_function(DIGITAL_OUTPUT, Argument('time', kinds.TIME, 's', 'how long it is on'))
    def pulseDigitalOutput(self, index: float, time: float) -> None:
        """Switches a digital output on, and off again after a time; the program continues meanwhile."""
        self._run.pulses.start(int(index), time)

    def _wait(self, came: Callable[[], bool], timeout: float | None) -> Waiting:
        yield from self._run.waits.standstill()
        return (yield from self._run.waits.waiting(came, timeout))

    def _set_output(self, kind: Kind, index: float, value: float, moment: str | None) -> None:
        if moment == 'arrival':
            self._run.cell.switch_at_target(OutputChange(kind, int(index), value, self._run.line))
        else:
            self._run.set_output(kind, int(index), value)
