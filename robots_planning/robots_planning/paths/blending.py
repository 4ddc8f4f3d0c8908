"""Blending: consecutive joint paths joined to one, with corners rounded within zones."""

from collections.abc import Callable, Sequence

import numpy as np

from robots_core.errors import InvalidInputError
from robots_core.validation import Array
from robots_planning.paths.joint_path import JointPath
from robots_planning.timing.quintic import quintic_coefficients, quintics_at

JOINED = 1e-6  # rad (m), largest gap between the end of a path and the start of the next
LARGEST_PART = 0.49  # of a path that a blend at one of its ends may replace; the rest separates two blends
SAMPLES = 65  # of a path or a blend, to measure lengths and distances
NARROWER = 0.8  # factor on the replaced length of both paths when a blend leaves its zone
TRIES = 60

Measure = Callable[[Array, Array], Array]
"""From joint positions (m, n) to their distances from one (n,), in the unit of the zones, (m,)."""


def joint_distance(q: Array, corner: Array) -> Array:
    """Largest difference of one axis, rad (m)."""
    return np.asarray(np.abs(q - corner).max(axis=-1))


def blend(paths: Sequence[JointPath], zones: Sequence[tuple[float, Measure]]) -> tuple[JointPath, Array]:
    """One path that follows several in turn and rounds each corner by a quintic in joint space.

    Position and two derivatives are continuous. Outside the zones the result equals the given paths; a blend
    stays within its zone around the corner and replaces less than half of a path.

    Args:
        paths: At least one; each begins where the one before ends.
        zones: Size of the zone around every corner, one fewer than paths and above 0, and the distance of
            joint positions that it is a size of: of joints (rad), or of the tool (m).

    Returns:
        The path, and s at the middle of every blend, (len(zones),).

    Raises:
        InvalidInputError: paths that do not join.
    """
    for index in range(len(zones)):
        gap = joint_distance(paths[index].q[-1], paths[index + 1].q[0])
        if gap > JOINED:
            raise InvalidInputError(
                f'path {index + 1} begins {gap:.3g} rad from where path {index} ends, '
                f'allowed is {JOINED:g} rad',
                index=index,
            )
    weights = [_length(path) for path in paths]
    cuts = [_cut(paths[i], paths[i + 1], weights[i : i + 2], *zone) for i, zone in enumerate(zones)]
    first = [0.0, *(begin for _, begin in cuts)]
    last = [*(1.0 - end for end, _ in cuts), 1.0]
    starts = np.concatenate([[0.0], np.cumsum(weights)])
    rows = []
    for path, weight, start, low, high in zip(paths, weights, starts[:-1], first, last, strict=True):
        inner = path.s[(path.s > low) & (path.s < high)]
        s = np.concatenate([[low], inner, [high]])
        q, q_s, q_ss = path.evaluate(s)
        rows.append((start + weight * s, q, q_s / weight, q_ss / weight**2))
    s, q, q_s, q_ss = (np.concatenate(parts) for parts in zip(*rows, strict=True))
    total = float(starts[-1])
    s = s / total
    s[-1] = 1.0
    begins, ends = (np.array(starts[:-1] + np.multiply(weights, part)) / total for part in (first, last))
    corners = starts[1:-1] / total
    seams = np.sort(np.concatenate([ends[:-1], begins[1:], corners]))  # so that a corner's time is exact
    return JointPath(s, q, q_s * total, q_ss * total**2, seams), corners


def _length(path: JointPath) -> float:
    """Arc length in joint space: with it as the coordinate, all paths have a joint speed of about 1."""
    s = np.linspace(0.0, 1.0, SAMPLES)
    speed = np.linalg.norm(path.evaluate(s)[1], axis=1)
    return float(np.trapezoid(speed, s))


def _cut(
    before: JointPath, after: JointPath, weights: Sequence[float], zone: float, measure: Measure
) -> tuple[float, float]:
    """Parts of both paths that a blend replaces."""
    corner = after.q[0]
    end = _part_inside(before, corner, zone, measure, from_end=True)
    begin = _part_inside(after, corner, zone, measure, from_end=False)
    # Equal lengths on both sides make a symmetric blend.
    length = min(end * weights[0], begin * weights[1])
    for _ in range(TRIES):
        end, begin = length / weights[0], length / weights[1]
        curve = _blend_samples(before, after, weights, end, begin)
        if measure(curve, corner).max() <= zone:
            break
        length *= NARROWER
    return end, begin


def _part_inside(path: JointPath, corner: Array, zone: float, measure: Measure, *, from_end: bool) -> float:
    """The largest part of a path next to the corner, at most half, that lies in the zone."""
    parts = np.linspace(0.0, LARGEST_PART, SAMPLES)
    q = path.evaluate(1.0 - parts if from_end else parts)[0]
    outside = np.flatnonzero(measure(q[1:], corner) > zone)
    if not outside.size:
        return LARGEST_PART
    low, high = parts[outside[0] : outside[0] + 2].tolist()
    for _ in range(30):
        middle = 0.5 * (low + high)
        q_middle = path.evaluate(np.array([1.0 - middle if from_end else middle]))[0]
        low, high = (middle, high) if measure(q_middle, corner)[0] <= zone else (low, middle)
    return float(low)


def _blend_samples(
    before: JointPath, after: JointPath, weights: Sequence[float], end: float, begin: float
) -> Array:
    """Joint positions on the quintic between two paths, (m, n)."""
    states = [
        [values[0] / weight**order for order, values in enumerate(path.evaluate(np.array([s])))]
        for path, weight, s in ((before, weights[0], 1.0 - end), (after, weights[1], begin))
    ]
    x = np.array([0.0, end * weights[0] + begin * weights[1]])
    p, v, a = (np.array([states[0][order], states[1][order]]) for order in range(3))
    coefficients = np.empty((1, 6, p.shape[1]))
    quintic_coefficients(x, p, v, a, coefficients)
    q, q_s, q_ss = (np.empty((SAMPLES, p.shape[1])) for _ in range(3))
    quintics_at(x, coefficients, np.linspace(x[0], x[1], SAMPLES), q, q_s, q_ss)
    return q
