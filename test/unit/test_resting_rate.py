"""What rests is reported seldom, what moves in every cycle."""

from __future__ import annotations

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


def test_what_has_rested_is_reported_one_by_one_again_when_asked():
    rate = RestingRate(every=5, after=3)
    for _ in range(20):
        rate.due(resting=True)
    rate.restart()
    assert [rate.due(resting=True) for _ in range(5)] == [True] * 3 + [False] * 2
