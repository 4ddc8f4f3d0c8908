"""ProgramMotions: order, settings, release, stop, lost planners, by ports made by hand."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import pytest

from robots_controller.cell.ports import Configured
from robots_controller.cell.program_motions import LOST_TIMEOUT, MOST_SENT, ProgramMotions
from robots_controller.program.motions.modal_settings import without_blend
from robots_controller.program.motions.motion_command import MotionCommand
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import PlanningError, RobotsError
from robots_planning.motion_kinds import JOINT

TIMEOUT = 5.0  # s


class Cell:
    """Planner, controller and clock of a cell, and what becomes of its motions."""

    name = 'planning_node'

    def __init__(self) -> None:
        self.time = 0.0
        self.listening = self.configurable = True
        self.settings: dict[str, object] = {}
        self.asked: list[tuple[dict[str, object], Configured]] = []
        self.answers = True  # to a configuration, at once
        self.sent: list[str] = []
        self.present: dict[bytes, str] = {(1,): 'controller_node'}
        self.requests: list[str] = []
        self.ended: list[tuple[str, MotionCommand, str]] = []
        self.motions = ProgramMotions(
            self,
            partial(self.requests.append, 'cancel'),
            self,  # type: ignore[arg-type]  # no program waits
            planner_timeout=TIMEOUT,
            on_sent=lambda id_, _: self.sent.append(id_),
            on_result=self.end,
        )

    def end(self, id_: str, command: MotionCommand, error: RobotsError | None) -> None:
        self.ended.append((id_, command, '' if error is None else str(error)))

    def results(self) -> list[tuple[str, str]]:
        return [(id_, error) for id_, _, error in self.ended]

    # -- ports --------------------------------------------------------------------------------------

    def now(self) -> float:
        return self.time

    def plans(self, _command: MotionCommand) -> bool:
        return self.listening

    def differs(self, settings: Mapping[str, object]) -> bool:
        return dict(settings) != self.settings

    def configure(self, settings: Mapping[str, object], done: Configured, *, moving: bool) -> None:
        assert moving == bool(self.sent)
        self.asked.append((dict(settings), done))
        if self.answers:
            self.settings = dict(settings)
            done(None)

    def flush(self, settings: Mapping[str, object]) -> None:
        self.configure(without_blend(settings), lambda _: None, moving=True)

    def next_id(self) -> str:
        return f'{len(self.sent) + 1}.0'

    def command(self, id_: str, _command: MotionCommand) -> None:
        assert id_ == self.sent[-1]

    def followers(self) -> Mapping[bytes, str]:
        return self.present

    # -- the program's side -------------------------------------------------------------------------

    def move(self, **settings: Any) -> MotionCommand:
        command = MotionCommand(JOINT, 1, 'ptpJointSpaceAngles', np.zeros(6), settings=settings)
        self.motions.send(command)
        return command

    def answer(self, id_: str, *, ok: bool = True) -> None:
        self.motions.result(MotionResult(id_, ok, 'reached' if ok else 'blocked'))

    def watch_for(self, seconds: float) -> None:
        self.motions.watch()
        self.time += seconds
        self.motions.watch()


@pytest.fixture
def cell() -> Cell:
    return Cell()


def test_motions_are_sent_at_once_and_in_their_order(cell: Cell) -> None:
    commands = [cell.move() for _ in range(3)]
    assert cell.sent == ['1.0', '2.0', '3.0']
    cell.answer('1.0')
    cell.answer('2.0', ok=False)
    cell.answer('9.0')  # of another
    assert [(id_, command) for id_, command, _ in cell.ended] == [('1.0', commands[0]), ('2.0', commands[1])]
    assert cell.results()[0] == ('1.0', '')
    assert 'blocked' in cell.results()[1][1]


def test_a_result_ends_those_before_it_too_if_the_robot_is_there(cell: Cell) -> None:
    for _ in range(3):
        cell.move()
    cell.answer('2.0')
    assert cell.results() == [('1.0', ''), ('2.0', '')]
    cell.answer('2.0')
    assert len(cell.ended) == 2


def test_no_more_are_on_their_way_than_the_controller_queues(cell: Cell) -> None:
    for _ in range(MOST_SENT + 2):
        cell.move()
    assert len(cell.sent) == MOST_SENT
    cell.answer('1.0')
    assert len(cell.sent) == MOST_SENT + 1
    cell.answer(f'{MOST_SENT}.0')
    assert len(cell.sent) == MOST_SENT + 2


def test_the_planner_has_the_settings_of_a_motion_before_it(cell: Cell) -> None:
    cell.answers = False
    cell.move(speed_fraction=0.5)
    cell.move(speed_fraction=0.5)
    ((settings, done),) = cell.asked
    assert settings == {'speed_fraction': 0.5}
    assert cell.sent == []
    cell.settings = settings
    done(None)
    assert cell.sent == ['1.0', '2.0']
    assert len(cell.asked) == 1


def test_settings_that_are_refused_end_the_motion_and_those_behind_it(cell: Cell) -> None:
    cell.answers = False
    command, following = cell.move(speed_fraction=7.0), cell.move()
    cell.asked[0][1](PlanningError('not today'))
    canceled = 'canceled before it began: not today'
    assert cell.ended == [('', command, 'not today'), ('', following, canceled)]
    assert cell.sent == []


def test_after_the_last_motion_the_planner_waits_for_none_to_blend_into(cell: Cell) -> None:
    cell.move(blend_zone=0.05, speed_fraction=0.5)
    cell.motions.flush()
    zones = {'blend_zone': 0.0, 'joint_blend_zone': 0.0}
    assert cell.asked[-1][0] == {'speed_fraction': 0.5, **zones}
    cell.motions.flush()
    cell.answer('1.0')
    count = len(cell.asked)
    cell.motions.flush()
    assert len(cell.asked) == count  # no motion is on its way


def test_a_motion_waits_for_a_planner_until_its_timeout(cell: Cell) -> None:
    cell.listening = False
    cell.move()
    cell.watch_for(0.9 * TIMEOUT)
    assert not cell.ended
    cell.listening = True
    cell.motions.watch()
    assert cell.sent == ['1.0']

    late = Cell()
    late.listening = False
    late.move()
    late.watch_for(TIMEOUT)
    ((id_, error),) = late.results()
    assert id_ == ''
    assert 'no node plans ptpjoint_joint within 5 s' in error
    assert late.sent == []


def test_a_planner_that_does_not_answer_is_named(cell: Cell) -> None:
    cell.answers = False
    cell.move(speed_fraction=0.5)
    cell.watch_for(TIMEOUT)
    assert 'planning_node has not answered for 5 s' in cell.results()[0][1]
    cell.asked[0][1](None)  # too late
    assert cell.sent == []


def test_a_motion_that_nothing_will_end_is_given_up_and_the_robot_stopped(cell: Cell) -> None:
    cell.move()
    cell.watch_for(10.0 * LOST_TIMEOUT)
    assert not cell.ended
    cell.present = {}
    cell.watch_for(0.9 * LOST_TIMEOUT)
    assert not cell.ended
    cell.watch_for(0.2 * LOST_TIMEOUT)
    ((id_, error),) = cell.results()
    assert id_ == '1.0'
    assert 'controller_node has been gone for 2 s' in error
    assert cell.requests == ['cancel']


def test_a_controller_that_was_killed_before_the_motion_began_is_not_missed_by_it(cell: Cell) -> None:
    cell.present = {b'killed': 'controller_node', b'new': 'controller_node'}
    cell.move()
    cell.present = {b'new': 'controller_node'}
    cell.watch_for(10.0 * LOST_TIMEOUT)
    assert not cell.ended
    cell.present = {b'new again': 'controller_node'}  # it has none of the motions
    cell.watch_for(1.1 * LOST_TIMEOUT)
    assert 'controller_node has been gone for 2 s' in cell.results()[0][1]


def test_a_lost_planner_ends_what_was_sent_and_stops_the_robot(cell: Cell) -> None:
    cell.move()
    cell.move()
    cell.motions.lose_planner('it is gone')
    assert cell.results() == [('1.0', 'it is gone'), ('2.0', 'it is gone')]
    assert cell.requests == ['cancel']


def test_a_motion_for_a_planner_that_is_lost_fails_at_once_until_it_is_back(cell: Cell) -> None:
    cell.motions.lose_planner('it is gone')
    cell.move()
    assert cell.results() == [('', 'it is gone')]
    assert not cell.sent
    cell.motions.lose_planner('')
    cell.move()
    assert cell.sent == ['1.0']


def test_a_cancellation_ends_what_was_not_sent_and_is_repeated_until_the_rest_has_ended(cell: Cell) -> None:
    cell.move()
    cell.listening = False
    cell.move()
    cell.motions.cancel()
    assert cell.results() == [('', 'canceled before it began')]
    cell.motions.watch()
    assert cell.requests == ['cancel', 'cancel']
    cell.answer('1.0', ok=False)
    cell.motions.watch()
    assert cell.requests == ['cancel', 'cancel']
