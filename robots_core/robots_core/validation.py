"""Checks at the boundary: every block validates what comes in once, with these."""

from collections.abc import Callable, Collection
from math import isfinite

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robots_core.errors import InvalidInputError

Array = NDArray[np.float64]
FLOAT64 = np.dtype(np.float64)

# Rounding of a float64 3x3 product chain is about 1e-15; messages carry quaternions of any source,
# so a rotation may be off by single-precision rounding and is still meant as one.
ROTATION_TOLERANCE = 1e-6


def read_only(values: ArrayLike) -> Array:
    """A float64 copy of `values` that cannot be written to."""
    array = np.array(values, dtype=np.float64)
    array.flags.writeable = False
    return array


def finite_vector(values: ArrayLike, size: int, name: str) -> Array:
    """`values` as a float64 array of shape (size,).

    Raises:
        InvalidInputError: another shape, or NaN or infinity in it.
    """
    # What is called per sample passes here: on a few values numpy's own reductions take several times longer.
    # A sum that is not finite, of large values too, leaves the answer to the complete check.
    if (
        type(values) is np.ndarray
        and values.shape == (size,)
        and values.dtype is FLOAT64
        and isfinite(sum(values.tolist()))
    ):
        return values
    if isinstance(values, np.ndarray) and values.dtype.kind == 'c':  # of which numpy would take the real part
        raise InvalidInputError(f'{name} must be {size} numbers, got {values!r}')
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise InvalidInputError(f'{name} must be {size} numbers, got {values!r}') from error
    if array.shape != (size,):
        raise InvalidInputError(f'{name} must have shape ({size},), got {array.shape}')
    if not np.isfinite(array).all():
        index = int(np.flatnonzero(~np.isfinite(array))[0])
        raise InvalidInputError(
            f'{name}[{index}] is {array[index]}, every value must be a finite number', index=index
        )
    return array


def bounded_vector(values: ArrayLike, size: int, name: str, bound: float, unit: str) -> Array:
    """`values` as a float64 array of shape (size,), none of them further than `bound` from 0.

    Raises:
        InvalidInputError: another shape, NaN or infinity in it, or a value past the bound.
    """
    array = finite_vector(values, size, name)
    index = int(np.abs(array).argmax())
    if abs(array[index]) > bound:
        raise InvalidInputError(
            f'{name}[{index}] = {array[index]:.6g} {unit} must be within +-{bound:g} {unit}', index=index
        )
    return array


def finite_state(q: ArrayLike, q_dot: ArrayLike, size: int) -> tuple[Array, Array]:
    """`q` and `q_dot` as float64 arrays of shape (size,).

    Raises:
        InvalidInputError: one of them has another shape, or NaN or infinity in it.
    """
    return finite_vector(q, size, 'q'), finite_vector(q_dot, size, 'q_dot')


def finite_motion(q: ArrayLike, q_dot: ArrayLike, q_ddot: ArrayLike, size: int) -> tuple[Array, Array, Array]:
    """`q`, `q_dot` and `q_ddot` as float64 arrays of shape (size,), checked in one go.

    Raises:
        InvalidInputError: one of them has another shape, or NaN or infinity in it.
    """
    if (
        type(q) is type(q_dot) is type(q_ddot) is np.ndarray
        and q.shape == q_dot.shape == q_ddot.shape == (size,)
        and q.dtype is q_dot.dtype is q_ddot.dtype is FLOAT64
        and isfinite(sum(q.tolist() + q_dot.tolist() + q_ddot.tolist()))
    ):
        return q, q_dot, q_ddot
    return *finite_state(q, q_dot, size), finite_vector(q_ddot, size, 'q_ddot')


def rotation_matrix(T: ArrayLike) -> Array:
    """`T` as a float64 rotation matrix of shape (3, 3).

    Raises:
        InvalidInputError: another shape, not finite, not orthonormal or left-handed.
    """
    array = np.asarray(T, dtype=np.float64)
    if array.shape != (3, 3):
        raise InvalidInputError(f'T must have shape (3, 3), got {array.shape}')
    # On nine values numpy's own products and reductions take several times longer.
    (a, b, c), (d, e, f), (g, h, i) = array.tolist()
    most = ROTATION_TOLERANCE
    if not (
        abs(a * a + b * b + c * c - 1.0) <= most
        and abs(d * d + e * e + f * f - 1.0) <= most
        and abs(g * g + h * h + i * i - 1.0) <= most
        and abs(a * d + b * e + c * f) <= most
        and abs(a * g + b * h + c * i) <= most
        and abs(d * g + e * h + f * i) <= most
    ):
        deviation = float(np.abs(array @ array.T - np.eye(3)).max())
        raise InvalidInputError(
            f'T is not a rotation matrix: T T^T differs from identity by {deviation:.3g}, '
            f'allowed is {ROTATION_TOLERANCE:g}'
        )
    if a * (e * i - f * h) + b * (f * g - d * i) + c * (d * h - e * g) < 0.0:
        raise InvalidInputError('T is left-handed (determinant -1); a rotation has determinant +1')
    return array


def one_of(name: str, choices: Collection[str]) -> Callable[[str], str]:
    """Passes a name on, and raises an InvalidInputError if it is none of the choices."""

    def check(value: str) -> str:
        if value not in choices:
            *first, last = (choice or "''" for choice in choices)
            raise InvalidInputError(f'{name} {value!r} is unknown; valid are {", ".join(first)} and {last}')
        return value

    return check


def positive(value: float, name: str, unit: str = '') -> float:
    """`value` if it is a finite number above zero.

    Raises:
        InvalidInputError: zero, negative, NaN or infinite.
    """
    if not (np.isfinite(value) and value > 0.0):
        raise InvalidInputError(f'{name} = {value!r} {unit}'.rstrip() + ' must be a finite number above 0')
    return float(value)


def fraction(value: float, name: str) -> float:
    """`value` if it lies in [0, 1].

    Raises:
        InvalidInputError: outside, NaN or infinite.
    """
    if not 0.0 <= value <= 1.0:
        raise InvalidInputError(f'{name} = {value!r} must be in [0, 1]')
    return float(value)
