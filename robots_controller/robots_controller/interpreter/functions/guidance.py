"""Guidance: motions that a sensor or a person guides."""

from collections.abc import Callable
from typing import Final

from robots_controller.interpreter.functions.lua_function import Argument, LuaFunction
from robots_controller.interpreter.functions.run_context import Handlers, RunContext, Waits
from robots_controller.interpreter.lua_arguments import Arguments
from robots_controller.interpreter.lua_sandbox import Waiting
from robots_controller.program.guided_motion import GuidedMotion
from robots_core.blocks.following.guide import Guide

_HANDED_OVER: Final = (
    Argument('time', 'time', 's', 'longest time of it'),
    Argument('index', 'digital input', '', 'number or name of a digital input that ends it', optional=True),
    Argument('value', 'switch', '', 'the value of it that does', optional=True),
)

GUIDANCE: Final = (
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
)
"""Motions that a sensor or a person guides."""


class Guidance:
    """Hands the robot over.

    Args:
        run: The run.
        waits: How its functions wait.
        guided_motion: Hands the robot over, and takes it back.
    """

    def __init__(self, run: RunContext, waits: Waits, guided_motion: GuidedMotion) -> None:
        self._run, self._waits, self._guided_motion = run, waits, guided_motion
        self.handlers: Handlers = {
            'followReference': self._guided(Guide.SENSOR),
            'jog': self._guided(Guide.PERSON),
        }

    def _guided(self, guide: Guide) -> Callable[[Arguments], Waiting]:
        def serve(arguments: Arguments) -> Waiting:
            duration, index, value = arguments.values
            wanted = 1.0 if value is None else value
            yield from self._waits.standstill()

            def ended() -> bool:
                return index is not None and self._run.input('digital', index) == wanted

            result = yield from self._guided_motion.run(guide, ended, duration)
            self._run.target.forget()
            return result

        return serve
