"""Settings: what holds for the motions of a program that follow."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Final

import numpy as np

from robots_controller.interpreter.functions.common_arguments import FRAME, SWITCH
from robots_controller.interpreter.functions.lua_function import Argument, LuaFunction
from robots_controller.interpreter.functions.run_context import Handlers, RunContext, Waits
from robots_controller.interpreter.lua_arguments import Arguments
from robots_controller.interpreter.lua_sandbox import Result, Waiting
from robots_core.blocks.inverse_kinematics.hold import HOLDS
from robots_core.blocks.multibody.payload import payload_of
from robots_core.orientation import ORIENTATION_CONVENTIONS
from robots_core.pose import Pose


def _speeds(what: str, unit: str) -> tuple[Argument, ...]:
    return (
        Argument('fraction', 'fraction', '', f"part of the axes' limits of {what}", optional=True),
        Argument(
            'cartesian', 'positive', f'm/{unit}', f'{what} of the tool on Cartesian paths', optional=True
        ),
        Argument(
            'rotation',
            'positive',
            f'deg/{unit}',
            f'angular {what} of the tool on Cartesian paths',
            optional=True,
        ),
    )


SETTINGS: Final = (
    LuaFunction(
        'setTool', FRAME, 'Sets the tool: its tip seen from the flange (tool0); poses are of the tip.'
    ),
    LuaFunction(
        'setBase', FRAME, "Sets the base: a frame seen from the robot's base; poses are seen from it."
    ),
    LuaFunction(
        'setOrientationConvention',
        (Argument('convention', 'convention', '', f'one of {", ".join(ORIENTATION_CONVENTIONS)}'),),
        "Sets what orientation angles mean; without it they follow the robot's maker.",
    ),
    LuaFunction(
        'setHold',
        (Argument('hold', 'hold', '', f'one of {", ".join(HOLDS)}'),),
        "Sets what motions to poses hold: 'pose'; 'directions': the position, and of the orientation what "
        "the arm can; or 'position'. Without it an arm holds what it can.",
    ),
    LuaFunction('getTool', (), 'Reads the tool.', 'a pose', 'Pose'),
    LuaFunction('getBase', (), 'Reads the base.', 'a pose', 'Pose'),
    LuaFunction(
        'getPayload',
        (),
        'Reads what the flange carries: {mass, x, y, z}, kg and m.',
        'a table of 4 numbers',
        'number[]',
    ),
    LuaFunction(
        'setPayload',
        (
            Argument('mass', 'number', 'kg', 'mass of what the flange carries: tool and workpiece'),
            *(
                Argument(axis, 'number', 'm', f'{axis} of its centre of mass, seen from tool0', optional=True)
                for axis in 'xyz'
            ),
        ),
        'Sets what the flange carries, when the robot stands; it counts in all torques.',
    ),
    LuaFunction(
        'setOverride',
        (Argument('value', 'scale', '', 'speed scale of all motions, 0 to 1, at once'),),
        'Scales the speed, also of the motion under way; 0 stands still.',
    ),
    LuaFunction(
        'setSpeed', _speeds('speed', 's'), 'Sets speed limits of the next motions; nil leaves one as it is.'
    ),
    LuaFunction(
        'setPlanner',
        (
            Argument('joint', 'joint_planner', '', 'planner of joint motions', optional=True),
            Argument('cartesian', 'cartesian_planner', '', 'planner of Cartesian motions', optional=True),
        ),
        'Chooses the planners of the next motions; nil leaves one as it is.',
    ),
    LuaFunction(
        'setConfiguration',
        (Argument('configuration', 'configuration', '', "as 'front/up/no_flip'", optional=True),),
        'Chooses the configuration that joint motions to a pose end in; without one, the nearest.',
    ),
    LuaFunction(
        'setJerkLimited',
        (SWITCH,),
        'Keeps the jerk limits of the axes on Cartesian motions and in blended chains too, or not.',
    ),
    LuaFunction(
        'setAcceleration',
        _speeds('acceleration', 's^2'),
        'Sets acceleration limits of the next motions; nil leaves one as it is.',
    ),
)
"""What holds for the motions that follow."""


class Settings:
    """Sets and reads modal settings.

    Args:
        run: The run.
        waits: How its functions wait.
    """

    def __init__(self, run: RunContext, waits: Waits) -> None:
        self._run, self._waits = run, waits
        self.handlers: Handlers = {
            'setTool': self._set_tool,
            'setBase': self._set_base,
            'setOrientationConvention': self._set_convention,
            'setHold': lambda a: run.change(hold=a.values[0]),
            'setPayload': self._set_payload,
            'getTool': lambda _: (run.shown(run.target.tool),),
            'getBase': lambda _: (run.shown(run.target.base),),
            'getPayload': self._get_payload,
            'setOverride': self._set_override,
            'setSpeed': self._set_limits('speed'),
            'setAcceleration': self._set_limits('acceleration'),
            'setPlanner': self._set_planner,
            'setConfiguration': lambda a: run.change(configuration=a.values[0] or ''),
            'setJerkLimited': lambda a: run.change(jerk_limited=bool(a.values[0])),
        }

    def _set_tool(self, arguments: Arguments) -> None:
        tool = self._run.view.pose(arguments.values)
        self._run.change(tool=_seven(tool))
        self._run.target.tool = tool

    def _set_base(self, arguments: Arguments) -> None:
        base = self._run.view.pose(arguments.values)
        self._run.change(base=_seven(base))
        self._run.target.base = base

    def _set_convention(self, arguments: Arguments) -> None:
        self._run.view = replace(self._run.view, convention=arguments.values[0])

    def _set_payload(self, arguments: Arguments) -> Waiting:
        payload = tuple(value or 0.0 for value in arguments.values)
        payload_of(payload)
        yield from self._waits.standstill()
        self._run.change(payload=payload)
        return None

    def _get_payload(self, _: Arguments) -> Result:
        payload: Any = self._run.settings.get('payload', self._run.cell.payload)
        return (tuple(payload[:4]),)

    def _set_override(self, arguments: Arguments) -> None:
        self._run.state.set_overrides(np.full(self._run.state.num_axes, arguments.values[0]))
        self._run.cell.set_override(arguments.values[0])

    def _set_planner(self, arguments: Arguments) -> None:
        # Checked already, by name: loading planners takes half a second.
        self._run.settings |= _given(('joint_planner', 'cartesian_planner'), arguments)

    def _set_limits(self, what: str) -> Callable[[Arguments], None]:
        names = (f'{what}_fraction', f'cartesian_{what}', f'rotation_{what}')

        def set_limits(arguments: Arguments) -> None:
            self._run.change(**_given(names, arguments))

        return set_limits


def _given(names: tuple[str, ...], arguments: Arguments) -> dict[str, Any]:
    """Arguments by these names, without those that were left out."""
    return {name: v for name, v in zip(names, arguments.values, strict=True) if v is not None}


def _seven(pose: Pose) -> tuple[float, ...]:
    return (*pose.r.tolist(), *pose.quaternion().tolist())
