"""The time law s(t) of a path from path speeds on a grid, and its smoothing, compiled."""

from math import sqrt

import numpy as np

from robots_core.robot_model.analytic.compiled import compiled
from robots_core.validation import Array
from robots_planning.timing.quintic import interval_at

TimeLaw = tuple[Array, Array, Array, Array, Array]
"""Times, s, s_dot and the integral of s over time, (m,) each, and s_ddot (m - 1,) of the intervals."""


@compiled()
def time_law(s: Array, speeds: Array) -> TimeLaw:
    """s(t) with s_ddot constant from point to point.

    Args:
        s: Path grid, (m,), from 0 to 1.
        speeds: s_dot^2 at the grid points, (m,); 0 at both ends, above 0 in between.
    """
    m = s.size
    t, s_dot, integral, s_ddot = np.zeros(m), np.zeros(m), np.zeros(m), np.empty(m - 1)
    for i in range(m - 1):
        s_dot[i + 1] = sqrt(speeds[i + 1])
        h = 2.0 * (s[i + 1] - s[i]) / (s_dot[i] + s_dot[i + 1])
        s_ddot[i] = (s_dot[i + 1] - s_dot[i]) / h
        t[i + 1] = t[i] + h
        integral[i + 1] = integral[i] + h * (s[i] + h * (s_dot[i] / 2.0 + h * s_ddot[i] / 6.0))
    return t, s.copy(), s_dot, integral, s_ddot


@compiled(nrt=False)
def smooth_law_at(law: TimeLaw, window: float, time: float) -> tuple[float, float, float]:
    """s, s_dot and s_ddot at a time of the law convolved with a rectangle of width `window` (s).

    The convolution makes s_ddot continuous and piecewise linear, preserves rest at both ends, and lengthens
    the motion by the window.
    """
    s_new, v_new, integral_new = _law_at(law, time)
    s_old, v_old, integral_old = _law_at(law, time - window)
    return (
        min(max((integral_new - integral_old) / window, 0.0), 1.0),
        max((s_new - s_old) / window, 0.0),
        (v_new - v_old) / window,
    )


@compiled(nrt=False)
def _law_at(law: TimeLaw, time: float) -> tuple[float, float, float]:
    """s, s_dot and the integral of s; at rest before and after."""
    t, s, s_dot, integral, s_ddot = law
    if time <= 0.0:
        return 0.0, 0.0, 0.0
    if time >= t[-1]:
        return s[-1], 0.0, integral[-1] + (time - t[-1]) * s[-1]
    i = interval_at(t, time)
    x, v, a = time - t[i], s_dot[i], s_ddot[i]
    return (
        s[i] + x * (v + x * a / 2.0),
        v + x * a,
        integral[i] + x * (s[i] + x * (v / 2.0 + x * a / 6.0)),
    )
