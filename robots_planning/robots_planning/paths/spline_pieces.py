"""Cubic pieces of splines with continuous first and second derivative."""

import numpy as np

from robots_core.errors import InvalidInputError
from robots_core.orientation import rotation_vector_jacobians
from robots_core.validation import Array
from robots_planning.paths.cartesian_path import CartesianPath, empty_pieces

# Change of the angular velocities in an iteration, relative; some ten iterations lead there.
CONVERGED = 1e-12
MOST_ITERATIONS = 100


def position_pieces(h: Array, points: Array) -> Array:
    """A cubic spline through points.

    At the first and the last inner point the third derivative is continuous, too (not-a-knot; de Boor 2001,
    chapter IV). Through two points the spline is a line, through three a parabola.

    Args:
        h: Length of each piece in the parameter, (m,), above 0.
        points: (m + 1, 3).

    Returns:
        Coefficients in powers of the parameter since the piece began, (m, 4, 3).
    """
    rise = np.diff(points, axis=0)
    slopes = _slopes(h, rise / h[:, None])
    pieces = _cubics(h, rise, slopes[:-1], slopes[1:])
    pieces[:, 0] = points[:-1]
    return pieces


def turning_pieces(h: Array, turns: Array) -> Array:
    """Rotation vectors of an orientation with continuous angular velocity and acceleration.

    In each piece the rotation vector p is a cubic from 0 to the turn of the piece. The angular velocity is
    J p', its derivative J p'' + J' p' (McClain and Tapley 1974). At both ends of the path it is the mean of
    the piece.

    Args:
        h: As for `position_pieces`.
        turns: Rotation vectors from each orientation to the next, base frame, (m, 3), rad.

    Returns:
        Coefficients, as `position_pieces`.

    Raises:
        InvalidInputError: the iteration does not converge, which happens with large turns in pieces of very
            different lengths; names the piece that turns most.
    """
    rates = turns / h[:, None]
    if len(h) == 1:
        return _cubics(h, turns, rates, rates)
    omega = np.concatenate([rates[:1], rates])
    J = rotation_vector_jacobians(turns)
    J_inverse = np.linalg.inv(J)
    scaled, scaled_inverse = 2.0 * J / h[:, None, None], 2.0 * J_inverse / h[:, None, None]
    # J p'' + J' p' at the end of a piece is p'' at the begin of the next, where p = 0.
    system = BlockTridiagonal(
        scaled[1:-1], 4.0 * (1.0 / h[:-1] + 1.0 / h[1:])[:, None, None] * np.eye(3), scaled_inverse[1:-1]
    )
    known = 6.0 * (rates[:-1] / h[:-1, None] + rates[1:] / h[1:, None])
    known[0] -= scaled[0] @ omega[0]
    known[-1] -= scaled_inverse[-1] @ omega[-1]
    ends = np.einsum('mij,mj->mi', J_inverse, omega[1:])
    for _ in range(MOST_ITERATIONS):
        before = omega.copy()
        with np.errstate(all='ignore'):  # of an iteration that diverges
            omega[1:-1] = system.solve(known - _second_derivative(turns, ends)[:-1])
            ends = np.einsum('mij,mj->mi', J_inverse, omega[1:])
        if np.abs(omega - before).max() <= CONVERGED * np.abs(omega).max():
            return _cubics(h, turns, omega[:-1], ends)
    angles = np.linalg.norm(turns, axis=1)
    worst = int(angles.argmax())
    raise InvalidInputError(
        f'the orientation of the spline is not smooth: it turns by {angles[worst]:.3g} rad from pose '
        f'{worst} to pose {worst + 1}; put a pose between them, or space the poses more evenly',
        index=worst,
    )


def _cubics(h: Array, rise: Array, begin: Array, end: Array) -> Array:
    """Coefficients (m, 4, k) of cubics that rise from 0 by `rise`, with these derivatives at their ends."""
    h = h[:, None]
    mean = rise / h
    return np.stack(
        [np.zeros_like(rise), begin, (3.0 * mean - 2.0 * begin - end) / h, (begin + end - 2.0 * mean) / h**2],
        axis=1,
    )


def _slopes(h: Array, mean: Array) -> Array:
    """Derivatives (m + 1, 3) of a cubic spline at its points, from the mean ones (m, 3) of its pieces."""
    if len(h) == 1:
        return mean[[0, 0]]
    pairs = h[:-1] + h[1:]
    right = 3.0 * (h[1:, None] * mean[:-1] + h[:-1, None] * mean[1:])
    if len(h) == 2:
        inner = right[0] / (3.0 * pairs[0])
        return np.array([2.0 * mean[0] - inner, inner, 2.0 * mean[1] - inner])
    first = ((h[0] + 2.0 * pairs[0]) * h[1] * mean[0] + h[0] ** 2 * mean[1]) / pairs[0]
    last = ((h[-1] + 2.0 * pairs[-1]) * h[-2] * mean[-1] + h[-1] ** 2 * mean[-2]) / pairs[-1]
    system = BlockTridiagonal(
        np.array([*h[1:], pairs[-1]])[:, None, None],
        np.array([h[1], *(2.0 * pairs), h[-2]])[:, None, None],
        np.array([pairs[0], *h[:-1]])[:, None, None],
    )
    return system.solve(np.concatenate([[first], right, [last]])[:, None])[:, 0]


def _second_derivative(p: Array, p_s: Array) -> Array:
    """J' p' (m, 3) of rotation vectors p (m, 3) that change by p' (m, 3)."""
    pieces = empty_pieces(len(p))
    pieces[4][:, 0], pieces[4][:, 1] = p, p_s
    return CartesianPath(pieces).sample(pieces[0][:-1]).x_ss[:, 3:]


class BlockTridiagonal:
    """lower[k - 1] x[k - 1] + diagonal[k] x[k] + upper[k] x[k + 1] = right[k], factorised once.

    Elimination from the first block to the last, without pivoting (Golub and Van Loan 2013, section 4.5.1).

    Args:
        lower: (m - 1, n, n).
        diagonal: (m, n, n).
        upper: (m - 1, n, n).
    """

    def __init__(self, lower: Array, diagonal: Array, upper: Array) -> None:
        self._lower, self._upper = lower, upper
        self._inverses = [np.linalg.inv(diagonal[0])]
        for before, here, behind in zip(lower, diagonal[1:], upper, strict=True):
            self._inverses.append(np.linalg.inv(here - before @ self._inverses[-1] @ behind))

    def solve(self, right: Array) -> Array:
        """The unknowns of one right-hand side, (m, n), or of several, (m, n, k), in its shape."""
        x = right.copy()
        for k, lower in enumerate(self._lower):
            x[k + 1] -= lower @ (self._inverses[k] @ x[k])
        x[-1] = self._inverses[-1] @ x[-1]
        for k in range(len(x) - 2, -1, -1):
            x[k] = self._inverses[k] @ (x[k] - self._upper[k] @ x[k + 1])
        return x
