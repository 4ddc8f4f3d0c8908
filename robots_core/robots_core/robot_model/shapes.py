"""Shapes fixed to the frames of a robot, for display and for collision checks."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from robots_core.errors import InvalidInputError
from robots_core.pose import Pose
from robots_core.validation import Array, positive, read_only

SMALLEST: Final = 1e-9  # m
LARGEST: Final = 1e5  # m


def _size(value: float, name: str) -> None:
    if not SMALLEST <= positive(value, name, 'm') <= LARGEST:
        raise InvalidInputError(f'{name} = {value:.6g} m must be in [{SMALLEST:g}, {LARGEST:g}] m')


@dataclass(frozen=True)
class Box:
    """Box with edge lengths in metres, centred in its frame."""

    size: tuple[float, float, float]

    def __post_init__(self) -> None:
        for length in self.size:
            _size(length, 'box edge')


@dataclass(frozen=True)
class _Round:
    radius: float
    length: float

    def __post_init__(self) -> None:
        for name in ('radius', 'length'):
            _size(getattr(self, name), f'{type(self).__name__.lower()} {name}')


class Cylinder(_Round):
    """Cylinder along z, centred in its frame; radius and length in metres."""


class Capsule(_Round):
    """Cylinder along z with a half sphere on each end, centred in its frame; metres.

    `length` is that of the cylinder, without the half spheres.
    """


@dataclass(frozen=True)
class Sphere:
    """Sphere centred in its frame; radius in metres."""

    radius: float

    def __post_init__(self) -> None:
        _size(self.radius, 'sphere radius')


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangle mesh: `vertices` (k, 3) in metres, `faces` (f, 3) indices, both read-only.

    Raises:
        InvalidInputError: a vertex that is not finite, or further away than `LARGEST`.
    """

    vertices: Array
    faces: NDArray[np.int64]

    def __post_init__(self) -> None:
        vertices = read_only(self.vertices)
        if not (np.abs(vertices) <= LARGEST).all():  # also true for NaN
            raise InvalidInputError(
                f'a mesh has a vertex that is no point within {LARGEST:g} m of its origin'
            )
        object.__setattr__(self, 'vertices', vertices)
        faces = np.array(self.faces, dtype=np.int64)
        faces.flags.writeable = False
        object.__setattr__(self, 'faces', faces)


Geometry = Box | Cylinder | Capsule | Sphere | Mesh
Colour = tuple[float, float, float, float]


def drawable_colour(channels: Sequence[float], otherwise: Colour) -> Colour:
    """Red, green, blue, opacity of a foreign source: clipped to 0..1; `otherwise` where one is NaN."""
    if np.isnan(channels).any():
        return otherwise
    red, green, blue, opacity = np.clip(channels, 0.0, 1.0).tolist()
    return red, green, blue, opacity


@dataclass(frozen=True, eq=False)
class Shape:
    """A geometry fixed to a frame of the robot.

    Attributes:
        geometry: In a frame of its own.
        frame: 0 for the base, i for the frame of axis i (counted from 1, as in `frame_axes`).
        pose: Pose of the geometry in that frame.
        colour: Red, green, blue, opacity, each 0..1.
        name: Unique within the robot.
    """

    geometry: Geometry
    frame: int
    pose: Pose
    colour: Colour = (0.7, 0.7, 0.7, 1.0)
    name: str = ''
