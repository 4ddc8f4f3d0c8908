"""Rounding that does not contradict a verdict."""

from typing import Final

MOST_DIGITS: Final = 12


def apart(value: float, bound: float, digits: int) -> str:
    """A value with so many digits behind the point, with more where it would be rounded onto its bound."""
    for more in range(digits, MOST_DIGITS):
        text = f'{value:.{more}f}'
        if float(text) != bound and (float(text) > bound) == (value > bound):
            return text
    return repr(value)
