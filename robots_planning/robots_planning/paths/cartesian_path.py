"""CartesianPath: poses of the tool over a path coordinate, twice continuously differentiable."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from math import comb

import numpy as np
from numpy.typing import ArrayLike

from robots_core.errors import InvalidInputError
from robots_core.pose import Pose
from robots_core.validation import Array, read_only
from robots_planning.paths.cartesian_path_kernel import PathArrays, poses_on_path, travel
from robots_planning.timing.quintic import interval_at

# Poses closer than this coincide: the difference is rounding of commands and messages.
COINCIDENT_DISTANCE = 1e-8  # m
COINCIDENT_ANGLE = 1e-8  # rad
SAMPLES_PER_PIECE = 64  # for the length of curves without a closed form
_ROWS, _COLUMNS = np.indices((6, 6))
_BINOMIALS = np.vectorize(comb, otypes=[np.float64])(_COLUMNS, _ROWS)


@dataclass(frozen=True, eq=False)
class PathSamples:
    """A path at m values of s.

    Attributes:
        r: Positions, (m, 3), m.
        T: Orientations, (m, 3, 3).
        x_s: First derivative with respect to s, (m, 6): linear (m), then angular (rad), base frame.
        x_ss: Second derivative, (m, 6).
    """

    r: Array
    T: Array
    x_s: Array
    x_ss: Array


class CartesianPath:
    """Poses x(s), s in [0, 1], in the base frame. Each kind of path is a subclass that makes the pieces.

    Args:
        pieces: Arrays for compiled code; see `PathArrays`.
        length: Arc length of the position, m; computed by quadrature if not given.
        angle: Arc length of the orientation, rad; computed by quadrature if not given.
    """

    kind: str = 'path'
    """The noun for it in error messages."""

    def __init__(
        self, pieces: PathArrays, *, length: float | None = None, angle: float | None = None
    ) -> None:
        breaks, position, arc, rate, turn, T = (read_only(np.ascontiguousarray(part)) for part in pieces)
        self.arrays: PathArrays = (breaks, position, arc, rate, turn, T)
        self._length, self._angle = length, angle

    @property
    def breaks(self) -> Array:
        """Values of s between pieces, (m + 1,), from 0 to 1; the path is C2 at them and smooth elsewhere."""
        return self.arrays[0]

    @property
    def length(self) -> float:
        """Arc length of the position, m."""
        return self._measured[0] if self._length is None else self._length

    @property
    def angle(self) -> float:
        """Arc length of the orientation, rad."""
        return self._measured[1] if self._angle is None else self._angle

    @cached_property
    def start(self) -> Pose:
        """Pose at s = 0."""
        return self.pose(0.0)

    @cached_property
    def end(self) -> Pose:
        """Pose at s = 1."""
        return self.pose(1.0)

    def pose(self, s: float) -> Pose:
        """Pose at `s`."""
        samples = self.sample([s])
        return Pose(samples.r[0], samples.T[0])

    def sample(self, s: ArrayLike) -> PathSamples:
        """The path at `s` (m,), clipped to [0, 1]."""
        values = np.clip(np.ascontiguousarray(s, dtype=np.float64), 0.0, 1.0)
        m = len(values)
        samples = PathSamples(np.empty((m, 3)), np.empty((m, 3, 3)), np.empty((m, 6)), np.empty((m, 6)))
        poses_on_path(self.arrays, values, samples.r, samples.T, samples.x_s, samples.x_ss)
        return samples

    def travel(self, s: Array) -> tuple[Array, Array, Array]:
        """Rates of arc length and angle over s at `s` (m,), (m, 2) each; see `travel` of compiled code."""
        samples = self.sample(s)
        return travel(samples.x_s, samples.x_ss)

    def part(self, begin: float, end: float) -> CartesianPath:
        """The path from s = `begin` to s = `end`, backwards if `end` < `begin`, over an s of its own.

        With `end` = `begin` the tool stands still.
        """
        breaks, position, arc, rate, turn, T = self.arrays
        span = end - begin
        inner = breaks[(breaks > min(begin, end)) & (breaks < max(begin, end))]
        edges = np.array([begin, *(inner if span > 0.0 else inner[::-1]), end])
        pieces = empty_pieces(len(edges) - 1)
        pieces[0][1:-1] = (edges[1:-1] - begin) / (span or 1.0)
        for k, middle in enumerate(0.5 * (edges[:-1] + edges[1:])):
            i = interval_at(breaks, middle)
            # In a piece, x of the whole path is x0 + span x.
            x0 = edges[k] - breaks[i]
            powers = _BINOMIALS * x0 ** np.maximum(_COLUMNS - _ROWS, 0) * span**_ROWS
            pieces[1][k], pieces[4][k] = powers @ position[i], powers[:4, :4] @ turn[i]
            cosine, sine = np.cos(rate[i] * x0), np.sin(rate[i] * x0)
            pieces[2][k] = [
                cosine * arc[i, 0] + sine * arc[i, 1],
                cosine * arc[i, 1] - sine * arc[i, 0],
            ]
            pieces[3][k], pieces[5][k] = rate[i] * span, T[i]
        path = CartesianPath(pieces)
        path.kind = self.kind
        return path

    def describe_length(self) -> str:
        """'0.300 m', '0.500 rad' or both."""
        parts = [f'{self.length:.3f} m'] if self.length > 0.0 else []
        parts += [f'{self.angle:.3f} rad'] if self.angle > 0.0 else []
        return ' and '.join(parts)

    @cached_property
    def _measured(self) -> tuple[float, float]:
        """Length and angle by Gauss-Legendre quadrature in every piece."""
        x, weights = _gauss_legendre()
        half = 0.5 * np.diff(self.breaks)[:, None]
        s = (self.breaks[:-1, None] + half * (1.0 + x)).ravel()
        x_s, scale = self.sample(s).x_s, (half * weights).ravel()
        return (
            float(np.linalg.norm(x_s[:, :3], axis=1) @ scale),
            float(np.linalg.norm(x_s[:, 3:], axis=1) @ scale),
        )


@cache
def _gauss_legendre() -> tuple[Array, Array]:
    return np.polynomial.legendre.leggauss(SAMPLES_PER_PIECE)


def empty_pieces(count: int) -> PathArrays:
    """Pieces of equal length in s, at rest in the origin, to be filled in."""
    return (
        np.linspace(0.0, 1.0, count + 1),
        np.zeros((count, 6, 3)),
        np.zeros((count, 2, 3)),
        np.zeros(count),
        np.zeros((count, 4, 3)),
        np.tile(np.eye(3), (count, 1, 1)),
    )


def check_apart(first: Pose, second: Pose, names: tuple[str, str], *, kind: str) -> None:
    """Check that two positions do not coincide.

    Raises:
        InvalidInputError: they coincide; names both and their position.
    """
    distance = float(np.linalg.norm(second.r - first.r))
    if distance < COINCIDENT_DISTANCE:
        raise InvalidInputError(
            f'{names[0]} and {names[1]} of the {kind} coincide at {position_text(first)}: they are '
            f'{distance:.3g} m apart, needed are at least {COINCIDENT_DISTANCE:g} m',
            distance=distance,
        )


def position_text(pose: Pose) -> str:
    """'(0.1000, 0.2000, 0.3000) m'."""
    x, y, z = (float(value) for value in pose.r)
    return f'({x:.4f}, {y:.4f}, {z:.4f}) m'
