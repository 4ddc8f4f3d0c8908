"""TaughtPoints: named positions of the robot in a YAML file beside the program."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from robots_controller.program.files.atomic_file import read_file, write_text, yaml_text
from robots_core.errors import InvalidInputError, ProgramError, RobotsError
from robots_core.files.yaml_section import read_yaml
from robots_core.pose import Pose
from robots_core.validation import Array, finite_vector, read_only

HEADER: Final = (
    '# Taught points. q: joint positions, rad (m for sliding axes), in the order of the axes.\n'
    '# r: position of the flange (tool0) in the robot base frame, m. quaternion: its orientation, x y z w.\n'
)
WHAT: Final = 'points file'
SUFFIX: Final = '.points.yaml'


@dataclass(frozen=True, eq=False)
class TaughtPoint:
    """A place where the robot was.

    Attributes:
        q: (n,) rad (m), read-only.
        pose: tool0 in the base frame.
    """

    q: Array
    pose: Pose


def read_points(path: Path, num_axes: int) -> dict[str, TaughtPoint]:
    """Points of a file by name; none if there is no file.

    Raises:
        ProgramError: the file cannot be read, or holds something else.
    """
    entries = read_file(path, 'points', WHAT)
    return {str(name): _point(str(name), entry, num_axes, path) for name, entry in entries.items()}


def write_points(path: Path, points: dict[str, TaughtPoint]) -> None:
    """Write a points file: the whole new one or, whatever happens, the whole old one.

    Raises:
        ProgramError: it cannot be written.
    """
    write_text(path, points_text(points), WHAT)


def points_text(points: Mapping[str, TaughtPoint]) -> str:
    """What `write_points` writes."""
    entries = {
        name: {
            'q': point.q.tolist(),
            'r': point.pose.r.tolist(),
            'quaternion': point.pose.quaternion().tolist(),
        }
        for name, point in sorted(points.items())
    }
    return yaml_text({'points': entries}, HEADER)


def _point(name: str, entry: Any, num_axes: int, path: Path) -> TaughtPoint:
    try:
        if not isinstance(entry, dict) or set(entry) != {'q', 'r', 'quaternion'}:
            raise InvalidInputError('a point has q, r and quaternion')
        q = read_only(finite_vector(entry['q'], num_axes, 'q'))
        return TaughtPoint(q, Pose.from_quaternion(entry['r'], entry['quaternion']))
    except RobotsError as error:
        raise ProgramError(f'point {name!r}: {error}', file=path.name, line=_line(name, path)) from None


def _line(name: str, path: Path) -> int:
    """The line of a point; 0 where it is not known."""
    try:
        points = read_yaml(path).section('points')
        return 0 if points is None else points.line_of(name)
    except RobotsError:  # a name that stands there twice
        return 0
