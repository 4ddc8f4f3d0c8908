# ruff: noqa: PLR0917, SIM110  # compiled loops over arrays
"""Configurations of a redundant robot along a path, compiled: self-motion, search, smoothing."""

import numpy as np
from numpy.typing import NDArray

from robots_core.kernels.compiled import compiled
from robots_core.kernels.serial_chain import ChainArrays
from robots_core.kernels.vectors import copy_into
from robots_core.validation import Array
from robots_planning.path_kinematics.pose_residual_kernel import (
    PoseResidual,
    correct,
    evaluate_residual,
    place_target,
    residual_for,
)
from robots_planning.path_kinematics.pseudo_inverse import apply_pseudo_inverse, multiply, pseudo_inverse
from robots_planning.paths.cartesian_path_kernel import PathArrays

SPACING = 0.12  # rad (m) of the axis that moves most, between neighbouring configurations of one pose
MAX_CONFIGURATIONS = 160  # of one pose
# Largest motion of one axis, rad (m), between configurations of neighbouring poses that follow each other.
LARGEST_MOTION = 0.35
LIMIT_ROOM = 0.03  # rad (m) between smoothed configurations and the limits
NOWHERE = -1
INSIDE_STEPS = 4
INSIDE_MOTION = 0.3  # rad (m) of the axis that moves most, in one step
INSIDE_ROOM = 1e-3  # rad (m)
RELAXATION = 0.3  # of the displacement towards the smoother configuration, per step


@compiled()
def sample_layer(residual: PoseResidual, limits: Array, seeds: Array, nodes: Array) -> int:
    """Fill nodes (k, n) with configurations of the target pose connected to `seeds` (m, n); return k.

    From every seed, corrected to the pose, self-motion is followed in both directions until it reaches a
    limit or a configuration that was sampled already.
    """
    count = 0
    for seed in range(seeds.shape[0]):
        q = seeds[seed]
        # Corrections are small: most seeds that were sampled already are recognised without one.
        if _is_sampled(nodes, count, q, 0.5 * SPACING) or not correct(residual, q):
            continue
        if not _move_inside(residual, limits, q) or _is_sampled(nodes, count, q, 0.6 * SPACING):
            continue
        if count == nodes.shape[0]:
            break
        copy_into(nodes[count], q)
        count += 1
        for sign in (1.0, -1.0):
            count = _sample_side(residual, limits, q.copy(), sign, nodes, count)
    return count


@compiled()
def _sample_side(
    residual: PoseResidual, limits: Array, q: Array, sign: float, nodes: Array, count: int
) -> int:
    """Append nodes in one direction of self-motion from `q`, which is overwritten; return the new count."""
    evaluate_residual(residual, q)
    direction = _null_direction(residual)
    while count < nodes.shape[0]:
        for k in range(q.size):
            q[k] += SPACING * sign * direction[k]
        if not correct(residual, q) or not _inside(limits, q) or _is_sampled(nodes, count, q, 0.6 * SPACING):
            break
        copy_into(nodes[count], q)
        count += 1
        last, direction = direction, _null_direction(residual)
        along = 0.0
        for k in range(q.size):
            along += last[k] * direction[k]
        sign = sign if along >= 0.0 else -sign
    return count


@compiled()
def _inside(limits: Array, q: Array) -> bool:
    for k in range(q.size):
        if not limits[0, k] <= q[k] <= limits[1, k]:
            return False
    return True


@compiled()
def _move_inside(residual: PoseResidual, limits: Array, q: Array) -> bool:
    """Bring axes that are slightly outside their limits back by self-motion, in place; False if that fails.

    The residual is that at `q`.
    """
    n = q.size
    for _ in range(INSIDE_STEPS):
        worst, excess = NOWHERE, 0.0
        for k in range(n):
            outside = max(limits[0, k] - q[k], q[k] - limits[1, k])
            if outside > excess:
                worst, excess = k, outside
        if worst == NOWHERE:
            return True
        direction = _null_direction(residual)
        goal = max(limits[0, worst] + INSIDE_ROOM, min(q[worst], limits[1, worst] - INSIDE_ROOM)) - q[worst]
        if INSIDE_MOTION * abs(direction[worst]) < abs(goal):
            return False
        for k in range(n):
            q[k] += goal / direction[worst] * direction[k]
        if not correct(residual, q):
            return False
    return False


@compiled()
def _is_sampled(nodes: Array, count: int, q: Array, distance: float) -> bool:
    for i in range(count):
        if _distance(nodes[i], q) < distance:
            return True
    return False


@compiled()
def _distance(p: Array, q: Array) -> float:
    largest = 0.0
    for k in range(q.size):
        largest = max(largest, abs(p[k] - q[k]))
    return largest


@compiled()
def _null_direction(residual: PoseResidual) -> Array:
    """A null-space direction (n,) of the Jacobian, scaled to a largest entry of 1 rad (m)."""
    J = residual.J
    P, n = pseudo_inverse(J), J.shape[1]
    # The longest column of I - J^+ J.
    axis, longest = 0, 0.0
    for k in range(n):
        square = 1.0
        for i in range(6):
            square -= P[k, i] * J[i, k]
        if square > longest:
            axis, longest = k, square
    direction, largest = np.empty(n), 0.0
    for k in range(n):
        direction[k] = 1.0 if k == axis else 0.0
        for i in range(6):
            direction[k] -= P[k, i] * J[i, axis]
        largest = max(largest, abs(direction[k]))
    for k in range(n):
        direction[k] /= largest
    return direction


@compiled()
def follow_layers(
    chain: ChainArrays, limits: Array, path: PathArrays, s: Array, start: Array, layers: Array
) -> tuple[int, NDArray[np.int64]]:
    """Fill layers (m, k, n) with configurations for the poses at s (m,); the first layer is `start` alone.

    Returns:
        Number of layers that are not empty, and the number of configurations of each layer, (m,).
    """
    m = s.size
    counts = np.zeros(m, np.int64)
    layers[0, 0] = start
    counts[0] = 1
    residual = residual_for(chain, start.size, 0)
    for i in range(1, m):
        seeds = layers[i - 1, : counts[i - 1]].copy()
        place_target(residual, path, s[i - 1])
        _move_along(residual, s[i] - s[i - 1], seeds)
        place_target(residual, path, s[i])
        counts[i] = sample_layer(residual, limits, seeds, layers[i])
        if counts[i] == 0:
            return i, counts
    return m, counts


@compiled()
def _move_along(residual: PoseResidual, interval: float, seeds: Array) -> None:
    """Move seeds (k, n) by an interval of s along the path, unless that is a jump."""
    for k in range(seeds.shape[0]):
        evaluate_residual(residual, seeds[k])
        step = apply_pseudo_inverse(residual.J, residual.x_s)
        largest = 0.0
        for axis in range(step.size):
            largest = max(largest, abs(step[axis]))
        if interval * largest < LARGEST_MOTION:
            for axis in range(step.size):
                seeds[k, axis] += interval * step[axis]


@compiled()
def fastest_sequence(layers: Array, counts: NDArray[np.int64], velocity: Array, chosen: Array) -> int:
    """Fill chosen (m, n), one configuration per layer, with the sequence that takes least time at full speed.

    Returns:
        The first layer that cannot be reached, or m.
    """
    m, n = chosen.shape
    cost = np.full((m, layers.shape[1]), np.inf)
    came = np.full((m, layers.shape[1]), NOWHERE)
    cost[0, 0] = 0.0
    for i in range(1, m):
        reached = False
        for k in range(counts[i]):
            for j in range(counts[i - 1]):
                if cost[i - 1, j] >= cost[i, k]:
                    continue
                largest, time = 0.0, 0.0
                for axis in range(n):
                    moved = abs(layers[i, k, axis] - layers[i - 1, j, axis])
                    largest, time = max(largest, moved), max(time, moved / velocity[axis])
                if largest <= LARGEST_MOTION and cost[i - 1, j] + time < cost[i, k]:
                    cost[i, k], came[i, k] = cost[i - 1, j] + time, j
                    reached = True
        if not reached:
            return i
    node = int(np.argmin(cost[m - 1, : counts[m - 1]]))
    for i in range(m - 1, -1, -1):
        chosen[i] = layers[i, node]
        node = came[i, node]
    return int(m)


@compiled()
def relax(chain: ChainArrays, limits: Array, path: PathArrays, s: Array, rounds: int, q: Array) -> None:
    """Smooth q (m, n) at s (m,) by self-motion, with the first row fixed, `LIMIT_ROOM` inside the limits."""
    m, n = q.shape
    desired, moved, residual = np.empty(n), np.empty(n), residual_for(chain, n, 0)
    for _ in range(rounds):
        for i in range(1, m):
            for k in range(n):
                # The end is free: linear extrapolation is the smoothest there.
                target = 0.5 * (q[i - 1, k] + q[i + 1, k]) if i < m - 1 else 2.0 * q[i - 1, k] - q[i - 2, k]
                desired[k] = RELAXATION * (target - q[i, k])
            place_target(residual, path, s[i])
            evaluate_residual(residual, q[i])
            back = apply_pseudo_inverse(residual.J, multiply(residual.J, desired))
            for k in range(n):
                moved[k] = q[i, k] + desired[k] - back[k]
            if not correct(residual, moved):
                continue
            good = True
            for k in range(n):
                room = min(LIMIT_ROOM, 0.25 * (limits[1, k] - limits[0, k]))
                low, high = min(limits[0, k] + room, q[i, k]), max(limits[1, k] - room, q[i, k])
                good = good and low <= moved[k] <= high
            if good:
                copy_into(q[i], moved)
