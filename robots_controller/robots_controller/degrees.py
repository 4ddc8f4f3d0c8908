"""Degrees: the unit of angles in robot programs and in what is shown of them. All else uses radians."""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from robots_core.errors import RobotsError, UnreachablePoseError
from robots_core.validation import Array

_NUMBER: Final = r'[-+]?(?:inf|\d+(?:\.\d+)?(?:e[-+]?\d+)?)'
# `rad (m)` is a unit of axes that turn or slide; such values are not converted.
_ANGLE: Final = re.compile(
    rf'(?P<value>{_NUMBER}|\[{_NUMBER}, {_NUMBER}\]) rad(?P<derivative>/s(?:\^\d)?)?(?!\w| \(m\))'
)
_FULL_TURN: Final = 6.2833
_WRITTEN: Final = 6e-4  # rad; what is lost by three digits behind the point
_SHORT: Final = frozenset({-3.14, -1.57, 1.57, 3.14})  # as people write them too
_FEWEST_DIGITS: Final = 5  # fewer are of numbers that end in zeros, which were dropped


def to_si(value: float, unit: str, *, sliding: bool = False) -> float:
    """A program's number in SI units: radians for degrees.

    Args:
        value: As the program wrote it.
        unit: The argument's.
        sliding: It belongs to an axis that slides, so that 'deg (m)' means metres.
    """
    return math.radians(value) if unit.startswith('deg') and not sliding else value


def joints_to_program(q: Array, prismatic: tuple[bool, ...]) -> tuple[float, ...]:
    """Joint positions, or speeds, (n,) as a program has them: degrees, metres for sliding axes."""
    slides = prismatic or (False,) * q.size
    return tuple(float(v) if s else math.degrees(v) for v, s in zip(q, slides, strict=True))


def joints_text(q: Array, prismatic: tuple[bool, ...]) -> str:
    """Joint positions (n,) for a person: '(90.00 deg, 0.500 m)'."""
    slides = prismatic or (False,) * len(q)
    values = zip(joints_to_program(q, slides), slides, strict=True)
    return f'({", ".join(f"{v:.3f} m" if slide else f"{v:.2f} deg" for v, slide in values)})'


def pose_to_program(r: Array, angles: Array) -> tuple[float, ...]:
    """Position (3,) m and orientation angles (3,) rad as a program has them."""
    return (*map(float, r), *map(math.degrees, angles))


def in_degrees(text: str) -> str:
    """A message with its angles in degrees.

    Messages of planners and controllers count in radians; whatever shows one to a program or its author
    passes it through here.
    """
    return _ANGLE.sub(
        lambda found: f'{re.sub(_NUMBER, _converted, found["value"])} deg{found["derivative"] or ""}',
        text,
    )


def for_program(error: RobotsError, *, pose_angles: Sequence[float] = ()) -> str:
    """The message of an error as a program sees it: in degrees, with a hint where radians were given.

    Args:
        error: Why a motion, or another call, was refused.
        pose_angles: Orientation angles (3,) of the pose that was commanded, deg; () for none.
    """
    hint = _radians_hint(error.details)
    if not hint and error.code == UnreachablePoseError.code:
        hint = radians_hint(pose_angles)
    return in_degrees(error.message) + hint


def radians_hint(angles: Iterable[float]) -> str:
    """The end of a message about angles that look like radians; '' where they do not.

    They do where all of them are 0 or a multiple of 30 or 45 degrees in radians, to three digits behind the
    point.

    Args:
        angles: As a program has them, deg.
    """
    given = tuple(angles)
    if not any(given) or not all(abs(angle) <= _FULL_TURN and _is_round(angle) for angle in given):
        return ''
    meant = ', '.join(f'{round(math.degrees(angle)):d}' for angle in given)
    return f'; angles are degrees: {f"({meant})" if len(given) > 1 else meant}?'


def _is_round(angle: float) -> bool:
    """0, or a multiple of 30 or 45 degrees in radians."""
    if angle in _SHORT:
        return True
    return any(abs(math.remainder(angle, step)) < _WRITTEN for step in (math.pi / 6.0, math.pi / 4.0))


def _radians_hint(details: Mapping[str, str | float]) -> str:
    """The end of a message about a joint limit, if the position is inside it once taken for radians."""
    if details.get('unit') != 'rad':
        return ''
    try:
        value, lower, upper = (float(details[name]) for name in ('value', 'lower', 'upper'))
    except (KeyError, ValueError):
        return ''
    meant = math.degrees(value)
    if abs(meant) > 2.0 * math.pi or not lower <= meant <= upper:
        return ''
    return f'; angles are degrees: {math.degrees(meant):.4g}?'


def _converted(found: re.Match[str]) -> str:
    text = found.group()
    digits = max(len(re.sub(r'e.*|\D', '', text).lstrip('0')) - 1, _FEWEST_DIGITS)
    sign = '+' if text.startswith('+') else ''
    return f'{math.degrees(float(text)):{sign}.{digits}g}'
