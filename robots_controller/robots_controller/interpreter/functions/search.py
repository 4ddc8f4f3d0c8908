"""Search: a motion that a condition ends on its path."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from typing import Any, Final

from robots_controller.interpreter import argument_kinds as kinds
from robots_controller.interpreter.argument_kinds import ArgumentKind, Sizes
from robots_controller.interpreter.functions.lua_function import Argument, lua_function
from robots_controller.interpreter.functions.motions import Motions
from robots_controller.interpreter.functions.run_context import Family, RunContext
from robots_controller.interpreter.lua_arguments import Arguments
from robots_controller.interpreter.lua_sandbox import LuaArgument, LuaCallError, LuaTable, Waiting
from robots_controller.interpreter.lua_values import check_value
from robots_controller.interpreter.motion_options import Condition
from robots_core.errors import ProgramError

LOOK_PERIOD: Final = 0.004  # s, of measurements, whose changes nothing announces
_SOURCES: Final[dict[str, ArgumentKind]] = {
    'input': kinds.DIGITAL_INPUT,
    'analog_input': kinds.ANALOG_INPUT,
    'joint_torque': kinds.COUNT,
}
_BOUNDS: Final = ('above', 'below')
_VALID: Final = (
    '{input = index, value = true or false}, {analog_input = index, above | below = number}, or '
    '{joint_torque = joint, above | below = N m (N)}'
)

Check = Callable[[str, Sequence[LuaArgument]], Arguments]
"""Checks the arguments of a function by its name."""


class Search(Family):
    """Searches by motions.

    Args:
        run: The run.
        motions: Moves the robot.
        sizes: What bounds arguments.
        check: Checks the arguments of the motion.
    """

    def __init__(self, run: RunContext, motions: Motions, sizes: Sizes, check: Check) -> None:
        super().__init__(run)
        self._motions, self._sizes, self._check = motions, sizes, check

    @lua_function(
        Argument('condition', kinds.CONDITION, '', _VALID),
        Argument('motion', kinds.MOTION, '', 'function that moves the robot; its arguments follow'),
        returns=(
            'whether it held, the pose where the robot stands, the pose where it held',
            'boolean, Pose, Pose|nil',
        ),
        more=True,
    )
    def moveUntil(self, table: LuaTable, name: str, *more: LuaArgument) -> Waiting:
        """Moves until a condition holds: the robot brakes on its path.

        As moveUntil({input = 1}, linearRelative, 0, 0, -0.1, 0, 0, 0).
        """
        given = self._check(name, more)
        assert given.options is not None
        if given.options.blend:
            raise LuaCallError(f'moveUntil: {name} has a blend; a search ends where the robot stands')
        condition = self._condition(table)
        yield from self._motions.standstill()
        where = None
        if not condition.met():
            where = yield from self._motions.until(condition, name, given)
            met = where is not None
        else:
            met, where = True, self._run.tool_pose()
        poses = (self._run.tool_pose(), *(() if where is None else (where,)))
        return ((float(met),), *map(self._run.shown, poses))

    def _condition(self, table: LuaTable) -> Condition:
        fields = table.fields
        if (problem := wrong_condition(fields)) is not None:
            raise LuaCallError(f'moveUntil: {problem}')
        (source,) = (key for key in fields if key in _SOURCES)
        index = int(self._value(source, _SOURCES[source], fields))
        run = self._run
        if source == 'input':
            value = self._value('value', kinds.SWITCH, fields) if 'value' in fields else 1.0
            return Condition(lambda: run.input('digital', index) == value)
        above = self._value('above', kinds.NUMBER, fields) if 'above' in fields else float('inf')
        below = self._value('below', kinds.NUMBER, fields) if 'below' in fields else -float('inf')
        if source == 'analog_input':
            return Condition(lambda: not below <= run.input('analog', index) <= above)
        if index > self._sizes.num_axes:
            raise ProgramError(f'joint_torque = {index}; the robot has {self._sizes.num_axes} axes')
        return Condition(lambda: not below <= run.cell.joint_torques()[index - 1] <= above, LOOK_PERIOD)

    def _value(self, key: str, kind: ArgumentKind, fields: dict[str, LuaArgument]) -> Any:
        return check_value('moveUntil', f'condition.{key}', Argument(key, kind), fields[key], self._sizes)


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
