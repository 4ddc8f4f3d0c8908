"""DriverGoals: the newest command is a goal, and what the driver does not follow is a failure."""

from __future__ import annotations

import pytest

from robots_core.blocks.drives.driver_goals import ANSWER_PATIENCE, ERRORS, TOLERANCES, DriverGoals

NAME = '/follow'
LATE = 1.1 * ANSWER_PATIENCE


class Driver:
    """A driver that the test lets answer."""

    def __init__(self) -> None:
        self.sent: list[tuple[int, str]] = []
        self.canceled: list[int] = []
        self.failures: list[str] = []
        self.goals = DriverGoals(NAME, self.failures.append)

    def check(self, wanted: str | None, now: float = 0.0, *, served: bool = True) -> None:
        due = self.goals.due(wanted, now, served=served)
        if due == 'send':
            assert wanted is not None
            self.sent.append((self.goals.number, wanted))
        elif due == 'cancel':
            self.canceled.append(self.goals.number)

    def end(self, number: int, code: int = 0, text: str = '') -> None:
        self.goals.ended(number, succeeded=code == 0, code=code, text=text)

    def executes(self, command: str) -> int:
        """Accept this command; returns the number of its goal."""
        self.check(command)
        number = self.sent[-1][0]
        self.goals.answered(number, accepted=True)
        return number


@pytest.fixture
def driver() -> Driver:
    return Driver()


def test_a_command_is_sent_once_and_again_when_it_is_another_one(driver: Driver) -> None:
    for wanted in ('a', 'a', 'b', 'b', 'a'):
        driver.check(wanted)
    assert driver.sent == [(1, 'a'), (2, 'b'), (3, 'a')]
    assert not driver.failures


def test_without_a_command_the_goal_that_runs_is_canceled_once_and_its_end_is_no_failure(
    driver: Driver,
) -> None:
    number = driver.executes('a')
    for _ in range(2):
        driver.check(None)
    assert driver.canceled == [number]
    driver.goals.ended(number, succeeded=False, code=0, text='canceled')
    assert not driver.failures
    driver.check('a')
    assert len(driver.sent) == 2


def test_a_goal_without_an_answer_is_canceled_when_it_is_accepted(driver: Driver) -> None:
    driver.check('a')
    driver.check(None)
    assert not driver.canceled
    driver.goals.answered(1, accepted=True)
    driver.check(None)
    assert driver.canceled == [1]


def test_a_goal_that_is_refused_is_a_failure_and_sent_anew(driver: Driver) -> None:
    driver.check('a')
    driver.goals.answered(1, accepted=False)
    assert driver.failures == [f'{NAME} has refused a goal']
    driver.check('a')
    assert driver.sent == [(1, 'a'), (2, 'a')]


@pytest.mark.parametrize('code', [*ERRORS, 7])
def test_any_end_of_the_newest_goal_but_success_is_a_failure(driver: Driver, code: int) -> None:
    driver.end(driver.executes('a'))
    assert not driver.failures
    driver.end(driver.executes('b'), code, 'why')
    assert driver.failures == [f'{NAME} has ended a goal: {ERRORS.get(code, f"code {code}")}: why']


@pytest.mark.parametrize('code', [*ERRORS, 7])
def test_of_a_goal_that_was_replaced_only_a_tolerance_counts(driver: Driver, code: int) -> None:
    before, newest = driver.executes('a'), driver.executes('b')
    driver.end(before, code, 'preempted')
    assert bool(driver.failures) == (code in TOLERANCES)
    driver.end(newest)
    assert len(driver.failures) <= 1


def test_after_a_failure_nothing_is_canceled_and_the_end_of_the_newest_goal_is_none(driver: Driver) -> None:
    before, newest = driver.executes('a'), driver.executes('b')
    driver.end(before, -4)
    driver.check(None)
    driver.end(newest, -1)
    assert not driver.canceled
    assert len(driver.failures) == 1


def test_a_driver_that_does_not_answer_is_a_failure_as_long_as_it_does_not(driver: Driver) -> None:
    driver.check('a')
    driver.check('b', ANSWER_PATIENCE)  # the first one counts
    assert not driver.failures
    for _ in range(2):
        driver.check('b', LATE)
    assert driver.failures == [f'{NAME} has not answered for 2 s'] * 2
    driver.goals.answered(2, accepted=True)
    driver.check('b', 2.0 * LATE)
    assert len(driver.failures) == 2


def test_a_driver_that_has_served_and_is_gone_is_a_failure(driver: Driver) -> None:
    driver.check('a', served=False)
    assert not driver.failures
    assert not driver.goals.served
    driver.check('a')
    driver.check('b', served=False)
    assert driver.failures == [f'{NAME} is not served any more']
    assert driver.goals.served
    assert driver.sent == [(1, 'a')]
