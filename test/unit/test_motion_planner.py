"""MotionPlanner: commands in; motions, results and `finished` out, by a port made by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from robots_core import Pose
from robots_core.errors import PlanningError
from robots_planning import LinearJoint
from robots_planning.commands.command_planner import REPLACE_LEAD
from robots_planning.motion_kinds import JOINT, JOINT_TO_POSE

from .planner_cell import PLAIN, ROBOT, START, Cell, above


@pytest.fixture
def cell() -> Cell:
    return Cell()


def test_a_motion_leads_from_where_the_robot_stands_to_its_target(cell: Cell) -> None:
    cell.move('1', 0.2)
    assert cell.ids == ['1']
    assert cell.sent[0][2:] == ('PTPJOINT_JOINT', 0.0)
    np.testing.assert_array_equal(cell.trajectory(0).position[[0, -1]], [START, START + 0.2])
    assert cell.planner.moving
    assert cell.told == [False]


def test_the_motions_of_a_lost_controller_are_ended_in_its_place(cell: Cell) -> None:
    cell.move('1', 0.2)
    cell.move('2', 0.0)
    cell.planner.lose_controller('it is gone')
    assert [(result.id, result.ok, result.message) for result in cell.answers] == [
        ('1', False, 'it is gone'),
        ('2', False, 'it is gone'),
    ]
    for result in tuple(cell.answers):  # they come back, as those of the controller
        cell.planner.result(result, cell.now)
    assert not cell.planner.moving
    cell.now += 1.0
    cell.move('3', 0.2)
    assert cell.ids[-1] == '3'


def test_each_motion_begins_at_the_end_of_the_one_before(cell: Cell) -> None:
    cell.move('1', 0.2)
    cell.planner.command('2', JOINT_TO_POSE, above(0.1), PLAIN)
    cell.move('3', 0.0)
    for number in (1, 2):
        before, after = cell.trajectory(number - 1), cell.trajectory(number)
        np.testing.assert_array_equal(after.position[0], before.position[-1])


def test_finished_follows_the_last_result(cell: Cell) -> None:
    cell.move('1', 0.2)
    cell.move('2', 0.0)
    assert cell.end('1')
    assert cell.told == [False, False]
    assert not cell.end('of another')
    assert cell.end('2')
    assert cell.told == [False, False, True]
    assert not cell.planner.moving


def test_a_command_that_comes_twice_is_taken_once(cell: Cell) -> None:
    assert cell.planner.command('1', JOINT, START + 0.1, PLAIN)
    assert not cell.planner.command('1', JOINT, START + 0.1, PLAIN)
    assert cell.ids == ['1']


@pytest.mark.parametrize('q_dot', [0.0, 0.3])
def test_without_a_robot_that_stands_nothing_is_planned(cell: Cell, q_dot: float) -> None:
    if q_dot:
        cell.q_dot[2] = q_dot
    else:
        cell.q = None
    cell.move('1', 0.2)
    assert not cell.sent
    (result,) = cell.answers
    assert (result.id, result.ok) == ('1', False)
    assert ('still moving' if q_dot else 'no joint_reference received') in result.message
    assert cell.refusals == [f'ptpjoint_joint: {result.message}']
    assert not cell.planner.holds('1')


def test_after_a_failure_what_was_commanded_before_its_end_is_void(cell: Cell) -> None:
    cell.move('1', 0.2)
    cell.now -= 0.5
    cell.end('1', ok=False)
    cell.now -= 0.1  # sent before, came after
    cell.move('2', 0.0)
    assert 'given up with motion 1 before it' in cell.answers[-1].message
    cell.now += 1.0
    cell.q = START + 0.1
    cell.move('3', 0.0)
    assert cell.ids == ['1', '3']
    np.testing.assert_array_equal(cell.trajectory(1).position[0], START + 0.1)
    assert True not in cell.told


def test_a_replacing_motion_joins_the_running_one_where_that_will_be(cell: Cell) -> None:
    cell.planner.replace_motions(replace=True)
    cell.move('1', 0.4, replace(PLAIN, acceleration_fraction=0.1))
    running = cell.trajectory(0)
    cell.now += 0.1
    cell.planner.progress(0.25)
    cell.now += 0.05
    cell.move('2', -0.1)
    join_time = cell.sent[1][3]
    assert join_time == pytest.approx(0.25 * running.duration + 0.05 + REPLACE_LEAD, abs=1e-9)
    joined = cell.trajectory(1)
    for mine, state in zip(joined.sample(joined.time[0]), running.sample(join_time), strict=True):
        np.testing.assert_allclose(mine, state, atol=1e-9)
    np.testing.assert_allclose(joined.position[-1], START - 0.1, atol=1e-9)
    cell.end('1')
    assert cell.planner.moving  # it was the one in its place that runs


def test_a_motion_that_is_nearly_over_is_followed_not_replaced(cell: Cell) -> None:
    cell.planner.replace_motions(replace=True)
    cell.move('1', 0.4)
    cell.planner.progress(0.999)
    cell.move('2', -0.1)
    assert cell.sent[1][3] == 0.0
    np.testing.assert_array_equal(cell.trajectory(1).position[0], START + 0.4)


def test_a_trigger_moves_on_its_rising_edge_to_the_reference_pose(cell: Cell) -> None:
    cell.planner.trigger('1', level=True)
    assert 'without a valid reference_pose' in cell.answers[-1].message
    cell.planner.reference_pose = above(0.1)
    for id_, level in (('2', True), ('3', False), ('4', True), ('5', True)):
        cell.planner.trigger(id_, level=level)
    assert cell.ids == ['4']
    reached = Pose(*ROBOT.direct_kinematics(cell.trajectory(0).position[-1]))
    assert max(reached.distance_to(above(0.1))) < 1e-8


def test_a_given_trajectory_is_sent_if_the_robot_stands(cell: Cell) -> None:
    cell.planner.send_given('1', lambda q: LinearJoint(ROBOT).generate(q, q + 0.1))
    assert cell.ids == ['1']
    with pytest.raises(PlanningError, match='still moving'):
        cell.planner.send_given('2', lambda q: LinearJoint(ROBOT).generate(q, q + 0.1))
    cell.end('1')
    assert cell.told[-1]


def test_a_given_trajectory_is_not_sent_when_the_planner_was_held_up(cell: Cell) -> None:
    cell.held_up = True
    with pytest.raises(PlanningError, match='given up while it was being planned'):
        cell.planner.send_given('1', lambda q: LinearJoint(ROBOT).generate(q, q + 0.1))
    assert not cell.sent
    assert not cell.planner.moving
    cell.held_up = False
    cell.planner.send_given('2', lambda q: LinearJoint(ROBOT).generate(q, q + 0.1))
    assert cell.ids == ['2']


def test_motions_of_a_controller_that_is_gone_are_forgotten(cell: Cell) -> None:
    cell.move('1', 0.2)
    cell.present |= {b'another'}
    cell.move('1', 0.2)  # which is known
    assert cell.ids == ['1']
    cell.present -= {b'first'}
    cell.move('2', 0.1)
    assert not cell.planner.holds('1')
    np.testing.assert_array_equal(cell.trajectory(1).position[0], START)


def test_a_controller_that_was_killed_before_the_motion_began_is_not_missed(cell: Cell) -> None:
    cell.present |= {b'killed'}
    cell.move('1', 0.2)
    cell.present -= {b'killed'}
    cell.move('2', 0.1)
    assert cell.planner.holds('1')
    np.testing.assert_array_equal(cell.trajectory(1).position[0], START + 0.2)
