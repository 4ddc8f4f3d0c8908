"""Zone: a box or a half-space that the tool or the bodies of a robot may not leave or enter."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final, Literal

import numpy as np

from robots_core.errors import InvalidInputError
from robots_core.pose import Pose
from robots_core.robot_model.shapes import Box
from robots_core.validation import Array, finite_vector, read_only

Keep = Literal['in', 'out']
What = Literal['tool', 'bodies']
FARTHEST: Final = 1e5  # m
SHORTEST_NORMAL: Final = 1e-9


@dataclass(frozen=True, eq=False)
class HalfSpace:
    """All points on one side of a plane.

    Attributes:
        point: Of the plane, (3,) m, base frame.
        normal: Of the plane, (3,), into the half-space; of length 1 afterwards.

    Raises:
        InvalidInputError: values that are not finite or too far away, or a normal without a direction.
    """

    point: Array
    normal: Array

    def __post_init__(self) -> None:
        point, normal = finite_vector(self.point, 3, 'point'), finite_vector(self.normal, 3, 'normal')
        if np.abs(point).max() > FARTHEST:
            raise InvalidInputError(f'the point {point.tolist()} of a plane must be within +-{FARTHEST:g} m')
        largest = np.abs(normal).max()
        if not largest >= SHORTEST_NORMAL:
            raise InvalidInputError(f'the normal {normal.tolist()} of a plane has no direction')
        normal = normal / largest  # so that no square overflows
        object.__setattr__(self, 'point', read_only(point))
        object.__setattr__(self, 'normal', read_only(normal / np.linalg.norm(normal)))


@dataclass(frozen=True, eq=False)
class PlacedBox:
    """A box in the base frame.

    Attributes:
        box: Its edges.
        pose: Pose of its centre.
    """

    box: Box
    pose: Pose


@dataclass(frozen=True, eq=False)
class Zone:
    """A region whose border the robot does not cross as long as it is closed.

    Attributes:
        name: Unique within a scene.
        region: Where it is.
        keep: Whether the robot keeps in the region or out of it.
        what: Of the robot: the tool centre point; or the bodies of the robot that its axes move, with what is
            attached to its flange.
        closed_by: Digital inputs, by channel or signal, and the values that close the border.
        shared_with: Namespaces of other robots; one robot at a time crosses the border. Without
            `closed_by` and `shared_with` it is always closed.
    """

    name: str
    region: PlacedBox | HalfSpace
    keep: Keep
    what: What
    closed_by: Mapping[str, bool] = field(default_factory=lambda: MappingProxyType({}))
    shared_with: tuple[str, ...] = ()

    @property
    def always_closed(self) -> bool:
        """Nothing opens its border."""
        return not self.closed_by and not self.shared_with

    @property
    def walls(self) -> tuple[Array, Array]:
        """Outward normals of the region's faces, (k, 3), and their distances from the origin, (k,) m."""
        match self.region:
            case HalfSpace(point, normal):
                normals = -normal[None]
                return normals, normals @ point
            case PlacedBox(box, pose):
                normals = np.vstack([pose.T.T, -pose.T.T])
                return normals, normals @ pose.r + 0.5 * np.tile(box.size, 2)

    def describe(self, body: str, clearance: float) -> str:
        """Where a body is, for a person.

        Args:
            body: Its name.
            clearance: How far it may still go, m; below 0 it is across the border.
        """
        if clearance >= 0.0:
            return f'{body} comes to {1e3 * clearance:.1f} mm from the border of zone {self.name!r}'
        side = 'outside' if self.keep == 'in' else 'inside'
        return f'{body} is {-1e3 * clearance:.1f} mm {side} zone {self.name!r}'
