"""MotionsUnderWay: what becomes of the motions of a client after one that has failed."""

from __future__ import annotations

import numpy as np
import pytest

from robots_controller.client.motion import Motion, MotionsUnderWay
from robots_controller.program.motions.motion_command import MotionCommand
from robots_core.errors import PlanningError
from robots_planning.motion_kinds import JOINT

ERROR = PlanningError('no way')


class Client:
    """Motions by their places, and how often the robot was stopped."""

    def __init__(self) -> None:
        self.stops = 0
        self.motions = MotionsUnderWay(self.stop, lambda: None, patience=0.0)
        self.commands: list[MotionCommand] = []
        self.commanded: list[Motion] = []

    def stop(self) -> None:
        self.stops += 1

    def command(self, count: int = 1) -> None:
        for _ in range(count):
            self.commands.append(MotionCommand(JOINT, 0, '', np.zeros(6), settings={}))
            self.commanded.append(self.motions.begin(self.commands[-1]))
            self.motions.sent(self.commanded[-1])

    def end(self, place: int, error: PlanningError | None = None) -> None:
        self.motions.end(self.commands[place], error)

    @property
    def done(self) -> list[bool]:
        return [motion.done for motion in self.commanded]


@pytest.fixture
def client() -> Client:
    return Client()


def test_a_failure_refuses_the_next_motion_once(client: Client) -> None:
    client.command()
    client.end(0, ERROR)
    with pytest.raises(PlanningError, match='not commanded, as a motion before it has failed: no way'):
        client.command()
    client.commands.pop()
    client.command()
    assert client.stops == 0


def test_a_failure_stops_what_was_commanded_for_after_it_and_is_heard_of_then(client: Client) -> None:
    client.command(4)
    client.end(1, ERROR)
    assert client.stops == 1
    assert client.done == 4 * [False]
    client.end(0)  # it had begun before, and reached its target
    assert client.done == [True, False, False, False]
    client.end(2, PlanningError('given up'))
    client.end(3)  # it was there before the robot could stop
    assert client.done == 4 * [True]
    assert client.stops == 1
    with pytest.raises(PlanningError, match='no way'):
        client.commanded[1].wait()
    assert client.commanded[3].wait()
    client.command()


def test_a_motion_that_is_sent_when_one_before_it_has_failed_is_stopped_too(client: Client) -> None:
    client.command(2)
    late = client.commanded[1]
    client.end(0, ERROR)
    client.motions.sent(late)
    assert client.stops == 2
    client.end(1, PlanningError('canceled'))
    assert late.done


def test_no_motion_is_commanded_before_the_robot_has_stopped(client: Client) -> None:
    client.command(2)
    client.end(0, ERROR)
    with pytest.raises(PlanningError, match='no way'):
        client.command()
    assert client.done == [False, False]


def test_an_old_error_that_is_raised_again_says_nothing_of_a_new_one(client: Client) -> None:
    client.command()
    client.end(0, ERROR)
    with pytest.raises(PlanningError):
        client.commanded[0].wait()
    client.command()
    client.end(1, ERROR)
    with pytest.raises(PlanningError):
        client.commanded[0].wait()
    with pytest.raises(PlanningError, match='not commanded'):
        client.command()


def test_failures_that_a_client_expects_refuse_nothing(client: Client) -> None:
    client.command()
    client.motions.expect_failures()
    client.command()
    client.end(0, ERROR)
    assert client.done == [True, False]
    assert client.stops == 0
    client.end(1)
    client.command()


def test_what_is_held_back_is_heard_of_although_the_client_expects_the_rest(client: Client) -> None:
    client.command(2)
    client.end(0, ERROR)
    client.motions.expect_failures()
    client.end(1, ERROR)
    assert client.done == [True, True]


def test_progress_is_that_of_the_oldest_motion(client: Client) -> None:
    client.command(2)
    client.motions.advance(0.5)
    client.end(0)
    client.motions.advance(0.25)
    assert [motion.progress for motion in client.commanded] == [1.0, 0.25]
