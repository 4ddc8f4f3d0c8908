"""Settings: what holds for the motions of a program that follow."""

from collections.abc import Generator
from dataclasses import replace
from typing import Any

import numpy as np

from robots_controller.interpreter import argument_kinds as kinds
from robots_controller.interpreter.functions.common_arguments import FRAME, SWITCH
from robots_controller.interpreter.functions.lua_function import A_POSE, Argument, lua_function
from robots_controller.interpreter.functions.run_context import Family
from robots_controller.interpreter.lua_sandbox import Result, Waiting
from robots_controller.program.files.cell_frames import CellFrames, FrameKind, check_frame
from robots_core.blocks.inverse_kinematics.hold import HOLDS
from robots_core.blocks.multibody.payload import payload_of
from robots_core.orientation import ORIENTATION_CONVENTIONS
from robots_core.pose import Pose
from robots_planning.motion_settings import ON_BLOCKED, frame_numbers


def _speeds(what: str, unit: str) -> tuple[Argument, ...]:
    on_paths = 'of the tool on Cartesian paths'
    return (
        Argument('fraction', kinds.FRACTION, '', f"part of the axes' limits of {what}", optional=True),
        Argument('cartesian', kinds.POSITIVE, f'm/{unit}', f'{what} {on_paths}', optional=True),
        Argument('rotation', kinds.POSITIVE, f'deg/{unit}', f'angular {what} {on_paths}', optional=True),
    )


class Settings(Family):
    """Sets and reads modal settings."""

    @lua_function(*FRAME, by_name=Argument('name', kinds.TOOL, '', 'name of a tool of the frames file'))
    def setTool(self, *values: Any) -> Waiting:
        """Sets the tool centre point, as a pose in tool0 (the flange); all poses are those of this point.

        A name alone, `setTool('gripper')`, is that of a tool of the frames file; where that has its payload,
        it is set too, as by setPayload.
        """
        tool = self._run.view.pose(values) if len(values) > 1 else (yield from self._named_tool(values[0]))
        self._run.change(tool=frame_numbers(tool))
        self._run.target.tool = tool
        return None

    @lua_function(*FRAME, by_name=Argument('name', kinds.BASE, '', 'name of a base of the frames file'))
    def setBase(self, *values: Any) -> None:
        """Sets the base frame, as a pose in the robot's own base; all poses are relative to it.

        A name alone, `setBase('table')`, is that of a base of the frames file.
        """
        view = self._run.view
        base = view.pose(values) if len(values) > 1 else self._named('base', values[0]).bases[values[0]]
        self._run.change(base=frame_numbers(base))
        self._run.target.base = base

    @lua_function(
        Argument('convention', kinds.CONVENTION, '', f'one of {", ".join(ORIENTATION_CONVENTIONS)}')
    )
    def setOrientationConvention(self, convention: str) -> None:
        """Sets what orientation angles mean; without it they follow the robot's maker."""
        self._run.view = replace(self._run.view, convention=convention)

    @lua_function(Argument('hold', kinds.HOLD, '', f'one of {", ".join(HOLDS)}'))
    def setHold(self, hold: str) -> None:
        """Sets which part of a pose motions reach; the default depends on the number of axes.

        Valid are 'pose', 'position', and 'directions', which is the position and the part of the orientation
        that the arm can hold.
        """
        self._run.change(hold=hold)

    @lua_function(returns=A_POSE)
    def getTool(self) -> Result:
        """Reads the tool."""
        return (self._run.shown(self._run.target.tool),)

    @lua_function(returns=A_POSE)
    def getBase(self) -> Result:
        """Reads the base."""
        return (self._run.shown(self._run.target.base),)

    @lua_function(returns=('a table of 4 numbers', 'number[]'))
    def getPayload(self) -> Result:
        """Reads the payload: {mass, x, y, z}, kg and m."""
        return (self._payload[:4],)

    @lua_function(
        Argument('mass', kinds.NUMBER, 'kg', 'mass of what the flange carries: tool and workpiece'),
        *(
            Argument(axis, kinds.NUMBER, 'm', f'{axis} of its centre of mass, seen from tool0', optional=True)
            for axis in 'xyz'
        ),
    )
    def setPayload(self, *values: float | None) -> Waiting:
        """Sets the payload, mass and centre of mass, when the robot stands; it counts in all torques."""
        payload = tuple(value or 0.0 for value in values)
        payload_of(payload)
        yield from self._carry(payload)
        return None

    @lua_function(Argument('value', kinds.SCALE, '', 'speed scale of all motions, 0 to 1, at once'))
    def setOverride(self, value: float) -> None:
        """Scales the speed of all motions, also of the one under way; at 0 the robot stands still."""
        self._run.state.overrides = np.full(self._run.state.num_axes, value)
        self._run.cell.controller.set_override(value)

    @lua_function(*_speeds('speed', 's'))
    def setSpeed(self, *limits: float | None) -> None:
        """Sets speed limits of the next motions; nil leaves one as it is."""
        self._set_limits('speed', limits)

    @lua_function(
        Argument('joint', kinds.JOINT_PLANNER, '', 'planner of joint motions', optional=True),
        Argument('cartesian', kinds.CARTESIAN_PLANNER, '', 'planner of Cartesian motions', optional=True),
    )
    def setPlanner(self, joint: str | None, cartesian: str | None) -> None:
        """Chooses the planners of the next motions; nil leaves one as it is."""
        # Checked already, by name: loading planners takes half a second.
        self._run.settings |= _given(joint_planner=joint, cartesian_planner=cartesian)

    @lua_function(Argument('configuration', kinds.CONFIGURATION, '', "as 'front/up/no_flip'", optional=True))
    def setConfiguration(self, configuration: str | None) -> None:
        """Chooses the configuration in which joint motions reach a pose; without one, the nearest."""
        self._run.change(configuration=configuration or '')

    @lua_function(SWITCH)
    def setJerkLimited(self, value: float) -> None:
        """Switches jerk limits on or off for Cartesian motions, blended chains and motions with `avoid`."""
        self._run.change(jerk_limited=bool(value))

    @lua_function(
        SWITCH,
        Argument('budget', kinds.POSITIVE, 's', 'longest search for a path around obstacles', optional=True),
        Argument('on_blocked', kinds.ON_BLOCKED, '', f'one of {", ".join(ON_BLOCKED)}', optional=True),
        Argument('most', kinds.COUNT, '', 'how often one motion may be replanned', optional=True),
    )
    def setAvoid(
        self, value: float, budget: float | None, on_blocked: str | None, most: float | None
    ) -> None:
        """Lets joint motions go around obstacles.

        A search counts postures, 25 000 a second of its budget, and not time: a slow computer finds the same.
        An obstacle that comes into the path of such a motion stops it; with 'replan' it then goes around that
        from where the robot stands, at most `most` times (5).
        """
        count = None if most is None else int(most)
        given = _given(avoid_budget=budget, on_blocked=on_blocked, most_replans=count)
        self._run.change(avoid=bool(value), **given)

    @lua_function(*_speeds('acceleration', 's^2'))
    def setAcceleration(self, *limits: float | None) -> None:
        """Sets acceleration limits of the next motions; nil leaves one as it is."""
        self._set_limits('acceleration', limits)

    def _named(self, kind: FrameKind, name: str) -> CellFrames:
        return check_frame(self._run.view.frames_file, kind, name)

    def _named_tool(self, name: str) -> Generator[None, None, Pose]:
        tool = self._named('tool', name).tools[name]
        if tool.payload not in ((), self._payload):
            yield from self._carry(tool.payload)
        return tool.pose

    @property
    def _payload(self) -> tuple[float, ...]:
        payload: Any = self._run.settings.get('payload', self._run.cell.payload)
        return tuple(payload)

    def _carry(self, payload: tuple[float, ...]) -> Generator[None, None, None]:
        yield from self._run.waits.standstill()
        self._run.change(payload=payload)

    def _set_limits(self, what: str, limits: tuple[float | None, ...]) -> None:
        names = (f'{what}_fraction', f'cartesian_{what}', f'rotation_{what}')
        self._run.change(**_given(**dict(zip(names, limits, strict=True))))


def _given(**settings: Any) -> dict[str, Any]:
    """Settings without those that were left out."""
    return {name: value for name, value in settings.items() if value is not None}
