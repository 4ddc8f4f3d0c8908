"""Search: a motion that a condition ends on its path."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Final

from robots_controller.interpreter import argument_kinds as kinds
from robots_controller.interpreter.argument_kinds import ArgumentKind, Sizes
from robots_controller.interpreter.functions.lua_function import Argument, lua_function
from robots_controller.interpreter.functions.motions import Motions
from robots_controller.interpreter.functions.run_context import Family, RunContext
from robots_controller.interpreter.lua_arguments import Arguments
from robots_controller.interpreter.lua_sandbox import LuaArgument, LuaCallError, LuaTable, Waiting
from robots_controller.interpreter.lua_values import check_value
from robots_controller.interpreter.motion_options import Condition

CHECK_PERIOD: Final = 0.004  # s, of measurements, whose changes nothing announces
_SOURCES: Final[dict[str, ArgumentKind]] = {
    'input': kinds.DIGITAL_INPUT,
    'analog_input': kinds.ANALOG_INPUT,
    'joint_torque': kinds.COUNT,
}
_FIELDS: Final = {**_SOURCES, 'value': kinds.SWITCH, 'above': kinds.NUMBER, 'below': kinds.NUMBER}
_VALID: Final = (
    '{input = index, value = true or false}, {analog_input = index, above | below = number}, or '
    '{joint_torque = joint, above | below = N m (N)}'
)

Check = Callable[[str, Sequence[LuaArgument]], Arguments]
"""Checks the arguments of a function by its name."""


class Search(Family):
    """Searches by motions."""

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
        fields, run = checked_condition(table, self._sizes), self._run
        if 'input' in fields:
            index, value = int(fields['input']), fields.get('value', 1.0)
            return Condition(lambda: run.input('digital', index) == value)
        above, below = fields.get('above', math.inf), fields.get('below', -math.inf)
        if 'analog_input' in fields:
            index = int(fields['analog_input'])
            return Condition(lambda: not below <= run.input('analog', index) <= above)
        joint = int(fields['joint_torque']) - 1
        return Condition(
            lambda: not below <= run.cell.robot.joint_feedback().measured_torque[joint] <= above, CHECK_PERIOD
        )


def checked_condition(table: LuaTable, sizes: Sizes) -> dict[str, float]:
    """The fields of a condition: one source, and its value or bounds.

    Raises:
        LuaCallError: other fields, or a value that one cannot have.
    """
    keys = table.fields.keys()
    others = keys - _SOURCES.keys()
    valid = others <= {'value'} if 'input' in keys else others and others <= {'above', 'below'}
    if not valid or len(keys - others) != 1:
        raise LuaCallError(
            f'moveUntil: condition has {", ".join(sorted(keys)) or "nothing"}; valid is {_VALID}'
        )
    values: dict[str, float] = {
        key: check_value('moveUntil', f'condition.{key}', Argument(key, _FIELDS[key]), given, sizes)
        for key, given in table.fields.items()
    }
    if (joint := int(values.get('joint_torque', 0))) > sizes.num_axes:
        raise LuaCallError(f'moveUntil: joint_torque = {joint}; the robot has {sizes.num_axes} axes')
    return values
