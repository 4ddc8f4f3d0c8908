"""When nodes that have died are started again."""

from __future__ import annotations

import pytest

from robots_controller.live_cell.processes.node_restarts import (
    FIRST_DELAY,
    LONGEST_DELAY,
    MOST_DEATHS,
    STEADY,
    RestartPolicy,
)


def test_each_death_in_a_row_doubles_the_delay_until_there_are_too_many():
    policy, now, delays = RestartPolicy(), 100.0, []
    while (delay := policy.died('drive_node', now)) is not None:
        delays.append(delay)
        assert policy.due(now + 0.99 * delay) == []
        now += delay
        assert policy.due(now) == ['drive_node']
        assert policy.due(now) == []
        now += 1.0
    assert delays == [min(FIRST_DELAY * 2**n, LONGEST_DELAY) for n in range(MOST_DEATHS - 1)]


def test_a_node_that_was_steady_begins_anew_and_nodes_are_judged_each_for_itself():
    policy = RestartPolicy()
    assert policy.died('a', 0.0) == FIRST_DELAY
    policy.due(FIRST_DELAY)
    assert policy.died('a', 1.0) == 2 * FIRST_DELAY
    assert policy.died('b', 1.0) == FIRST_DELAY
    assert sorted(policy.due(10.0)) == ['a', 'b']
    assert policy.died('a', 10.0 + STEADY) == FIRST_DELAY
    assert policy.died('b', 10.0 + 0.9 * STEADY) == pytest.approx(2 * FIRST_DELAY)
