"""Kinematics: from joint angles to poses of the tool, and back."""

from typing import Final

from robots_controller.degrees import joints_to_program
from robots_controller.interpreter.functions.common_arguments import JOINTS, POSE
from robots_controller.interpreter.functions.lua_function import Argument, LuaFunction
from robots_controller.interpreter.functions.run_context import Handlers, RunContext
from robots_controller.interpreter.lua_arguments import Arguments
from robots_controller.interpreter.lua_sandbox import Result
from robots_core.errors import UnreachablePoseError
from robots_core.pose import Pose
from robots_core.validation import Array, read_only

_NEAR: Final = Argument(
    'near', 'joints', 'deg (m)', 'joint angles to search from; the last target by default', optional=True
)
KINEMATICS: Final = (
    LuaFunction(
        'forwardKinematics', (JOINTS,), 'Computes where joint angles lead the tool.', 'a pose', 'Pose'
    ),
    LuaFunction(
        'inverseKinematics',
        (*POSE, _NEAR),
        'Computes the joint angles that ptpJointSpacePosition would lead to; fails where there are none.',
        'a table of n numbers',
        'number[]',
    ),
    LuaFunction(
        'isReachable',
        (*POSE, _NEAR),
        'Looks whether joint angles inside the limits lead the tool to a pose.',
        'true or false',
        'boolean',
    ),
)
"""From joint angles to poses, and back."""


class Kinematics:
    """Computes with the tool and base that are set.

    Args:
        run: The run.
    """

    def __init__(self, run: RunContext) -> None:
        self._run = run
        self.handlers: Handlers = {
            'forwardKinematics': self._forward,
            'inverseKinematics': self._inverse,
            'isReachable': self._is_reachable,
        }

    def _forward(self, arguments: Arguments) -> Result:
        flange = self._run.view.flange(read_only(arguments.values))
        return (self._run.shown(self._run.target.seen(flange)),)

    def _inverse(self, arguments: Arguments) -> Result:
        return (joints_to_program(self._joints(arguments), self._run.view.prismatic),)

    def _is_reachable(self, arguments: Arguments) -> Result:
        try:
            self._joints(arguments)
        except UnreachablePoseError:
            return False
        return True

    def _joints(self, arguments: Arguments) -> Array:
        *values, near = arguments.values
        pose: Pose = self._run.view.pose(values)
        start = self._run.target.joints() if near is None else read_only(near)
        return self._run.cell.inverse_kinematics(pose, start, self._run.settings)
