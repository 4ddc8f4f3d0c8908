"""Teaching: points and motions of a robot program, written from where the robot stands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import count
from pathlib import Path
from typing import Final, Literal, get_args

from robots_controller.program.files.file_history import FileHistory
from robots_controller.program.files.taught_points import TaughtPoint, points_text, read_points
from robots_core.errors import InvalidInputError, ProgramError
from robots_core.files.user_file import read_text
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, read_only

Motion = Literal['ptp', 'line', 'arc']
MOTIONS: Final[tuple[Motion, ...]] = get_args(Motion)
"""All axes together, the tool on a straight line, the tool on an arc through a point before."""


class Teaching:
    """Changes points files and programs, each change whole, and takes changes back.

    A points file that is not valid is never written.
    """

    def __init__(self, robot: BaseRobotModel) -> None:
        self._robot = robot
        self.history: Final = FileHistory()
        """What can be undone."""

    def points(self, points_file: Path) -> dict[str, TaughtPoint]:
        """The points of a file by name.

        Raises:
            ProgramError: the file is not valid; names its line.
        """
        return read_points(points_file, self._robot.num_axes)

    def teach(self, points_file: Path, name: str, q: Array) -> None:
        """Store joint positions (n,), rad (m), as a point; one that has the name is touched up.

        Raises:
            InvalidInputError: an empty name.
            ProgramError: the file is not valid, or cannot be written; it stays as it was.
        """
        self.history.change(self._taught(points_file, name, q))

    def insert(
        self,
        points_file: Path,
        program: Path,
        line: int,
        *,
        motion: Motion,
        names: Sequence[str],
        q: Array,
    ) -> int:
        """Teach a point, and insert a motion to it into a program, as one change.

        Args:
            points_file: Of the program.
            program: The program, or a subprogram of it.
            line: The motion comes after this line; 0 puts it first.
            motion: Its kind.
            names: Of the point; of an arc, those of the point that it passes and of its end.
            q: Where the robot stands, (n,), rad (m): the point.

        Returns:
            The line of the motion, from 1.

        Raises:
            InvalidInputError: an empty name, or a line that the program does not have.
            ProgramError: a file is not valid or cannot be written, or an arc passes no known point.
        """
        taught = self._taught(points_file, names[-1], q)
        known = self.points(points_file)
        for name in names[:-1]:
            if name not in known:
                raise ProgramError(
                    f'no point is named {name!r}; the arc needs one to pass', key='arc_passes_none', name=name
                )
        lines = read_text(program, 'program').split('\n')
        if not 0 <= line <= len(lines):
            raise InvalidInputError(f'line = {line} must be in [0, {len(lines)}] of {program.name}')
        before = lines[line - 1] if line else ''
        indent = before[: len(before) - len(before.lstrip())]
        lines.insert(line, indent + _call(motion, names) + ('\r' if before.endswith('\r') else ''))
        self.history.change({**taught, program: '\n'.join(lines)})
        return line + 1

    def _taught(self, points_file: Path, name: str, q: Array) -> dict[Path, str]:
        if not name.strip():
            raise InvalidInputError(
                'the name of the point is empty; valid is a text, such as P1', key='unnamed_point'
            )
        points = self.points(points_file)
        points[name] = TaughtPoint(read_only(q), self._robot.pose(q))
        return {points_file: points_text(points)}


def free_name(points: Mapping[str, TaughtPoint]) -> str:
    """The first of P1, P2, ... that no point has."""
    return next(name for number in count(1) if (name := f'P{number}') not in points)


def _call(motion: Motion, names: Sequence[str]) -> str:
    if motion not in MOTIONS:
        raise InvalidInputError(f'motion {motion!r} is unknown; valid are {", ".join(MOTIONS)}')
    if len(names) != (2 if motion == 'arc' else 1):
        raise InvalidInputError(f'{len(names)} points for {motion}; an arc has two, others have one')
    texts = [_lua_text(name) for name in names]
    if motion == 'ptp':  # in parentheses: the joint angles alone, of two values
        return f'ptpJointSpaceAngles((getTaughtPoint({texts[0]})))'
    function = 'ptpCartesianSpace' if motion == 'line' else 'circCartesianSpace'
    return f'{function}({", ".join(f"getTaughtPose({text})" for text in texts)})'


def _lua_text(text: str) -> str:
    escaped = text.replace('\\', '\\\\').replace("'", "\\'").replace('\n', '\\n')
    return f"'{escaped}'"
