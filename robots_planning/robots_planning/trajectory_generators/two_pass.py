"""Two-pass algorithm: the fastest speed along a path, on a grid."""

from __future__ import annotations

import numpy as np

from robots_core.validation import Array


def two_pass(s: Array, q_s: Array, q_ss: Array, velocity: Array, acceleration: Array) -> Array:
    """Highest squared path speed from rest to rest under velocity and acceleration limits.

    A backward pass finds from which speeds the end can still be reached, a forward pass takes the fastest of
    them (Pham and Pham 2018, in closed form for symmetric limits). Limits hold at the grid points.

    Args:
        s: Path grid, (m,), increasing.
        q_s: First derivatives of the limited quantities, (m, k).
        q_ss: Second derivatives, (m, k).
        velocity: Largest |q' s_dot|, (m, k).
        acceleration: Largest |q'' s_dot^2 + q' s_ddot|, (m, k).

    Returns:
        s_dot^2 at the grid points, (m,); 0 at both ends. s_ddot is constant from point to point.
    """
    # q' is made non-negative: a limit is symmetric.
    sign = np.where(q_s < 0.0, -1.0, 1.0)
    first, second = q_s * sign, q_ss * sign
    highest = _highest_anywhere(first, second, velocity, acceleration)
    step = 2.0 * np.diff(s)[:, None]
    gain, offset = _backward_lines(first[:-1], second[:-1], acceleration[:-1], step)
    reachable = highest.tolist()
    reachable[-1] = 0.0
    following = 0.0
    for i in range(len(gain) - 1, -1, -1):
        best = reachable[i]
        for a, b in zip(gain[i], offset[i], strict=True):
            value = a * following + b
            best = min(best, value)
        reachable[i] = following = best
    # s_ddot <= (a - q'' u) / q', so that u grows by at most step (a - q'' u) / q'.
    with np.errstate(divide='ignore', over='ignore', invalid='ignore'):
        moving = first[:-1] > 0.0
        growth = np.where(moving, step * acceleration[:-1] / first[:-1], np.inf)
        slope = np.where(moving, 1.0 - step * second[:-1] / first[:-1], 1.0)
    growth = np.where(np.isfinite(growth) & np.isfinite(slope), growth, np.inf)
    slope = np.where(np.isfinite(slope) & np.isfinite(growth), slope, 1.0)
    speeds = [0.0]
    u = 0.0
    for g, m, bound in zip(growth.tolist(), slope.tolist(), reachable[1:], strict=True):
        best = bound
        for a, b in zip(m, g, strict=True):
            value = a * u + b
            best = min(best, value)
        u = max(best, 0.0)
        speeds.append(u)
    return np.array(speeds)


def _highest_anywhere(first: Array, second: Array, velocity: Array, acceleration: Array) -> Array:
    """Highest s_dot^2 at each point for which some s_ddot keeps all limits (maximum velocity curve), (m,)."""
    with np.errstate(divide='ignore'):
        highest: Array = np.min((velocity / first) ** 2, axis=1)
    # Any two limits together: u (q''_k q'_j - q''_j q'_k) <= a_k q'_j + a_j q'_k.
    curvature = second[:, None, :] * first[:, :, None] - second[:, :, None] * first[:, None, :]
    room = acceleration[:, None, :] * first[:, :, None] + acceleration[:, :, None] * first[:, None, :]
    with np.errstate(divide='ignore', invalid='ignore', over='ignore'):
        bound = np.where(curvature > 0.0, room / curvature, np.inf)
        # An axis that only has curvature is limited by it alone, also where the path stands still for it.
        alone = np.where(first == 0.0, acceleration / np.abs(second), np.inf)
    result: Array = np.minimum(highest, np.minimum(bound.min(axis=(1, 2)), alone.min(axis=1)))
    return result


def _backward_lines(
    first: Array, second: Array, acceleration: Array, step: Array
) -> tuple[list[list[float]], list[list[float]]]:
    """Speeds from which the next point's speed u can be braked to: every gain * u + offset, (m, k) each.

    From -a <= q'' u_i + q' (u - u_i) / step: u_i (q' - step q'') <= q' u + step a.
    """
    room = first - step * second
    with np.errstate(divide='ignore', over='ignore', invalid='ignore'):
        gain = np.where(room > 0.0, first / room, 0.0)
        offset = np.where(room > 0.0, step * acceleration / room, np.inf)
    finite = np.isfinite(gain)
    return np.where(finite, gain, 0.0).tolist(), np.where(finite, offset, np.inf).tolist()
