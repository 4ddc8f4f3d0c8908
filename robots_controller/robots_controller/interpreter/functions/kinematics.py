"""Kinematics: from joint angles to poses of the tool, and back."""

from collections.abc import Sequence
from typing import Any, Final

from robots_controller.degrees import joints_to_program
from robots_controller.interpreter import argument_kinds as kinds
from robots_controller.interpreter.functions.common_arguments import JOINTS, POSE
from robots_controller.interpreter.functions.lua_function import (
    A_POSE,
    JOINT_NUMBERS,
    TRUE_OR_FALSE,
    Argument,
    lua_function,
)
from robots_controller.interpreter.functions.run_context import Family
from robots_controller.interpreter.lua_sandbox import Result
from robots_core.errors import UnreachablePoseError
from robots_core.validation import Array, read_only

_NEAR: Final = Argument(
    'near', kinds.JOINTS, 'deg (m)', 'joint angles to search from; the last target by default', optional=True
)


class Kinematics(Family):
    """Computes with the tool and base that are set."""

    @lua_function(JOINTS, returns=A_POSE)
    def forwardKinematics(self, *q: float) -> Result:
        """Computes the pose of the tool at joint angles."""
        return (self._run.shown(self._run.target.seen(self._run.cell.kinematics.direct(read_only(q)))),)

    @lua_function(*POSE, _NEAR, returns=JOINT_NUMBERS)
    def inverseKinematics(self, *values: Any) -> Result:
        """Computes the joint angles with which ptpJointSpacePosition reaches a pose.

        It fails if there are none.
        """
        return (joints_to_program(self._joints(values), self._run.view.prismatic),)

    @lua_function(*POSE, _NEAR, returns=TRUE_OR_FALSE)
    def isReachable(self, *values: Any) -> Result:
        """Tests whether joint angles inside the limits reach a pose."""
        try:
            self._joints(values)
        except UnreachablePoseError:
            return False
        return True

    def _joints(self, values: Sequence[Any]) -> Array:
        *numbers, near = values
        start = self._run.target.joints() if near is None else read_only(near)
        return self._run.cell.kinematics.inverse(self._run.view.pose(numbers), start, self._run.settings)
