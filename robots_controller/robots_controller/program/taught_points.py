"""TaughtPoints: named positions of the robot in a YAML file beside the program."""

import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import yaml

from robots_core.errors import InvalidInputError, ProgramError, RobotsError
from robots_core.pose import Pose
from robots_core.validation import Array, finite_vector, read_only

HEADER: Final = (
    '# Taught points. q: joint positions, rad (m for sliding axes), in the order of the axes.\n'
    '# r: position of the flange (tool0) in the robot base frame, m. quaternion: its orientation, x y z w.\n'
)
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
    try:
        data = yaml.safe_load(path.read_text())
    except FileNotFoundError:
        return {}
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise ProgramError(f'the points file cannot be read: {error}', file=path.name) from None
    entries = data.get('points') if isinstance(data, dict) else None
    if not isinstance(entries, dict):
        raise ProgramError("a points file has one key 'points' with a point per name", file=path.name)
    return {str(name): _point(str(name), entry, num_axes, path) for name, entry in entries.items()}


def write_points(path: Path, points: dict[str, TaughtPoint]) -> None:
    """Write a points file: the whole new one or, whatever happens, the whole old one.

    Raises:
        ProgramError: it cannot be written.
    """
    entries = {
        name: {
            'q': point.q.tolist(),
            'r': point.pose.r.tolist(),
            'quaternion': point.pose.quaternion().tolist(),
        }
        for name, point in sorted(points.items())
    }
    text = HEADER + yaml.safe_dump({'points': entries}, sort_keys=False, default_flow_style=None, width=200)
    try:
        with tempfile.NamedTemporaryFile('w', dir=path.parent, prefix=f'.{path.name}.', delete=False) as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        Path(file.name).replace(path)
    except OSError as error:
        raise ProgramError(f'the points file cannot be written: {error.strerror}', file=path.name) from None


def _point(name: str, entry: Any, num_axes: int, path: Path) -> TaughtPoint:
    try:
        if not isinstance(entry, dict) or set(entry) != {'q', 'r', 'quaternion'}:
            raise InvalidInputError('a point has q, r and quaternion')
        q = read_only(finite_vector(entry['q'], num_axes, 'q'))
        return TaughtPoint(q, Pose.from_quaternion(entry['r'], entry['quaternion']))
    except RobotsError as error:
        raise ProgramError(f'point {name!r}: {error}', file=path.name) from None
