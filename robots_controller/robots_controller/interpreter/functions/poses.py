"""Poses: their arithmetic, and palettes."""

import itertools
from collections.abc import Sequence
from functools import reduce
from operator import matmul
from typing import Any, Final

from robots_controller.interpreter import argument_kinds as kinds
from robots_controller.interpreter.functions.common_arguments import POSE, WHOSE_AXES, six_numbers
from robots_controller.interpreter.functions.lua_function import A_POSE, Argument, lua_function
from robots_controller.interpreter.functions.run_context import Family
from robots_controller.interpreter.lua_sandbox import Result
from robots_core.errors import ProgramError
from robots_core.pose import Pose

MOST_PLACES: Final = 1000


class Poses(Family):
    """Computes with poses."""

    @lua_function(*POSE, returns=A_POSE)
    def pose(self, *values: float) -> Result:
        """Makes a pose: a table with its six numbers, also as `p.x` to `p.phi3`; `a * b` is compose(a, b)."""
        return (self._run.shown(self._run.view.pose(values)),)

    @lua_function(
        Argument('pose', kinds.POSE, '', 'pose seen from the one before it', repeated=True), returns=A_POSE
    )
    def compose(self, *poses: Sequence[float]) -> Result:
        """Chains poses: each one is relative to the one before it."""
        return (self._run.shown(reduce(matmul, map(self._run.view.pose, poses))),)

    @lua_function(Argument('pose', kinds.POSE, '', 'pose of a frame'), returns=A_POSE)
    def inverse(self, pose: Sequence[float]) -> Result:
        """Inverts a pose: a pose chained with its inverse is zero."""
        return (self._run.shown(self._run.view.pose(pose).inverse()),)

    @lua_function(
        Argument('pose', kinds.POSE, '', 'pose to start from'),
        *six_numbers('displacement along {}', 'turn by orientation angle {}', optional_turn=True),
        WHOSE_AXES,
        returns=A_POSE,
    )
    def offset(self, start: Sequence[float], *shift_and_frame: Any) -> Result:
        """Shifts and turns a pose along the axes of the base or, with 'tool', along its own."""
        *shift, frame = shift_and_frame
        pose = self._run.view.pose
        return (self._run.shown(moved(pose(start), pose([value or 0.0 for value in shift]), frame)),)

    @lua_function(
        Argument('first', kinds.POSE, '', 'pose at the first place'),
        Argument('row_end', kinds.POSE, '', 'pose at the end of the first row; its position counts'),
        Argument('columns', kinds.COUNT, '', 'places in a row'),
        Argument('column_end', kinds.POSE, '', 'pose at the end of the first column', optional=True),
        Argument('rows', kinds.COUNT, '', 'rows', optional=True),
        Argument('stack_end', kinds.POSE, '', 'pose at the top of the first stack', optional=True),
        Argument('layers', kinds.COUNT, '', 'layers', optional=True),
        returns=('a table of poses', 'Pose[]'),
    )
    def grid(self, first: Sequence[float], *ends: Any) -> Result:
        """Lays out a palette: its places row by row, layer by layer, all oriented as the first."""
        start = self._run.view.pose(first)
        steps, counts = [], []
        for name, end, count in zip(('columns', 'rows', 'layers'), ends[::2], ends[1::2], strict=True):
            if (end is None) is not (count is None):
                raise ProgramError(f'{name} need both a number and the pose at their end')
            side = start.r - start.r if end is None else self._run.view.pose(end).r - start.r
            counts.append(int(count or 1))
            steps.append(side / max(counts[-1] - 1, 1))
        if (places := counts[0] * counts[1] * counts[2]) > MOST_PLACES:
            raise ProgramError(f'{places} places; valid are at most {MOST_PLACES}')
        indices = itertools.product(*(range(count) for count in reversed(counts)))
        return tuple(
            self._run.shown(Pose(start.r + i * steps[0] + j * steps[1] + k * steps[2], start.T))
            for k, j, i in indices
        )


def moved(start: Pose, shift: Pose, frame: str | None) -> Pose:
    """A pose shifted and turned along the axes of the base or, for 'tool', along its own."""
    return start @ shift if frame == 'tool' else Pose(start.r + shift.r, shift.T @ start.T)
