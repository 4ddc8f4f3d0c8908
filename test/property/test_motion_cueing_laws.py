"""Laws of MotionCueing for any motion of the vehicle."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from robots_core.blocks import CabinEnvelope, MotionCueing, VehicleMotion, WashoutSettings
from robots_core.validation import Array

G = 9.80665
DT = 0.02  # s
SETTINGS = WashoutSettings(return_frequency=(0.6, 0.6, 0.8))
ENVELOPE = CabinEnvelope(
    reach=(0.3, 0.4, 0.2, 0.2, 0.15, 0.25),
    velocity=(0.6, 0.8, 0.5, 0.3, 0.3, 0.4),
    acceleration=(1.5, 2.0, 1.0, 0.5, 0.6, 0.7),
)
# Numbers of all sizes: what a broken vehicle model sends too.
number = st.one_of(st.floats(-20.0, 20.0), st.floats(-1e12, 1e12))
six = st.lists(number, min_size=6, max_size=6).map(np.array)
up_to_one = st.lists(st.floats(-1.0, 1.0), min_size=6, max_size=6).map(np.array)
# Samples that hold for some periods; None: none comes.
pieces = st.lists(st.tuples(st.integers(1, 30), st.none() | six), min_size=1, max_size=12)


def motion(values: Array) -> VehicleMotion:
    return VehicleMotion(values[:3] + np.array([0.0, 0.0, G]), values[3:])


@given(pieces)
@settings(max_examples=20, deadline=None)
def test_the_envelope_holds_and_the_cabin_comes_to_rest(parts: list[tuple[int, Array | None]]) -> None:
    cueing = MotionCueing(SETTINGS, ENVELOPE, DT)
    steps = [
        cueing.step(None if values is None else motion(values))
        for count, values in parts
        for _ in range(count)
    ]
    steps += [cueing.step(None) for _ in range(1250)]
    states = np.array([step.cabin for step in steps])
    position = np.vstack([np.zeros((2, 6)), states[:, 0]])
    within = 1.0 + 1e-6  # second differences round to 1e-16 / (20 ms)^2 of 1 m/s^2
    assert np.isfinite(states).all()
    assert (np.abs(position) <= np.array(ENVELOPE.reach) + 1e-12).all()
    assert (np.abs(states[:, 1]) <= np.array(ENVELOPE.velocity) * within).all()
    assert (np.abs(states[:, 2]) <= np.array(ENVELOPE.acceleration) * within).all()
    assert (np.abs(np.diff(position, axis=0)) <= np.array(ENVELOPE.velocity) * DT * within).all()
    assert (np.abs(np.diff(position, 2, axis=0)) <= np.array(ENVELOPE.acceleration) * DT**2 * within).all()
    # After the fading, 14 times the slowest time constant: what is left of a metre is below this.
    assert np.abs(states[-1]).max() < 1e-4


@given(up_to_one, up_to_one, st.floats(-2.0, 2.0))
@settings(max_examples=20, deadline=None)
def test_small_motions_add_up(one: Array, other: Array, factor: float) -> None:
    def washout(values: Array) -> Array:
        cueing = MotionCueing(SETTINGS, ENVELOPE, DT)
        waves = np.sin(0.1 * np.arange(50))
        return np.array([cueing.step(motion(1e-3 * wave * values)).washout[0] for wave in waves])

    both = washout(one + factor * other)
    # Products of two signals of 1e-3 that are at most 3 each, over 1 s.
    np.testing.assert_allclose(both, washout(one) + factor * washout(other), atol=1e-5)


@given(six)
@settings(max_examples=20, deadline=None)
def test_left_and_right_are_alike(values: Array) -> None:
    """Mirrored at the plane of forward and up."""
    mirror = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
    one, other = MotionCueing(SETTINGS, ENVELOPE, DT), MotionCueing(SETTINGS, ENVELOPE, DT)
    here = [one.step(motion(values)).cabin for _ in range(50)]
    there = [other.step(motion(mirror * values)).cabin for _ in range(50)]
    np.testing.assert_allclose(np.array(here) * mirror, there, atol=1e-9)
