"""Degrees: messages that count in radians, as programs write angles."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots_controller.degrees import for_program, in_degrees
from robots_core.errors import JointLimitError, RobotsError, UnreachablePoseError


@pytest.mark.parametrize(
    ('message', 'expected'),
    [
        (
            str(JointLimitError('A2', *np.radians([10.0, -140.0, -5.0]).tolist())),
            'A2 = 10 deg is outside its limits [-140, -5] deg',
        ),
        (
            'the closest pose found is 20.1 mm and 0.0349 rad off',
            'the closest pose found is 20.1 mm and 1.9996 deg off',
        ),
        ('A1 velocity 3.14159 rad/s at 0.2 s', 'A1 velocity 180 deg/s at 0.2 s'),
        (
            'jerk of A1 is -1.5708e+03 rad/s^3, allowed is [-inf, 0.5] rad/s^3',
            'jerk of A1 is -90000 deg/s^3, allowed is [-inf, 28.648] deg/s^3',
        ),
        (
            str(JointLimitError('A4', *np.radians([180.0004, -180.0, 180.0]).tolist())),
            'A4 = 180.0004 deg is outside its limits [-180, 180] deg',
        ),
        ('starts +0.0174533 rad from where', 'starts +1 deg from where'),
        ('at 12.5 % of its 0.300 m, 0.500 rad: it', 'at 12.5 % of its 0.300 m, 28.648 deg: it'),
        ('position jumps by 0.01 rad (m) at 0.1 s', 'position jumps by 0.01 rad (m) at 0.1 s'),
        ('J1 = 0.5 m of 3 radii, no_1 radar', 'J1 = 0.5 m of 3 radii, no_1 radar'),
    ],
)
def test_angles_in_messages_are_shown_in_degrees(message: str, expected: str):
    assert in_degrees(message) == expected
    assert in_degrees(expected) == expected


@given(st.floats(-1e4, 1e4))
def test_an_angle_that_a_program_wrote_comes_back_to_five_digits(angle: float):
    shown = in_degrees(f'A1 = {np.radians(angle):.6g} rad').removeprefix('A1 = ').removesuffix(' deg')
    assert float(shown) == pytest.approx(angle, rel=5.1e-5, abs=1e-300)


@pytest.mark.parametrize(
    ('degrees', 'hint'),
    [(-1.57, '; angles are degrees: -89.95?'), (-0.01, ''), (-200.0, ''), (3.0, '')],
)
def test_radians_in_the_place_of_degrees_are_recognised(degrees: float, hint: str):
    error = JointLimitError('A2', math.radians(degrees), math.radians(-140), math.radians(-5))
    for one in (error, RobotsError(error.message, **{name: str(v) for name, v in error.details.items()})):
        assert for_program(one) == in_degrees(error.message) + hint


@pytest.mark.parametrize(
    ('angles', 'meant'),
    [
        ((0.0, 3.1416, 0.0), '(0, 180, 0)'),
        ((-1.57, 0.524, math.pi / 4), '(-90, 30, 45)'),
        ((0.0, 0.0, 0.0), ''),
        ((0.0, 90.0, 1.5708), ''),
        ((0.0, 1.5, 0.0), ''),
        ((0.0, 180.0, 0.0), ''),
    ],
)
def test_orientation_angles_in_radians_are_recognised(angles: tuple[float, ...], meant: str):
    hint = f'; angles are degrees: {meant}?' if meant else ''
    assert for_program(UnreachablePoseError('too far'), pose_angles=angles) == f'too far{hint}'
    assert for_program(RobotsError('in the way'), pose_angles=angles) == 'in the way'
