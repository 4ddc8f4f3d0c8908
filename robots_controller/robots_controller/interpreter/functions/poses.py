"""Poses: their arithmetic, and palettes."""

import itertools
from functools import reduce
from operator import matmul
from typing import Final

from robots_controller.interpreter.functions.common_arguments import POSE
from robots_controller.interpreter.functions.lua_function import Argument, LuaFunction
from robots_controller.interpreter.functions.run_context import Handlers, RunContext
from robots_controller.interpreter.lua_arguments import Arguments
from robots_controller.interpreter.lua_sandbox import Result
from robots_core.errors import ProgramError
from robots_core.pose import Pose

MOST_PLACES: Final = 1000

_WAY: Final = (
    *(Argument(axis, 'number', 'm', f'way along {axis}') for axis in 'xyz'),
    *(
        Argument(f'phi{i}', 'number', 'deg', f'turn by orientation angle {i}', optional=True)
        for i in (1, 2, 3)
    ),
)

POSES: Final = (
    LuaFunction(
        'pose',
        POSE,
        'Makes a pose: a table with its six numbers, also as `p.x` to `p.phi3`; `a * b` is compose(a, b).',
        'a pose',
        'Pose',
    ),
    LuaFunction(
        'compose',
        (Argument('pose', 'pose', '', 'pose seen from the one before it', repeated=True),),
        'Chains poses: the last one, seen from where the first one is seen from.',
        'a pose',
        'Pose',
    ),
    LuaFunction(
        'inverse',
        (Argument('pose', 'pose', '', 'pose of a frame'),),
        'Inverts a pose: where it was seen from, seen from it.',
        'a pose',
        'Pose',
    ),
    LuaFunction(
        'offset',
        (
            Argument('pose', 'pose', '', 'pose to start from'),
            *_WAY,
            Argument('frame', 'frame', '', "'base' (default) or 'tool': whose axes are meant", optional=True),
        ),
        "Shifts and turns a pose along the axes of the base or, with 'tool', along its own.",
        'a pose',
        'Pose',
    ),
    LuaFunction(
        'grid',
        (
            Argument('first', 'pose', '', 'pose at the first place'),
            Argument('row_end', 'pose', '', 'pose at the end of the first row; its position counts'),
            Argument('columns', 'count', '', 'places in a row'),
            Argument('column_end', 'pose', '', 'pose at the end of the first column', optional=True),
            Argument('rows', 'count', '', 'rows', optional=True),
            Argument('stack_end', 'pose', '', 'pose at the top of the first stack', optional=True),
            Argument('layers', 'count', '', 'layers', optional=True),
        ),
        'Lays out a palette: its places row by row, layer by layer, all oriented as the first.',
        'a table of poses',
        'Pose[]',
    ),
)
"""Arithmetic of poses."""


class Poses:
    """Computes with poses.

    Args:
        run: The run.
    """

    def __init__(self, run: RunContext) -> None:
        self._run = run
        self.handlers: Handlers = {
            'pose': lambda a: (run.shown(run.view.pose(a.values)),),
            'compose': lambda a: (run.shown(reduce(matmul, map(run.view.pose, a.values))),),
            'inverse': lambda a: (run.shown(run.view.pose(a.values[0]).inverse()),),
            'offset': self._offset,
            'grid': self._grid,
        }

    def _offset(self, arguments: Arguments) -> Result:
        start, *way, frame = arguments.values
        pose = self._run.view.pose
        return (self._run.shown(moved(pose(start), pose([value or 0.0 for value in way]), frame)),)

    def _grid(self, arguments: Arguments) -> Result:
        first, *ends = arguments.values
        ways, counts = [], []
        for axis, (end, count) in enumerate(zip(ends[::2], ends[1::2], strict=True)):
            if (end is None) is not (count is None):
                names = ('columns', 'rows', 'layers')
                raise ProgramError(f'{names[axis]} need both a number and the pose at their end')
            start = self._run.view.pose(first)
            way = start.r - start.r if end is None else self._run.view.pose(end).r - start.r
            counts.append(int(count or 1))
            ways.append(way / max(counts[-1] - 1, 1))
        if (places := counts[0] * counts[1] * counts[2]) > MOST_PLACES:
            raise ProgramError(f'{places} places; valid are at most {MOST_PLACES}')
        steps = itertools.product(*(range(count) for count in reversed(counts)))
        return tuple(
            self._run.shown(Pose(start.r + i * ways[0] + j * ways[1] + k * ways[2], start.T))
            for k, j, i in steps
        )


def moved(start: Pose, way: Pose, frame: str | None) -> Pose:
    """A pose shifted and turned along the axes of the base or, for 'tool', along its own."""
    return start @ way if frame == 'tool' else Pose(start.r + way.r, way.T @ start.T)
