"""AccelerationEstimate: exact for constant accelerations, filtered, and zero where samples do not follow."""

from __future__ import annotations

import numpy as np
import pytest

from robots_core.blocks.multibody.acceleration_estimate import LONGEST_GAP, AccelerationEstimate

Q_DDOT = np.array([0.5, -2.0])
STEP = 0.01  # s


def accelerated(estimate: AccelerationEstimate, *times: float) -> np.ndarray:
    """The estimate after samples of axes that accelerate by `Q_DDOT`."""
    found = np.zeros(2)
    for time in times:
        found = estimate.take(time, Q_DDOT * time)
    return found


def test_a_constant_acceleration_is_exact_without_a_filter() -> None:
    np.testing.assert_allclose(accelerated(AccelerationEstimate(0.0), 1.0, 1.01, 1.03), Q_DDOT)


def test_the_filter_approaches_it_by_its_time_constant() -> None:
    filter_time, count = 0.1, 200
    estimate = AccelerationEstimate(filter_time)
    found = accelerated(estimate, *np.arange(count + 1) * STEP)
    left = (filter_time / (filter_time + STEP)) ** count  # of the implicit Euler method
    np.testing.assert_allclose(found, Q_DDOT * (1.0 - left))
    estimate.filter_time = 0.0
    np.testing.assert_allclose(accelerated(estimate, (count + 1) * STEP), Q_DDOT)


@pytest.mark.parametrize('time', [1.0, 0.5, 1.0 + 1.1 * LONGEST_GAP])
def test_samples_that_do_not_follow_give_none(time: float) -> None:
    estimate = AccelerationEstimate(0.0)
    assert not accelerated(estimate, 1.0 - STEP, 1.0, time).any()
    np.testing.assert_allclose(accelerated(estimate, time + STEP), Q_DDOT)
