"""PendantMove: takes the robot for a motion, asks again while it still moves, and gives it back."""

from __future__ import annotations

from collections.abc import Callable
from threading import Thread

import numpy as np
import pytest

from robots_controller.pendant.jog.pendant_move import STANDING_TIME, PendantMove
from robots_controller.program.motions.motion_command import MotionCommand
from robots_core.errors import RobotsError
from robots_planning.motion_kinds import JOINT

MOVES = 'the robot moves'
LONG_ENOUGH = 0.1  # s, in which a release that does not wait would have ended
COMMAND = MotionCommand(kind=JOINT, line=0, function='', q=np.zeros(6))


class Desk:
    """A port that notes what is asked for, and a clock."""

    def __init__(self) -> None:
        self.time = 0.0
        self.calls: list[str] = []
        self.answers: list[Callable[[str], None]] = []
        self.ends: list[RobotsError | None] = []
        self.move = PendantMove(self, lambda: self.time)

    def take(self, answered: Callable[[str], None]) -> None:
        self.calls.append('take')
        self.answers.append(answered)

    def give_back(self) -> None:
        self.calls.append('give back')

    def send(self, command: MotionCommand) -> None:
        assert command is COMMAND
        self.calls.append('send')

    def cancel(self) -> None:
        self.calls.append('cancel')

    def begin(self) -> None:
        self.move.begin(COMMAND, self.ends.append)


@pytest.fixture
def desk() -> Desk:
    desk = Desk()
    desk.begin()
    return desk


def test_the_motion_is_sent_when_the_robot_is_taken_and_ends_with_its_result(desk: Desk) -> None:
    assert desk.calls == ['take']
    desk.answers[0]('')
    desk.move.ended(COMMAND, None)
    assert desk.ends == [None]
    desk.move.end()
    assert desk.calls == ['take', 'send', 'give back']


def test_a_release_while_the_motion_is_being_sent_cancels_it(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    release = Thread(target=desk.move.end)

    def send(_command: MotionCommand) -> None:
        release.start()
        release.join(LONG_ENOUGH)
        desk.calls.append('send')

    monkeypatch.setattr(desk, 'send', send)
    desk.answers[0]('')
    release.join()
    assert desk.calls == ['take', 'send', 'cancel', 'give back']


def test_a_motion_that_is_given_up_is_canceled_before_the_robot_is_given_back(desk: Desk) -> None:
    desk.answers[0]('')
    desk.move.end()
    desk.move.ended(COMMAND, RobotsError('stopped'))
    assert desk.calls == ['take', 'send', 'cancel', 'give back']
    assert not desk.ends


def test_a_motion_that_was_released_before_the_answer_is_not_sent(desk: Desk) -> None:
    desk.move.end()
    desk.answers[0]('')
    assert 'send' not in desk.calls


def test_a_robot_that_still_moves_is_asked_for_again_until_it_must_stand(desk: Desk) -> None:
    desk.move.check()  # there is no answer yet
    desk.answers[0](MOVES)
    desk.move.check()
    desk.move.check()
    assert desk.calls == ['take', 'take']
    desk.time = STANDING_TIME
    desk.answers[1](MOVES)
    desk.move.check()
    assert desk.calls == ['take', 'take']
    assert [str(error) for error in desk.ends] == [MOVES]
