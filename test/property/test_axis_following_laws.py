"""AxisFollowing: what holds for every start and every reference."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from robots_core import load_robot_model
from robots_core.blocks.following.axis_following import ROUNDING, AxisFollowing

ROBOT = load_robot_model('bello_bot')
AXES = ROBOT.axes_data
DT = 0.004  # s
# The slowest axis goes through its range at its limits in less; the rest is for the approach.
STEPS = 4000
shares = st.lists(st.floats(0.0, 1.0), min_size=AXES.num_axes, max_size=AXES.num_axes)


def at(share: list[float]) -> np.ndarray:
    """A place in the range of every axis."""
    return np.clip(AXES.lower + np.array(share) * (AXES.upper - AXES.lower), AXES.lower, AXES.upper)


@given(start=shares, end=shares, near=st.sampled_from([0.0, 1e-12, 1e-6, 1.0]))
def test_a_resting_reference_is_reached_and_stood_at(
    start: list[float], end: list[float], near: float
) -> None:
    reference, still = at(end), np.zeros(AXES.num_axes)
    q, q_dot = reference + near * (at(start) - reference), still
    following = AxisFollowing(AXES, DT)
    for _ in range(STEPS):
        q, q_dot, _ = following.step(q, q_dot, reference, still)
        # Standing is no speed at all: code that waits for it compares with zero.
        if not q_dot.any() and np.abs(q - reference).max() <= ROUNDING:
            break
    else:
        raise AssertionError(f'still moves at {q_dot}, {q - reference} beside its reference')
    np.testing.assert_array_equal(following.step(q, q_dot, reference, still)[1], still)
