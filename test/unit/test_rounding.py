"""Rounded figures that do not contradict a verdict."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots_core.wording.rounding import apart


@pytest.mark.parametrize(
    ('value', 'bound', 'text'),
    [(30.04, 30.0, '30.04'), (29.996, 30.0, '29.996'), (12.34, 30.0, '12.3'), (0.10004, 0.1, '0.10004')],
)
def test_a_value_has_as_many_digits_as_its_side_of_the_bound_needs(
    value: float, bound: float, text: str
) -> None:
    assert apart(value, bound, 1) == text


@given(st.floats(0.0, 1e3), st.floats(0.0, 1e3))
def test_what_is_shown_is_on_the_side_of_the_value(value: float, bound: float) -> None:
    if value != bound:
        assert (float(apart(value, bound, 2)) > bound) == (value > bound)
