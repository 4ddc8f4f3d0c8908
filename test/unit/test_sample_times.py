"""SampleTimes: stamps of the robot's clock are exact, those of another one give the time between samples."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots_core.blocks.following.sample_times import FUTURE, NANOSECONDS, SampleTimes

TIMEOUT = 0.2
NOW = 100.0


def nanoseconds(age: float) -> int:
    return round(age * NANOSECONDS)


@given(st.integers(-nanoseconds(FUTURE), nanoseconds(TIMEOUT)), st.integers(0, 10**12))
def test_a_stamp_of_the_robots_clock_is_taken_to_the_nanosecond(age: int, now: int) -> None:
    assert SampleTimes(TIMEOUT).valid_at(now / NANOSECONDS, age) == (now - age) / NANOSECONDS


@pytest.mark.parametrize('offset', [-1e6, -1.0, 1.0, 1e6])
def test_stamps_of_another_clock_give_the_time_between_samples(offset: float) -> None:
    times = SampleTimes(TIMEOUT)
    assert times.valid_at(NOW, nanoseconds(offset)) == NOW
    # The next one comes 30 ms late; another one sooner than any before.
    assert times.valid_at(NOW + 0.13, nanoseconds(offset + 0.03)) == pytest.approx(NOW + 0.1)
    assert times.valid_at(NOW + 0.19, nanoseconds(offset - 0.01)) == pytest.approx(NOW + 0.19)
    assert times.valid_at(NOW + 0.3, nanoseconds(offset)) == pytest.approx(NOW + 0.29)


@pytest.mark.parametrize('jump', [-1.0, 1.0])
def test_another_clock_that_jumps_is_followed_anew(jump: float) -> None:
    times = SampleTimes(TIMEOUT)
    times.valid_at(NOW, nanoseconds(50.0))
    assert times.valid_at(NOW + 0.1, nanoseconds(50.0 + jump)) == NOW + 0.1
