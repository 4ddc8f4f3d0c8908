"""Watchdog: what is silent is lost, by the time in which somebody looked."""

from __future__ import annotations

import math
from itertools import cycle

import pytest

from robots_core.errors import InvalidInputError
from robots_core.periodic.watchdog import CHECKS, Watchdog, checked_watchdog

TIMEOUT = 0.2
STEP = TIMEOUT / CHECKS


def checks(watchdog: Watchdog, count: int, *, alive: bool, since: float = 0.0) -> list[bool]:
    return [watchdog.check(since + (k + 1) * STEP, alive=alive) for k in range(count)]


def test_what_falls_silent_is_lost_once_after_the_timeout() -> None:
    watchdog = Watchdog(TIMEOUT)
    assert not any(checks(watchdog, 100, alive=True))
    found = checks(watchdog, 20, alive=False, since=100 * STEP)
    # The last sign of life came up to one check earlier.
    assert found.index(True) == CHECKS - 1
    assert sum(found) == 1
    assert watchdog.lost


@pytest.mark.parametrize('age', [0.0, 0.3 * STEP, STEP])
def test_silence_counts_from_the_sign_of_life_where_its_age_is_known(age: float) -> None:
    watchdog = Watchdog(TIMEOUT)
    assert watchdog.remaining == math.inf
    watchdog.check(STEP, alive=True, age=age)
    assert watchdog.remaining == pytest.approx(TIMEOUT - age, abs=1e-12)  # rounding
    checks(watchdog, CHECKS - 2, alive=False, since=STEP)
    now, rest = (CHECKS - 1) * STEP, watchdog.remaining
    # The remaining time is one to two checks: one in between, because no step counts for more than a check.
    assert not watchdog.check(now + 0.49 * rest, alive=False)
    assert not watchdog.check(now + 0.99 * rest, alive=False)
    assert watchdog.check(now + 1.01 * rest, alive=False)
    assert watchdog.remaining == math.inf


@pytest.mark.parametrize(('age', 'counted'), [(-5.0, 0.0), (5.0, STEP)])
def test_an_age_that_a_changed_clock_gives_counts_at_most_one_look(age: float, counted: float) -> None:
    watchdog = Watchdog(TIMEOUT)
    watchdog.check(STEP, alive=True, age=age)
    assert watchdog.remaining == pytest.approx(TIMEOUT - counted, abs=1e-12)  # rounding


def test_what_was_never_seen_is_not_lost() -> None:
    watchdog = Watchdog(TIMEOUT)
    assert not any(checks(watchdog, 100, alive=False))
    assert not watchdog.lost


def test_what_is_expected_is_lost_without_a_sign_of_life_and_may_come_late() -> None:
    watchdog = Watchdog(TIMEOUT)
    watchdog.expect()
    assert watchdog.seen
    assert checks(watchdog, 20, alive=False).index(True) in (CHECKS - 1, CHECKS)  # one more for rounding
    watchdog.check(20 * STEP, alive=True)
    watchdog.expect()
    assert not watchdog.lost


def test_what_comes_back_is_lost_again_when_it_falls_silent_again() -> None:
    watchdog = Watchdog(TIMEOUT)
    for _ in range(2):
        watchdog.check(0.0, alive=True)
        assert not watchdog.lost
        assert sum(checks(watchdog, 20, alive=False)) == 1


def test_the_time_in_which_nobody_looked_does_not_count() -> None:
    watchdog = Watchdog(TIMEOUT)
    watchdog.check(0.0, alive=True)
    assert not watchdog.check(60.0, alive=False)
    assert not any(checks(watchdog, CHECKS - 2, alive=False, since=60.0))
    assert any(checks(watchdog, 3, alive=False, since=60.0 + (CHECKS - 2) * STEP))


def test_silence_counts_by_the_share_of_a_processor() -> None:
    watchdog = Watchdog(TIMEOUT, lambda: 0.25)
    watchdog.check(STEP, alive=True)
    found = checks(watchdog, 40, alive=False, since=STEP)
    # Half a check and two whole ones count in full, the others a quarter each; one more for rounding.
    assert found.index(True) + 1 in (2 + 4 * (CHECKS - 2.5), 3 + 4 * (CHECKS - 2.5))


def test_threads_that_run_for_a_moment_are_no_load() -> None:
    shares = cycle([1.0, 0.1])
    watchdog = Watchdog(TIMEOUT, lambda: next(shares))
    watchdog.check(STEP, alive=True)
    assert checks(watchdog, 20, alive=False, since=STEP).index(True) == CHECKS - 1


@pytest.mark.parametrize('value', [-0.2, 0.05, 61.0, float('nan'), float('inf')])
def test_timeouts_that_no_machine_keeps_are_refused(value: float) -> None:
    with pytest.raises(InvalidInputError, match=r'watchdog = .* must be in \[0\.1, 60\] s, or 0 for none'):
        checked_watchdog(value)
    assert checked_watchdog(0.0) == 0.0
