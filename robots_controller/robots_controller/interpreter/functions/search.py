"""Search: a motion that a condition ends on its path."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from typing import Any, Final

from robots_controller.interpreter.functions.lua_function import Argument, Kind, LuaFunction
from robots_controller.interpreter.functions.motions import Motions
from robots_controller.interpreter.functions.run_context import Handlers, RunContext
from robots_controller.interpreter.lua_arguments import Arguments
from robots_controller.interpreter.lua_sandbox import LuaArgument, LuaCallError, LuaTable, Waiting
from robots_controller.interpreter.lua_values import Sizes, check_value
from robots_controller.interpreter.motion_options import Condition
from robots_core.errors import ProgramError

LOOK_PERIOD: Final = 0.004  # s, of measurements, whose changes nothing announces
_SOURCES: Final[dict[str, Kind]] = {
    'input': 'digital input',
    'analog_input': 'analog input',
    'joint_torque': 'count',
}
_BOUNDS: Final = ('above', 'below')
_VALID: Final = (
    '{input = index, value = true or false}, {analog_input = index, above | below = number}, or '
    '{joint_torque = joint, above | below = N m (N)}'
)

SEARCH: Final = (
    LuaFunction(
        'moveUntil',
        (
            Argument('condition', 'condition', '', _VALID),
            Argument('motion', 'motion', '', 'function that moves the robot; its arguments follow'),
        ),
        'Moves until a condition holds: the robot brakes on its path. moveUntil({input = 1}, linearRelative, '
        '0, 0, -0.1, 0, 0, 0).',
        'whether it held, the pose where the robot stands, the pose where it held',
        'boolean, Pose, Pose|nil',
        more=True,
    ),
)
"""Motions that end early."""

Check = Callable[[str, Sequence[LuaArgument]], Arguments]
"""Checks the arguments of a function by its name."""


class Search:
    """Searches by motions.

    Args:
        run: The run.
        motions: Moves the robot.
        sizes: What bounds arguments.
        check: Checks the arguments of the motion.
    """

    def __init__(self, run: RunContext, motions: Motions, sizes: Sizes, check: Check) -> None:
        self._run, self._motions, self._sizes, self._check = run, motions, sizes, check
        self.handlers: Handlers = {'moveUntil': self._move_until}

    def _move_until(self, arguments: Arguments) -> Waiting:
        table, name = arguments.values
        given = self._check(name, arguments.more)
        if given.options.blend:
            raise LuaCallError(f'moveUntil: {name} has a blend; a search ends where the robot stands')
        condition = self._condition(table)
        yield from self._motions.standstill()
        where = None
        if not condition.met():
            where = yield from self._motions.until(condition, name, given)
            met = where is not None
        else:
            met, where = True, self._motions.tool_pose()
        poses = (self._motions.tool_pose(), *(() if where is None else (where,)))
        return ((float(met),), *map(self._run.shown, poses))

    def _condition(self, table: LuaTable) -> Condition:
        fields = table.fields
        if (problem := wrong_condition(fields)) is not None:
            raise LuaCallError(f'moveUntil: {problem}')
        (source,) = (key for key in fields if key in _SOURCES)
        index = int(self._value(source, _SOURCES[source], fields))
        run = self._run
        if source == 'input':
            value = self._value('value', 'switch', fields) if 'value' in fields else 1.0
            return Condition(lambda: run.input('digital', index) == value)
        above = self._value('above', 'number', fields) if 'above' in fields else float('inf')
        below = self._value('below', 'number', fields) if 'below' in fields else -float('inf')
        if source == 'analog_input':
            return Condition(lambda: not below <= run.input('analog', index) <= above)
        if index > self._sizes.num_axes:
            raise ProgramError(f'joint_torque = {index}; the robot has {self._sizes.num_axes} axes')
        return Condition(lambda: not below <= run.cell.joint_torques()[index - 1] <= above, LOOK_PERIOD)

    def _value(self, key: str, kind: Kind, fields: dict[str, LuaArgument]) -> Any:
        return check_value(
            'moveUntil', f'condition.{key}', Argument(key, kind, '', ''), fields[key], self._sizes
        )


def wrong_condition(keys: Collection[str]) -> str | None:
    """What is wrong with the keys of a condition; None if nothing is."""
    sources, bounds = [key for key in keys if key in _SOURCES], [key for key in keys if key in _BOUNDS]
    others = set(keys) - set(sources) - set(bounds)
    if len(sources) == 1 and (
        (sources == ['input'] and not bounds and others <= {'value'})
        or (sources != ['input'] and bounds and not others)
    ):
        return None
    return f'condition has {", ".join(sorted(keys)) or "nothing"}; valid is {_VALID}'
