"""Checks at the boundary name what came, the bound, and what would be valid."""

from __future__ import annotations

import numpy as np
import pytest

from robots_core.errors import InvalidInputError, RobotsError
from robots_core.validation import (
    finite_motion,
    finite_state,
    finite_vector,
    fraction,
    positive,
    read_only,
    rotation_matrix,
)


def test_finite_vector_takes_any_sequence_of_numbers():
    for values in ([1, 2, 3], (1.0, 2.0, 3.0), np.array([1, 2, 3], dtype=np.int32)):
        vector = finite_vector(values, 3, 'q')
        assert vector.dtype == np.float64
        np.testing.assert_array_equal(vector, [1.0, 2.0, 3.0])


@pytest.mark.parametrize(
    ('values', 'message'),
    [
        ([1, 2], r'q must have shape \(3,\), got \(2,\)'),
        ([[1, 2, 3]], r'got \(1, 3\)'),
        (1.0, r'got \(\)'),
        (None, 'shape|numbers'),
        ('abc', 'q must be 3 numbers'),
        ([1, [2], 3], 'q must be 3 numbers'),
        (np.array([1.0, 2.0j, 3.0]), 'q must be 3 numbers'),
        ([1, 2, np.nan], r'q\[2\] is nan.*finite'),
        ([-np.inf, 2, 3], r'q\[0\] is -inf.*finite'),
    ],
)
def test_finite_vector_refuses(values: object, message: str):
    with pytest.raises(InvalidInputError, match=message):
        finite_vector(values, 3, 'q')  # type: ignore[arg-type]


def test_finite_vector_hands_on_what_needs_no_change():
    values = np.array([1.0, -2.0])
    assert finite_vector(values, 2, 'q') is values


def test_finite_vector_takes_finite_values_whose_sum_is_not():
    largest = np.finfo(np.float64).max
    np.testing.assert_array_equal(finite_vector(np.full(3, largest), 3, 'q'), [largest] * 3)


@pytest.mark.parametrize(
    ('values', 'index'), [((0.0, np.nan, 0.0), 1), ((np.inf, 0.0, -np.inf), 0), ((0.0, 0.0, -np.inf), 2)]
)
def test_finite_vector_refuses_what_is_not_finite_in_an_array(values: tuple[float, ...], index: int):
    with pytest.raises(InvalidInputError, match=rf'q\[{index}\] is '):
        finite_vector(np.array(values), 3, 'q')


def test_finite_state_and_motion_take_sequences_and_arrays():
    expected = np.array([[1.0, 2.0], [3.0, 4.0], [1e308, 1e308]])
    for convert in (list, tuple, np.array):
        motion = [convert(values) for values in ([1, 2], [3.0, 4.0], [1e308, 1e308])]
        for vectors in (
            finite_motion(*motion, 2),
            finite_state(*motion[:2], 2),
            finite_state(*motion[1:], 2),
        ):
            assert all(vector.dtype == np.float64 for vector in vectors)
        np.testing.assert_array_equal(finite_motion(*motion, 2), expected)
        np.testing.assert_array_equal(finite_state(*motion[1:], 2), expected[1:])


@pytest.mark.parametrize('bad', [[0.0], [[0.0], [0.0]], [0.0, np.nan], [-np.inf, np.inf], 'ab'])
@pytest.mark.parametrize('index', [0, 1, 2])
def test_finite_state_and_motion_name_what_they_refuse(index: int, bad: object):
    named = rf'^{("q", "q_dot", "q_ddot")[index]}(\[\d\])? '
    for values in (bad, np.array(bad)):
        motion: list[object] = [np.zeros(2)] * 3
        motion[index] = values
        with pytest.raises(InvalidInputError, match=named):
            finite_motion(*motion, 2)  # type: ignore[arg-type]
        if index < 2:
            with pytest.raises(InvalidInputError, match=named):
                finite_state(*motion[:2], 2)  # type: ignore[arg-type]


def test_errors_are_robots_errors_and_value_errors():
    with pytest.raises(RobotsError):
        positive(0.0, 'speed', 'm/s')
    with pytest.raises(ValueError, match='speed'):
        positive(0.0, 'speed', 'm/s')


@pytest.mark.parametrize('value', [0.0, -1.0, np.nan, np.inf, -np.inf])
def test_positive_refuses(value: float):
    with pytest.raises(InvalidInputError, match=r'speed = .* m/s must be a finite number above 0'):
        positive(value, 'speed', 'm/s')


def test_positive_keeps_the_value():
    assert positive(1e-300, 'speed') == 1e-300


@pytest.mark.parametrize('value', [-0.1, 1.1, np.nan, np.inf])
def test_fraction_refuses(value: float):
    with pytest.raises(InvalidInputError, match=r'override = .* must be in \[0, 1\]'):
        fraction(value, 'override')


def test_fraction_includes_its_bounds():
    assert (fraction(0.0, 'f'), fraction(1.0, 'f')) == (0.0, 1.0)


def test_rotation_matrix_allows_single_precision_and_no_more():
    angle = 0.3
    T = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    np.testing.assert_array_equal(rotation_matrix(T.astype(np.float32)), T.astype(np.float32))
    with pytest.raises(InvalidInputError, match='differs from identity'):
        rotation_matrix(T * (1.0 + 1e-5))


def test_read_only_copies():
    values = np.ones(3)
    copy = read_only(values)
    values[0] = 7.0
    np.testing.assert_array_equal(copy, 1.0)
    with pytest.raises(ValueError, match='read-only'):
        copy[0] = 7.0
