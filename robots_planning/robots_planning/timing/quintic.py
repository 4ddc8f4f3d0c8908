# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""Piecewise quintics that match values, first and second derivatives, compiled."""

from math import sqrt

from robots_core.kernels.compiled import compiled
from robots_core.validation import Array


@compiled(counted=False)
def quintic_coefficients(x: Array, p: Array, v: Array, a: Array, coefficients: Array) -> None:
    """Fill (m - 1, 6, n): polynomial per interval, in powers of the distance from the interval's start.

    Args:
        x: (m,), increasing.
        p: Values at x, (m, n).
        v: First derivatives.
        a: Second derivatives.
        coefficients: Filled.
    """
    for i in range(x.size - 1):
        h = x[i + 1] - x[i]
        for k in range(p.shape[1]):
            d = p[i + 1, k] - p[i, k]
            v0, v1, a0, a1 = h * v[i, k], h * v[i + 1, k], h * h * a[i, k], h * h * a[i + 1, k]
            coefficients[i, 0, k] = p[i, k]
            coefficients[i, 1, k] = v[i, k]
            coefficients[i, 2, k] = 0.5 * a[i, k]
            coefficients[i, 3, k] = (10.0 * d - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1) / h**3
            coefficients[i, 4, k] = (-15.0 * d + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1) / h**4
            coefficients[i, 5, k] = (6.0 * d - 3.0 * v0 - 3.0 * v1 - 0.5 * a0 + 0.5 * a1) / h**5


@compiled(counted=False)
def interval_at(x: Array, value: float) -> int:
    """The interval of increasing x (m,) that `value` lies in; the first or last one outside."""
    low, high = 0, x.size - 1
    while high - low > 1:
        middle = (low + high) // 2
        if value >= x[middle]:
            low = middle
        else:
            high = middle
    return low


@compiled(counted=False)
def quintics_at(x: Array, coefficients: Array, values: Array, p: Array, v: Array, a: Array) -> None:
    """Fill p, v and a (m, n) at values (m,), clipped to the range of x."""
    n = p.shape[1]
    low, high = x[0], x[-1]
    for row in range(values.size):
        value = min(max(values[row], low), high)
        i = interval_at(x, value)
        h = value - x[i]
        for k in range(n):
            c1, c2, c3 = coefficients[i, 1, k], coefficients[i, 2, k], coefficients[i, 3, k]
            c4, c5 = coefficients[i, 4, k], coefficients[i, 5, k]
            p[row, k] = coefficients[i, 0, k] + h * (c1 + h * (c2 + h * (c3 + h * (c4 + h * c5))))
            v[row, k] = c1 + h * (2.0 * c2 + h * (3.0 * c3 + h * (4.0 * c4 + h * 5.0 * c5)))
            a[row, k] = 2.0 * c2 + h * (6.0 * c3 + h * (12.0 * c4 + h * 20.0 * c5))


@compiled(counted=False)
def quintic_extremes(c: Array, h: float) -> tuple[float, float, float]:
    """Largest |first|, |second| and |third derivative| of a quintic with coefficients c (6,) over [0, h].

    Second and third are exact. The first is evaluated at the extremes of the second and at fifths of the
    interval.
    """
    c2, c3, c4, c5 = c[2], c[3], c[4], c[5]
    first, second, third = 0.0, 0.0, 0.0
    for part in range(6):
        y = h * part / 5.0
        first = max(first, abs(c[1] + y * (2.0 * c2 + y * (3.0 * c3 + y * (4.0 * c4 + y * 5.0 * c5)))))
    # Zeros and the vertex of the third derivative, 6 c3 + 24 c4 y + 60 c5 y^2.
    inside = max(c4 * c4 - 2.5 * c3 * c5, 0.0)
    root = sqrt(inside)
    for candidate in range(6):
        y = 0.0
        if candidate == 1:
            y = h
        elif candidate == 2 and c5 != 0.0:
            y = (-2.0 * c4 - 2.0 * root) / (10.0 * c5)
        elif candidate == 3 and c5 != 0.0:
            y = (-2.0 * c4 + 2.0 * root) / (10.0 * c5)
        elif candidate == 4 and c5 != 0.0:
            y = -c4 / (5.0 * c5)
        elif candidate == 5 and c4 != 0.0:
            y = -c3 / (4.0 * c4)
        y = min(max(y, 0.0), h)
        first = max(first, abs(c[1] + y * (2.0 * c2 + y * (3.0 * c3 + y * (4.0 * c4 + y * 5.0 * c5)))))
        second = max(second, abs(2.0 * c2 + y * (6.0 * c3 + y * (12.0 * c4 + y * 20.0 * c5))))
        third = max(third, abs(6.0 * c3 + y * (24.0 * c4 + y * 60.0 * c5)))
    return first, second, third


@compiled(counted=False)
def quintic_uses(x: Array, coefficients: Array, limits: Array, uses: Array) -> None:
    """Fill uses (m - 1, 3): per interval and derivative, the largest ratio to its limit.

    Args:
        x: (m,), increasing.
        coefficients: (m - 1, 6, n).
        limits: Of the first, second and third derivative, (3, n); infinite for none.
        uses: Filled.
    """
    for i in range(x.size - 1):
        uses[i] = 0.0
        for k in range(coefficients.shape[2]):
            extremes = quintic_extremes(coefficients[i, :, k], x[i + 1] - x[i])
            for order in range(3):
                uses[i, order] = max(uses[i, order], extremes[order] / limits[order, k])
