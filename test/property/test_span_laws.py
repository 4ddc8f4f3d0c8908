"""Laws of spans: the controller's next periods, known at once, are those that it steps through."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from robots_controller.control.controller import Controller, ControllerSettings
from robots_controller.control.followed_motion import FollowedMotion
from robots_controller.control.interpolator import Interpolator

from .test_controller_laws import AXES, START, ruckig_move

JOINTS = st.tuples(*(st.floats(-1.4, 1.4) for _ in range(3)))


def controller_at_start(period: float, smoothing: float, override: float) -> Controller:
    controller = Controller(AXES, ControllerSettings(period=period, smoothing_time=smoothing))
    controller.speed.set_override(override)
    controller.step(0.0, START)
    return controller


@settings(deadline=None, max_examples=30)
@given(
    target=JOINTS,
    period=st.sampled_from([0.001, 0.004, 0.01]),
    smoothing=st.sampled_from([0.0, 0.005, 0.02]),
    override=st.sampled_from([1.0, 0.37]),
    lengths=st.lists(st.integers(1, 400), min_size=1, max_size=8),
)
def test_a_span_has_the_references_of_its_periods(
    target: tuple[float, ...], period: float, smoothing: float, override: float, lengths: list[int]
) -> None:
    trajectory = ruckig_move(START, np.array(target) + 0.05)
    ahead, stepped = (controller_at_start(period, smoothing, override) for _ in range(2))
    for controller in (ahead, stepped):
        controller.follow(FollowedMotion(trajectory, 'motion'), 0.0)
    now, passed, before = 0.0, 0, stepped.reference
    for length in lengths:
        span = ahead.ahead(now, length)
        for number, expected in enumerate(span.references):
            now += period
            assert before is not None
            assert ahead.check(now, before[0], before)
            before = stepped.step(now, before[0])
            assert before is not None
            assert before.tobytes() == expected.tobytes()
            assert span.progress[number] == stepped.progress
            passed += 1
        if len(span):
            ahead.pass_over(span)
        now += period  # a period that is stepped through
        assert before is not None
        reference, before = (controller.step(now, before[0]) for controller in (ahead, stepped))
        assert reference is not None
        assert before is not None
        assert reference.tobytes() == before.tobytes()
        assert ahead.progress == stepped.progress
        assert [one.message for one in ahead.outcomes] == [one.message for one in stepped.outcomes]
    assert passed > 0 or trajectory.duration < 2.0 * period


@given(window=st.integers(1, 9), before=st.integers(0, 20), count=st.integers(1, 25), seed=st.integers(0, 99))
def test_means_ahead_are_those_of_one_sample_after_the_other(
    window: int, before: int, count: int, seed: int
) -> None:
    samples = np.random.default_rng(seed).normal(size=(before + count + window, 3, 6))
    first, second = Interpolator(6, window), Interpolator(6, window)
    for average in (first, second):
        average.reset(samples[0, 0])
        for sample in samples[:before]:
            average.push(sample)
    means = first.ahead(samples[before : before + count])
    first.pass_over(samples[before : before + count])
    expected = np.array([second.push(sample) for sample in samples[before : before + count]])
    assert means.tobytes() == expected.tobytes()
    for sample in samples[before + count :]:
        assert first.push(sample).tobytes() == second.push(sample).tobytes()
