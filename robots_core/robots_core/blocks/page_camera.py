"""Where the camera of the robot's page stands, so that robot and scene are seen."""

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final, Literal, get_args

import numpy as np

from robots_core.pose import Pose
from robots_core.validation import Array

View = Literal['all', 'front', 'side', 'top', 'tool']
VIEWS: Final[tuple[View, ...]] = get_args(View)

FIELD_OF_VIEW: Final = np.pi / 5  # rad, that of a lens of about 60 mm
ASPECT: Final = 1.2  # width over height of the narrowest page that shows all
MARGIN: Final = 1.05
FARTHEST: Final = 2.0  # in reaches of the robot; what of the scene is farther away need not be seen
TOOL_DISTANCE: Final = 0.6  # in reaches of the robot
UP: Final = np.array([0.0, 0.0, 1.0])
# Where a robot mostly works, in its reaches, from its base.
WORKSPACE: Final = np.array([[-0.35, -0.45, 0.0], [0.65, 0.45, 0.75]])
# To the camera, the first that sees the tool: from both sides in front, from behind, and below a roof.
DIRECTIONS: Final = tuple(
    np.array([x, y, z]) for z in (0.30, 0.03, 0.9) for x, y in ((0.62, -0.72), (0.62, 0.72), (-0.62, -0.72))
)
FIXED: Final = {
    'front': np.array([1.0, 0.0, 0.0]),
    'side': np.array([0.0, -1.0, 0.0]),
    'top': np.array([0.0, 0.0, 1.0]),
}


@dataclass(frozen=True, eq=False)
class PlacedBounds:
    """The box around a thing of the scene.

    Attributes:
        bounds: (2, 3) m, lowest and highest corner in a frame of its own.
        pose: Pose of that frame in the robot's base.
    """

    bounds: Array
    pose: Pose

    @property
    def corners(self) -> Array:
        """(8, 3) m in the robot's base."""
        return _corners(self.bounds) @ self.pose.T.T + self.pose.r

    def crossed(self, start: Array, end: Array) -> bool:
        """Whether the line between two points (3,), m, goes through it."""
        a, b = (self.pose.T.T @ (point - self.pose.r) for point in (start, end))
        way = np.where(np.abs(b - a) < 1e-12, 1e-12, b - a)  # a length of nothing
        cuts = np.sort((self.bounds - a) / way, axis=0)
        return max(float(cuts[0].max()), 0.0) <= min(float(cuts[1].min()), 1.0)


@dataclass(frozen=True, eq=False)
class CameraView:
    """A place of the camera.

    Attributes:
        position: (3,) m.
        look_at: (3,) m; it turns around this point.
        up: (3,) upwards in the picture.
    """

    position: Array
    look_at: Array
    up: Array


def camera_view(
    view: View, *, reach: float, joints: Array, tool: Array, scene: Sequence[PlacedBounds] = ()
) -> CameraView:
    """Where the camera of a view stands.

    Args:
        view: 'all' shows robot and scene, from where nothing hides the tool if there is such a place;
            'front', 'side' and 'top' show them straight; 'tool' shows what is around the tool.
        reach: Of the robot, m.
        joints: Positions of its joints, (n, 3) m.
        tool: Position of its tool, (3,) m.
        scene: What is around it.
    """
    if view == 'tool':
        places = (tool + TOOL_DISTANCE * reach * _unit(direction) for direction in DIRECTIONS)
        return CameraView(_unhidden(places, tool, scene), tool, UP)
    points = _points(reach, joints, tool, scene)
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    if view == 'all':
        places = (_fitted(points, centre, direction, UP) for direction in DIRECTIONS)
        return CameraView(_unhidden(places, tool, scene), centre, UP)
    up = np.array([1.0, 0.0, 0.0]) if view == 'top' else UP
    return CameraView(_fitted(points, centre, FIXED[view], up), centre, up)


def _points(reach: float, joints: Array, tool: Array, scene: Sequence[PlacedBounds]) -> Array:
    """Points that are to be seen, (k, 3) m."""
    farthest = FARTHEST * reach
    seen = [np.clip(item.corners, -farthest, farthest) for item in scene]
    return np.vstack([reach * _corners(WORKSPACE), joints, tool, *seen])


def _fitted(points: Array, centre: Array, direction: Array, up: Array) -> Array:
    """The nearest place in a direction from the centre from which all points are seen."""
    to_camera = _unit(direction)
    right = _unit(np.cross(up, to_camera))
    across = np.column_stack([np.cross(to_camera, right), right / ASPECT, to_camera])
    upwards, sideways, nearer = ((points - centre) @ across).T
    away = np.maximum(np.abs(upwards), np.abs(sideways)) / np.tan(0.5 * FIELD_OF_VIEW)
    place: Array = centre + MARGIN * float((nearer + away).max()) * to_camera
    return place


def _unhidden(places: Iterable[Array], tool: Array, scene: Sequence[PlacedBounds]) -> Array:
    """The first of the places with the fewest things between it and the tool."""
    return min(places, key=lambda place: sum(item.crossed(tool, place) for item in scene))


def _corners(bounds: Array) -> Array:
    return np.array(list(itertools.product(*bounds.T)))


def _unit(vector: Array) -> Array:
    unit: Array = vector / np.linalg.norm(vector)
    return unit
