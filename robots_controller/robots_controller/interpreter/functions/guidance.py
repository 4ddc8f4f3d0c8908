"""Guidance: motions that a sensor or a person guides."""

from typing import Final

from robots_controller.interpreter import argument_kinds as kinds
from robots_controller.interpreter.functions.lua_function import Argument, lua_function
from robots_controller.interpreter.functions.run_context import Family
from robots_controller.interpreter.lua_sandbox import Waiting
from robots_core.blocks.following.guide import Guide

_HANDED_OVER: Final = (
    Argument('time', kinds.TIME, 's', 'longest time of it'),
    Argument(
        'index', kinds.DIGITAL_INPUT, '', 'number or name of a digital input that ends it', optional=True
    ),
    Argument('value', kinds.SWITCH, '', 'the value of it that does', optional=True),
)
_ENDED: Final = ('true if the input ended it, false after `time`', 'boolean')


class Guidance(Family):
    """Hands the robot over."""

    @lua_function(*_HANDED_OVER, returns=_ENDED)
    def followReference(self, time: float, index: float | None, value: float | None) -> Waiting:
        """Lets `reference_pose` guide the robot (state TRAJECTORY)."""
        return self._guided(Guide.SENSOR, time, index, value)

    @lua_function(*_HANDED_OVER, returns=_ENDED)
    def jog(self, time: float, index: float | None, value: float | None) -> Waiting:
        """Lets a person jog the robot (state TEACH)."""
        return self._guided(Guide.PERSON, time, index, value)

    def _guided(self, guide: Guide, time: float, index: float | None, value: float | None) -> Waiting:
        wanted = 1.0 if value is None else value
        yield from self._run.waits.standstill()

        def ended() -> bool:
            return index is not None and self._run.input('digital', index) == wanted

        result = yield from self._run.guided.run(guide, ended, time)
        self._run.target.forget()
        return result
