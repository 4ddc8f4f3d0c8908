"""Profiles of a few axes that switch together: the instants of their switches."""

from __future__ import annotations

import numpy as np
import pytest

from robots_planning.timing.state_to_rest_profile import _distinct


@pytest.mark.parametrize('size', [1, 2, 40])
def test_instants_are_sorted_and_distinct(size: int) -> None:
    instants = np.random.default_rng(size).integers(-9, 9, size)
    np.testing.assert_array_equal(_distinct(instants), np.unique(instants))
