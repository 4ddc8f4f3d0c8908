"""Settings: what holds for the motions of a program that follow."""

from dataclasses import replace
from typing import Any

import numpy as np

from robots_controller.interpreter import argument_kinds as kinds
from robots_controller.interpreter.functions.common_arguments import FRAME, SWITCH
from robots_controller.interpreter.functions.lua_function import A_POSE, Argument, lua_function
from robots_controller.interpreter.functions.run_context import Family
from robots_controller.interpreter.lua_sandbox import Result, Waiting
from robots_core.blocks.inverse_kinematics.hold import HOLDS
from robots_core.blocks.multibody.payload import payload_of
from robots_core.orientation import ORIENTATION_CONVENTIONS
from robots_core.pose import Pose


def _speeds(what: str, unit: str) -> tuple[Argument, ...]:
    on_paths = 'of the tool on Cartesian paths'
    return (
        Argument('fraction', kinds.FRACTION, '', f"part of the axes' limits of {what}", optional=True),
        Argument('cartesian', kinds.POSITIVE, f'm/{unit}', f'{what} {on_paths}', optional=True),
        Argument('rotation', kinds.POSITIVE, f'deg/{unit}', f'angular {what} {on_paths}', optional=True),
    )


class Settings(Family):
    """Sets and reads modal settings."""

    @lua_function(
        'setTool',
        'Sets the tool centre point, as a pose in tool0 (the flange); all poses are those of this point.',
        *FRAME,
    )
    def _set_tool(self, *values: float) -> None:
        tool = self._run.view.pose(values)
        self._run.change(tool=_seven(tool))
        self._run.target.tool = tool

    @lua_function(
        'setBase',
        "Sets the base frame, as a pose in the robot's own base; all poses are relative to it.",
        *FRAME,
    )
    def _set_base(self, *values: float) -> None:
        base = self._run.view.pose(values)
        self._run.change(base=_seven(base))
        self._run.target.base = base

    @lua_function(
        'setOrientationConvention',
        "Sets what orientation angles mean; without it they follow the robot's maker.",
        Argument('convention', kinds.CONVENTION, '', f'one of {", ".join(ORIENTATION_CONVENTIONS)}'),
    )
    def _set_convention(self, convention: str) -> None:
        self._run.view = replace(self._run.view, convention=convention)

    @lua_function(
        'setHold',
        "Sets which part of a pose motions reach: 'pose', 'position', or 'directions', which is the position "
        'and the part of the orientation that the arm can hold. The default depends on the number of axes.',
        Argument('hold', kinds.HOLD, '', f'one of {", ".join(HOLDS)}'),
    )
    def _set_hold(self, hold: str) -> None:
        self._run.change(hold=hold)

    @lua_function('getTool', 'Reads the tool.', returns=A_POSE)
    def _get_tool(self) -> Result:
        return (self._run.shown(self._run.target.tool),)

    @lua_function('getBase', 'Reads the base.', returns=A_POSE)
    def _get_base(self) -> Result:
        return (self._run.shown(self._run.target.base),)

    @lua_function(
        'getPayload',
        'Reads the payload: {mass, x, y, z}, kg and m.',
        returns=('a table of 4 numbers', 'number[]'),
    )
    def _get_payload(self) -> Result:
        payload: Any = self._run.settings.get('payload', self._run.cell.payload)
        return (tuple(payload[:4]),)

    @lua_function(
        'setPayload',
        'Sets the payload, mass and centre of mass, when the robot stands; it counts in all torques.',
        Argument('mass', kinds.NUMBER, 'kg', 'mass of what the flange carries: tool and workpiece'),
        *(
            Argument(axis, kinds.NUMBER, 'm', f'{axis} of its centre of mass, seen from tool0', optional=True)
            for axis in 'xyz'
        ),
    )
    def _set_payload(self, *values: float | None) -> Waiting:
        payload = tuple(value or 0.0 for value in values)
        payload_of(payload)
        yield from self._run.waits.standstill()
        self._run.change(payload=payload)
        return None

    @lua_function(
        'setOverride',
        'Scales the speed of all motions, also of the one under way; at 0 the robot stands still.',
        Argument('value', kinds.SCALE, '', 'speed scale of all motions, 0 to 1, at once'),
    )
    def _set_override(self, value: float) -> None:
        self._run.state.overrides = np.full(self._run.state.num_axes, value)
        self._run.cell.set_override(value)

    @lua_function(
        'setSpeed', 'Sets speed limits of the next motions; nil leaves one as it is.', *_speeds('speed', 's')
    )
    def _set_speed(self, *limits: float | None) -> None:
        self._set_limits('speed', limits)

    @lua_function(
        'setPlanner',
        'Chooses the planners of the next motions; nil leaves one as it is.',
        Argument('joint', kinds.JOINT_PLANNER, '', 'planner of joint motions', optional=True),
        Argument('cartesian', kinds.CARTESIAN_PLANNER, '', 'planner of Cartesian motions', optional=True),
    )
    def _set_planner(self, joint: str | None, cartesian: str | None) -> None:
        # Checked already, by name: loading planners takes half a second.
        self._run.settings |= _given(joint_planner=joint, cartesian_planner=cartesian)

    @lua_function(
        'setConfiguration',
        'Chooses the configuration in which joint motions reach a pose; without one, the nearest.',
        Argument('configuration', kinds.CONFIGURATION, '', "as 'front/up/no_flip'", optional=True),
    )
    def _set_configuration(self, configuration: str | None) -> None:
        self._run.change(configuration=configuration or '')

    @lua_function(
        'setJerkLimited',
        'Switches jerk limits on or off for Cartesian motions and blended chains.',
        SWITCH,
    )
    def _set_jerk_limited(self, value: float) -> None:
        self._run.change(jerk_limited=bool(value))

    @lua_function(
        'setAcceleration',
        'Sets acceleration limits of the next motions; nil leaves one as it is.',
        *_speeds('acceleration', 's^2'),
    )
    def _set_acceleration(self, *limits: float | None) -> None:
        self._set_limits('acceleration', limits)

    def _set_limits(self, what: str, limits: tuple[float | None, ...]) -> None:
        names = (f'{what}_fraction', f'cartesian_{what}', f'rotation_{what}')
        self._run.change(**_given(**dict(zip(names, limits, strict=True))))


def _given(**settings: Any) -> dict[str, Any]:
    """Settings without those that were left out."""
    return {name: value for name, value in settings.items() if value is not None}


def _seven(pose: Pose) -> tuple[float, ...]:
    return (*pose.r.tolist(), *pose.quaternion().tolist())
