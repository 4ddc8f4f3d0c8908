"""Laws of viability: braking is always possible, and nothing more is forbidden than must be."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from robots_core.blocks.inverse_kinematics.viability import (
    braking_distance,
    fastest_stoppable,
    velocity_interval,
)

decelerations = st.floats(0.1, 100.0)
periods = st.sampled_from([0.001, 0.004, 0.01, 0.1])


def simulated_braking_distance(speed: float, deceleration: float, dt: float) -> float:
    way = 0.0
    while speed > 0.0:
        end = max(speed - deceleration * dt, 0.0)
        way += 0.5 * dt * (speed + end)
        speed = end
    return way


@given(speed=st.floats(0.0, 5.0), deceleration=decelerations, dt=periods)
def test_braking_distance_is_that_of_a_simulation(speed: float, deceleration: float, dt: float) -> None:
    simulated = simulated_braking_distance(speed, deceleration, dt)
    # A sum over up to 5e4 periods.
    np.testing.assert_allclose(braking_distance(speed, deceleration, dt), simulated, rtol=1e-9, atol=1e-12)


@given(distance=st.floats(0.0, 10.0), deceleration=decelerations, dt=periods)
def test_fastest_stoppable_uses_the_whole_distance(distance: float, deceleration: float, dt: float) -> None:
    speed = fastest_stoppable(distance, deceleration, dt)
    used = 0.5 * dt * speed + braking_distance(speed, deceleration, dt)
    np.testing.assert_allclose(used, distance, rtol=1e-9, atol=1e-14)


@settings(max_examples=200)
@given(
    start=st.floats(-1.0, 1.0),
    deceleration=st.floats(0.3, 1.0),
    dt=periods,
    choices=st.lists(st.sampled_from([0.0, 1.0, 0.5, 0.97]), min_size=1, max_size=200),
)
def test_any_choice_inside_the_interval_stays_inside_the_limits(
    start: float, deceleration: float, dt: float, choices: list[float]
) -> None:
    lower, upper, velocity, acceleration = (np.array([value]) for value in (-1.0, 1.0, 2.0, 8.0))
    q, v, low, high = np.array([start]), np.zeros(1), np.empty(1), np.empty(1)
    for choice in choices:
        limits = np.array([lower, upper, velocity, acceleration, deceleration * acceleration])
        velocity_interval(q, v, limits, dt, low, high)
        brake = v - np.clip(v, -deceleration * acceleration * dt, deceleration * acceleration * dt)
        assert low[0] - 1e-12 <= brake[0] <= high[0] + 1e-12
        w = low + choice * (high - low)
        assert abs(w[0]) <= velocity[0]
        assert abs(w[0] - v[0]) <= acceleration[0] * dt * (1.0 + 1e-12)
        # The extreme of the parabola between the samples, where there is one.
        times = np.linspace(0.0, dt, 9)
        between = q + v * times + 0.5 * (w - v) / dt * times**2
        assert np.abs(between).max() <= 1.0 + 1e-12
        q, v = q + 0.5 * dt * (v + w), w
