"""MotionPlanner: commands in; motions, results and `finished` out, by a port made by hand."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest

from robots_core import Pose, load_robot_model
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import InvalidInputError, PlanningError, RobotsError
from robots_core.validation import Array
from robots_planning import LinearJoint, MotionSettings, PathPlanning
from robots_planning.commands.command_planner import REPLACE_LEAD
from robots_planning.commands.command_queue import WINDOW
from robots_planning.commands.motion_planner import BLEND_PATIENCE, MotionPlanner
from robots_planning.commands.motion_results import BLOCKED
from robots_planning.motion_kinds import JOINT, JOINT_TO_POSE, LINE
from robots_planning.pathplanning import PlannedMotion
from robots_planning.trajectory import Trajectory

ROBOT = load_robot_model('ur10e')
START = np.array([0.2, -1.2, 1.6, -1.9, -1.4, 0.3])
PLAIN = MotionSettings()
CORNER = START + np.array([0.1, 0.3, 0.1, 0.1, 0.1, 0.1])
REPLANS = MotionSettings(avoid=True, on_blocked='replan', most_replans=2)
BLENDED = MotionSettings(blend_zone=0.02)


class Cell:
    """The transport, the controller and the clock around a planner."""

    def __init__(self, planning: PathPlanning) -> None:
        self.now = 10.0
        self.q: Array | None = START
        self.q_dot = np.zeros(6)
        self.sent: list[tuple[str, PlannedMotion, str, float]] = []
        self.ends: list[Mapping[str, float]] = []
        self.answers: list[MotionResult] = []
        self.refusals: list[str] = []
        self.told: list[bool] = []
        self.patience: list[float] = []
        self.present = frozenset([b'first'])
        self.held_up = False
        self.planner = MotionPlanner(planning, self)

    # -- port ---------------------------------------------------------------------------------------

    def time(self) -> float:
        return self.now

    def reference(self) -> tuple[Array, Array] | None:
        return None if self.q is None else (self.q, self.q_dot)

    def controllers(self) -> frozenset[bytes]:
        return self.present

    def missed(self) -> bool:
        return self.held_up

    def submit(self, work: Callable[[], None]) -> None:
        work()

    def release_after(self, patience: float) -> None:
        self.patience.append(patience)

    def send(
        self, id_: str, motion: PlannedMotion, ends: Mapping[str, float], *, title: str, join_time: float
    ) -> None:
        assert id_ in ends
        assert tuple(ends.values())[-1] == motion.duration
        self.ends.append(ends)
        self.sent.append((id_, motion, title, join_time))

    def answer(self, result: MotionResult) -> None:
        self.answers.append(result)

    def refused(self, topic: str, error: RobotsError) -> None:
        self.refusals.append(f'{topic}: {error}')

    def finished(self, *, done: bool) -> None:
        self.told.append(done)

    # -- those around it ----------------------------------------------------------------------------

    def move(self, id_: str, offset: float, settings: MotionSettings = PLAIN) -> None:
        self.planner.command(id_, JOINT, START + offset, settings)

    def line(self, id_: str, dz: float, settings: MotionSettings = PLAIN) -> None:
        self.planner.command(id_, LINE, above(dz), settings)

    def bead(self, *numbers: int, last: bool = False, settings: MotionSettings = PLAIN) -> None:
        """Short blended joint motions there and back, aside a little each."""
        for number in numbers:
            offset = np.zeros(6)
            offset[[0, 1]] = 0.02 * (number + 1), 0.1 * (number % 2)
            zone = 0.0 if last and number == numbers[-1] else 0.02
            blended = replace(settings, joint_blend_zone=zone)
            self.planner.command(str(number), JOINT, START + offset, blended)

    def end(self, id_: str, *, ok: bool = True, **details: str) -> bool:
        self.now += 1.0
        return self.planner.result(MotionResult(id_, ok, 'reached' if ok else 'stopped', details), self.now)

    @property
    def ids(self) -> list[str]:
        return [id_ for id_, *_ in self.sent]

    def trajectory(self, number: int) -> Trajectory:
        return self.sent[number][1].trajectory


def above(dz: float) -> Pose:
    start = Pose(*ROBOT.direct_kinematics(START))
    return Pose(start.r + np.array([0.0, 0.0, dz]), start.T)


@pytest.fixture(scope='module')
def planning() -> PathPlanning:
    return PathPlanning(ROBOT)


@pytest.fixture
def cell(planning: PathPlanning) -> Cell:
    return Cell(planning)


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


def test_blended_motions_become_one_when_none_follows(cell: Cell) -> None:
    cell.line('1', 0.1, BLENDED)
    cell.planner.command('2', LINE, above(0.1) @ Pose(np.array([0.0, 0.1, 0.0]), np.eye(3)), BLENDED)
    assert not cell.sent
    assert cell.patience == [BLEND_PATIENCE, BLEND_PATIENCE]
    cell.planner.release()
    ((id_, _, title, _),) = cell.sent
    assert id_ == '2'
    assert title == 'PTPCARTESIAN + PTPCARTESIAN'
    cell.end('2')
    assert [(result.id, result.ok) for result in cell.answers] == [('1', True)]


def test_a_motion_that_does_not_blend_or_settings_that_do_not_end_a_chain(cell: Cell) -> None:
    cell.line('1', 0.05, BLENDED)
    cell.line('2', 0.1)
    assert cell.ids == ['2']
    cell.end('2')
    cell.line('3', 0.0, BLENDED)
    cell.planner.configure(BLENDED)
    assert cell.ids == ['2']
    cell.planner.configure(PLAIN)
    assert cell.ids == ['2', '3']


@pytest.mark.parametrize(('progress', 'passed'), [(0.01, False), (0.99, True)])
def test_of_a_chain_that_fails_what_was_passed_has_reached_its_target(
    cell: Cell,
    progress: float,
    passed: bool,  # noqa: FBT001
) -> None:
    cell.line('1', 0.1, BLENDED)
    cell.planner.command('2', LINE, above(0.1) @ Pose(np.array([0.0, 0.1, 0.0]), np.eye(3)), PLAIN)
    cell.end('2', ok=False, progress=str(progress))
    assert [(result.id, result.ok) for result in cell.answers] == [('1', passed)]


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


def test_a_chain_ends_where_the_payload_changes(planning: PathPlanning) -> None:
    cell = Cell(planning)
    for number, payload in enumerate(((0.0, 0.0, 0.0, 0.0), (5.0, 0.0, 0.0, 0.1))):
        settings = replace(BLENDED, payload=payload)
        cell.planner.command(str(number), JOINT, START + 0.1 * (number + 1), settings)
    assert [id_ for id_, *_ in cell.sent] == ['0']


MIDDLE = str(WINDOW // 2 - 1)


def test_a_long_chain_goes_on_from_the_middle_of_its_plan(cell: Cell) -> None:
    cell.bead(*range(WINDOW + 1))
    assert cell.ids == [MIDDLE]  # the next plan may continue behind it
    cell.bead(*range(WINDOW + 1, WINDOW + 4), last=True)
    assert cell.ids == [MIDDLE, str(WINDOW + 3)]
    before, after = cell.trajectory(0), cell.trajectory(1)
    corner = before.duration + cell.sent[1][3]
    assert cell.ends[0][MIDDLE] == pytest.approx(corner, abs=1e-9)
    assert [*cell.ends[1]] == [str(number) for number in range(WINDOW // 2, WINDOW + 4)]
    for one, other in zip(before.sample(corner), after.sample(0.0), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-8)
    cell.end(MIDDLE)
    assert [(result.id, result.message) for result in cell.answers] == [
        (str(number), 'passed') for number in range(WINDOW // 2 - 1)
    ]
    assert cell.planner.moving
    cell.end(str(WINDOW + 3))
    assert len(cell.answers) == WINDOW + 2
    assert all(result.ok for result in cell.answers)
    assert cell.told[-1]


def test_what_comes_too_late_for_a_chain_starts_where_its_plan_stops(cell: Cell) -> None:
    cell.bead(*range(WINDOW + 1))
    cell.now += cell.ends[0][MIDDLE] - REPLACE_LEAD + 0.01
    cell.bead(WINDOW + 1, last=True)
    assert cell.ids == [MIDDLE, str(WINDOW + 1)]
    title, join_time = cell.sent[1][2:]
    assert title.endswith(' (its next motions came too late to be carried on in motion)')
    assert join_time == 0.0
    np.testing.assert_array_equal(cell.trajectory(1).position[0], cell.trajectory(0).position[-1])
    cell.end(MIDDLE)
    assert {result.id for result in cell.answers} == {str(number) for number in range(WINDOW)} - {MIDDLE}


def test_after_a_failure_no_plan_is_carried_on(cell: Cell) -> None:
    cell.bead(*range(WINDOW + 1))
    cell.end(MIDDLE, ok=False, progress='0.1')
    assert not cell.planner.moving
    cell.bead(WINDOW + 1, last=True)
    assert cell.sent[-1][3] == 0.0
    np.testing.assert_array_equal(cell.trajectory(-1).position[0], START)


def test_commands_that_others_may_follow_wait_as_long_as_the_plan_can_be_carried_on(cell: Cell) -> None:
    cell.bead(*range(WINDOW + 1))
    cell.planner.wait_no_longer()
    assert len(cell.sent) == 1
    left = cell.ends[0][MIDDLE] - REPLACE_LEAD - BLEND_PATIENCE
    assert cell.patience[-1] == pytest.approx(left, abs=1e-9)
    cell.now += left + 1e-6
    cell.planner.wait_no_longer()
    assert cell.ids == [MIDDLE, str(WINDOW)]
    assert cell.sent[1][3] < 0.0


def test_commands_behind_a_stop_wait_for_others_until_the_robot_stands(cell: Cell) -> None:
    cell.move('1', 0.2)
    cell.line('2', 0.1, BLENDED)
    cell.now += BLEND_PATIENCE
    cell.planner.wait_no_longer()
    assert cell.ids == ['1']
    assert cell.patience[-1] == BLEND_PATIENCE
    cell.q = START + 0.2
    cell.end('1')
    cell.planner.wait_no_longer()
    assert cell.ids == ['1', '2']


def test_every_command_of_a_chain_is_answered_when_the_robot_is_stopped(cell: Cell) -> None:
    cell.bead(*range(WINDOW + 1))
    cell.bead(WINDOW + 1, last=True)
    last = str(WINDOW + 1)
    assert cell.ids == [MIDDLE, last]
    cell.end(MIDDLE, ok=False, progress='0.0')
    cell.end(last, ok=False, progress='0.0')  # the controller gives it up with the one before it
    answers = {result.id: result.ok for result in cell.answers}
    assert answers == {
        str(number): False for number in range(WINDOW + 2) if str(number) not in {MIDDLE, last}
    }


# -- obstacles that come into the path ------------------------------------------------------------------


def blocked(cell: Cell, id_: str, progress: float, q: Array) -> None:
    """The controller has stopped a motion before an obstacle."""
    cell.now += 1.0
    cell.q = q
    cell.planner.result(
        MotionResult(id_, ok=False, message=BLOCKED, details={'progress': str(progress)}, blocked=True),
        cell.now,
    )


def test_a_blocked_motion_is_planned_anew_from_where_the_robot_stands_so_often(cell: Cell) -> None:
    cell.move('1', 0.4, REPLANS)
    for count in (1, 2):
        blocked(cell, '1', 0.3, START + 0.1 * count)
        assert cell.ids == ['1'] * (1 + count)
        np.testing.assert_array_equal(cell.trajectory(count).position[[0, -1]], [cell.q, START + 0.4])
    assert not cell.answers
    blocked(cell, '1', 0.3, START + 0.3)
    assert cell.ids == ['1'] * 3
    (result,) = cell.answers
    assert (result.id, result.ok, result.blocked) == ('1', False, False)
    assert result.message.startswith(
        'stopped before a collision again, after 2 ways around, as many as most_replans allows: '
    )
    assert not cell.planner.moving


@pytest.mark.parametrize(
    'settings', [PLAIN, replace(REPLANS, on_blocked='stop'), replace(REPLANS, avoid=False)]
)
def test_without_the_setting_a_blocked_motion_ends_with_what_is_in_the_way(
    cell: Cell, settings: MotionSettings
) -> None:
    cell.move('1', 0.4, settings)
    cell.move('2', 0.0, settings)
    blocked(cell, '1', 0.3, START + 0.1)
    blocked(cell, '2', 0.0, START + 0.1)  # waited behind it
    assert cell.ids == ['1', '2']
    assert [(result.id, result.ok) for result in cell.answers] == [('1', False), ('2', False)]
    assert cell.answers[0].message.startswith('stopped before a collision: ')


def test_a_line_that_is_blocked_is_not_left(cell: Cell) -> None:
    cell.line('1', 0.1, REPLANS)
    blocked(cell, '1', 0.3, START)
    assert cell.ids == ['1']
    assert [result.ok for result in cell.answers] == [False]


def test_what_was_passed_is_answered_and_the_rest_goes_on_in_its_order(cell: Cell) -> None:
    chained = replace(REPLANS, joint_blend_zone=0.02)
    cell.move('1', 0.1, chained)
    cell.planner.command('2', JOINT, CORNER, REPLANS)
    cell.move('3', 0.0, REPLANS)
    assert cell.ids == ['2', '3']
    first = cell.ends[0]['1'] / cell.trajectory(0).duration
    q = cell.trajectory(0).sample(0.5 * (1.0 + first) * cell.trajectory(0).duration)[0]
    blocked(cell, '2', 0.5 * (1.0 + first), q)
    blocked(cell, '3', 0.0, q)
    assert [(result.id, result.ok, result.message) for result in cell.answers] == [('1', True, 'passed')]
    assert cell.ids == ['2', '3', '2', '3']
    assert [[*ends] for ends in cell.ends] == [['1', '2'], ['3'], ['2'], ['3']]
    np.testing.assert_array_equal(cell.trajectory(2).position[0], q)
    np.testing.assert_array_equal(cell.trajectory(3).position[0], cell.trajectory(2).position[-1])
    cell.end('2')
    cell.end('3')
    assert not cell.planner.moving
    assert cell.told[-1]


def test_a_blocked_chain_goes_on_as_a_chain(cell: Cell) -> None:
    chained = replace(REPLANS, joint_blend_zone=0.02)
    cell.move('1', 0.1, chained)
    cell.planner.command('2', JOINT, CORNER, REPLANS)
    blocked(cell, '2', 0.1, START + 0.01)
    assert cell.ids == ['2', '2']
    assert [*cell.ends[1]] == ['1', '2']
    assert not cell.answers


def test_the_way_around_of_a_long_chain_has_the_id_of_the_motion_that_was_blocked(cell: Cell) -> None:
    cell.bead(*range(WINDOW + 1), settings=REPLANS)
    assert cell.ids == [MIDDLE]  # its plan may be carried on from there
    blocked(cell, MIDDLE, 0.0, START)
    assert cell.ids[1] == MIDDLE
    assert [*cell.ends[1]][-1] == MIDDLE
    assert not cell.answers


def test_where_there_is_no_way_around_all_is_given_up_that_was_commanded(cell: Cell) -> None:
    cell.move('1', 0.4, REPLANS)
    cell.move('2', 0.0, REPLANS)
    cell.q_dot[1] = 0.3  # a robot that still moves: nothing can be planned from there
    blocked(cell, '1', 0.3, START + 0.1)
    assert cell.ids == ['1', '2']
    assert [(result.id, result.ok) for result in cell.answers] == [('1', False), ('2', False)]
    assert 'attempt 1 of 2 to go around it failed: the robot is still moving' in cell.answers[0].message
    assert 'given up with motion 1' in cell.answers[1].message
    cell.q_dot[1] = 0.0
    cell.now += 1.0
    cell.move('3', 0.2)
    assert cell.ids[-1] == '3'


def test_a_motion_that_the_controller_does_not_let_go_on_has_failed(cell: Cell) -> None:
    cell.move('1', 0.4, REPLANS)
    blocked(cell, '1', 0.3, START + 0.1)
    assert cell.end('1', ok=False, progress='0')
    assert not cell.planner.moving
    assert not cell.answers  # the controller's result is the last one


def test_a_motion_that_is_blocked_while_another_is_planned_comes_before_it(planning: PathPlanning) -> None:
    class Busy(Cell):
        """Its planner is at work when the obstacle comes."""

        def submit(self, work: Callable[[], None]) -> None:
            self.works.append(work)

    cell = Busy.__new__(Busy)
    cell.works = []
    Cell.__init__(cell, planning)
    cell.move('1', 0.4, REPLANS)
    cell.works.pop(0)()
    cell.move('2', 0.0, REPLANS)
    blocked(cell, '1', 0.3, START + 0.1)
    for work in cell.works:
        work()
    assert cell.ids == ['1', '1', '2']
    np.testing.assert_array_equal(cell.trajectory(2).position[0], START + 0.4)


def test_the_settings_of_blocked_motions_are_checked() -> None:
    with pytest.raises(InvalidInputError, match=r"on_blocked 'wait' is unknown; valid are stop and replan"):
        MotionSettings(on_blocked='wait')
    for count in (0, 101, 1.5, True):
        with pytest.raises(InvalidInputError, match=r'most_replans = .* whole number in \[1, 100\]'):
            MotionSettings(most_replans=count)  # type: ignore[arg-type]
