"""Functions of Pinocchio with a check of their arguments by the result, which takes less time."""

from collections.abc import Callable
from math import isfinite

import pinocchio as pin

from robots_core.validation import FLOAT64, Array, finite_motion


def of_motion(  # noqa: PLR0917  # in the order of Pinocchio's functions
    function: Callable[..., Array], model: pin.Model, data: pin.Data, q: Array, q_dot: Array, x: Array
) -> Array:
    """`function(model, data, q, q_dot, x)`, one of `pin.rnea` and `pin.aba`, with its arguments checked.

    Args:
        function: The function.
        model: Has one position per joint, n.
        data: Its memory.
        q: Joint positions, (n,), rad (m).
        q_dot: Joint velocities, (n,), rad/s (m/s).
        x: Joint accelerations, (n,), rad/s^2 (m/s^2), or torques, (n,), N m (N).

    Raises:
        InvalidInputError: an argument of another shape or not finite.
    """
    # Pinocchio rejects arrays of another size, but accepts columns and misreads another byte order. Its
    # result is finite only if q and x are; the speed of a single axis that slides has no effect on it.
    try:
        result = function(model, data, q, q_dot, x)
        if (
            q.dtype is q_dot.dtype is x.dtype is FLOAT64
            and q.ndim == q_dot.ndim == x.ndim == 1
            and isfinite(sum(result.tolist(), sum(q_dot.tolist())))
        ):
            return result
    except (AttributeError, TypeError, ValueError):
        pass
    return function(model, data, *finite_motion(q, q_dot, x, model.nv))
