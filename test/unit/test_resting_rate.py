"""What rests is reported seldom, what moves in every cycle."""

from __future__ import annotations

import pytest

from robots_core.periodic.resting_rate import RestingRate


def test_every_cycle_while_it_moves_and_some_later_few_at_rest():
    rate = RestingRate(every=5, after=3)
    assert all(rate.due(resting=False) for _ in range(20))
    due = [rate.due(resting=True) for _ in range(23)]
    assert due == [True] * 3 + [False, False, False, False, True] * 4
    assert rate.due(resting=False)
    assert [rate.due(resting=True) for _ in range(5)] == [True] * 3 + [False] * 2


def test_one_of_one_is_every_cycle():
    rate = RestingRate(every=1, after=0)
    assert all(rate.due(resting=True) for _ in range(20))


@pytest.mark.parametrize(('every', 'after'), [(10, 2), (1, 0), (5, 0), (3, 7)])
def test_cycles_without_reports_are_known_ahead_and_may_be_left_out(every: int, after: int):
    rate, other = RestingRate(every, after), RestingRate(every, after)
    for _ in range(20):
        ahead = rate.ahead
        assert [other.due(resting=True) for _ in range(ahead + 1)] == [False] * ahead + [True]
        rate.pass_over(ahead)
        assert rate.due(resting=True)


def test_a_report_is_early_after_half_of_the_time():
    rate = RestingRate(every=10, after=0)
    due = [rate.due(resting=True, early=cycle % 6 == 0) for cycle in range(1, 25)]
    assert [cycle for cycle, one in enumerate(due, 1) if one] == [6, 12, 18, 24]


def test_what_has_rested_is_reported_one_by_one_again_when_asked():
    rate = RestingRate(every=5, after=3)
    for _ in range(20):
        rate.due(resting=True)
    rate.restart()
    assert [rate.due(resting=True) for _ in range(5)] == [True] * 3 + [False] * 2
