"""Commands become motions: from the end of the one before, as chains, and refused where they cannot."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.cell_interface.motion_result import MotionResult
from robots_planning import MotionSettings, PathPlanning
from robots_planning.commands.command_planner import REPLACE_LEAD, CommandPlanner, MotionPlannerPort
from robots_planning.commands.command_queue import CommandQueue
from robots_planning.commands.motion_plan import MotionPlan, QueuedCommand
from robots_planning.motion_kinds import JOINT, LINE, MotionKind
from robots_planning.trajectory_generators.trajectory_generator import Target


@pytest.fixture(scope='module')
def robot() -> BaseRobotModel:
    return load_robot_model('ur10e')


@pytest.fixture(scope='module')
def planning(robot: BaseRobotModel) -> PathPlanning:
    return PathPlanning(robot)


class Desk(MotionPlannerPort):
    """A planner with what it sends and refuses."""

    def __init__(self, planning: PathPlanning) -> None:
        self.robot = planning.robot
        self.start = np.array([0.2, -1.2, 1.6, -1.9, -1.4, 0.3])
        self.speed = 0.0
        self.queue = CommandQueue()
        self.sent: list[MotionPlan] = []
        self.refusals: dict[str, str] = {}
        self.planner = CommandPlanner(planning, self.queue, self)

    # -- port ---------------------------------------------------------------------------------------

    def time(self) -> float:
        return 0.0

    def reference(self) -> tuple[np.ndarray, np.ndarray]:
        return self.start, np.full(6, self.speed)

    def send(self, plan: MotionPlan) -> None:
        self.sent.append(plan)

    def answer(self, result: MotionResult) -> None:
        self.refusals[result.id] = result.message

    # -- those around it ----------------------------------------------------------------------------

    def order(self, number: int, target: Target, kind: MotionKind = JOINT, **how: object) -> None:
        order = QueuedCommand(str(number), kind, target, MotionSettings(**how), float(number))  # type: ignore[arg-type]
        orders = self.queue.hold(order)
        if orders:
            self.planner.plan(orders)

    def pass_time(self, path_time: float) -> None:
        self.planner.progress(path_time / self.queue.running[0].trajectory.duration)

    def pose(self, dx: float, dy: float, dz: float) -> Pose:
        start = Pose(*self.robot.direct_kinematics(self.start))
        return Pose(start.r + np.array([dx, dy, dz]), start.T)


@pytest.fixture
def desk(planning: PathPlanning) -> Desk:
    return Desk(planning)


def test_each_motion_starts_where_the_one_before_ends(desk: Desk) -> None:
    desk.order(1, desk.start + 0.1)
    desk.order(2, desk.start - 0.1)
    desk.order(3, desk.pose(0.0, 0.05, 0.0), LINE)
    trajectories = [planned.motion.trajectory for planned in desk.sent]
    np.testing.assert_array_equal(trajectories[0].position[0], desk.start)
    for before, after in pairwise(trajectories):
        np.testing.assert_array_equal(after.position[0], before.position[-1])
    assert [[*motion.ends] for motion in desk.queue.running] == [['1'], ['2'], ['3']]
    assert not desk.refusals


def test_a_chain_is_one_motion_of_its_last_command(desk: Desk) -> None:
    desk.order(1, desk.start + 0.2, joint_blend_zone=0.05)
    desk.order(2, desk.pose(0.1, 0.1, 0.0), LINE, blend_zone=0.02)
    assert not desk.sent
    desk.order(3, desk.pose(0.0, 0.1, 0.0), LINE)
    (planned,) = desk.sent
    assert [*planned.ends] == ['1', '2', '3']
    (motion,) = desk.queue.running
    assert [*motion.ends] == ['1', '2', '3']
    assert motion.id == '3'
    first, second, third = motion.ends.values()
    assert 0.0 < first < second < third == motion.trajectory.duration
    reached = Pose(*desk.robot.direct_kinematics(motion.trajectory.position[-1]))
    assert reached.distance_to(desk.pose(0.0, 0.1, 0.0))[0] < 1e-6


def test_a_chain_that_cannot_run_through_is_done_one_by_one(desk: Desk) -> None:
    desk.order(1, desk.start + 0.1, joint_blend_zone=0.05)
    desk.order(2, desk.start + 0.1, joint_blend_zone=0.05)  # goes nowhere: nothing runs through it
    desk.order(3, desk.start + 0.2)
    assert [[*planned.ends] for planned in desk.sent] == [['1'], ['2'], ['3']]
    assert not desk.refusals


def test_what_stands_before_an_impossible_motion_of_a_chain_is_done(desk: Desk) -> None:
    desk.order(1, desk.start + 0.1, joint_blend_zone=0.05)
    desk.order(2, desk.pose(9.0, 0.0, 0.0), LINE, blend_zone=0.01)
    desk.order(3, desk.start)
    assert [planned.id for planned in desk.sent] == ['1']
    assert 'reach' in desk.refusals['2']
    assert 'given up with motion 2 before it' in desk.refusals['3']


def test_what_follows_a_failure_is_refused_and_what_comes_later_starts_anew(desk: Desk) -> None:
    desk.order(1, desk.start + 0.1)
    desk.queue.ended('1', ok=False, at=2.5)
    desk.order(2, desk.start + 0.2)
    assert 'given up with motion 1' in desk.refusals['2']
    desk.start = desk.start + 0.03
    desk.order(3, desk.start + 0.2)
    np.testing.assert_array_equal(desk.sent[-1].motion.trajectory.position[0], desk.start)


def test_a_failure_while_it_plans_makes_it_plan_anew(desk: Desk, planning: PathPlanning) -> None:
    desk.order(1, desk.start + 0.1)
    stood = desk.start + 0.05
    plan, calls = planning.plan, []

    def plan_and_fail(*arguments: object, **options: object) -> object:
        calls.append(arguments)
        if len(calls) == 1:
            # The robot stops on its way to where this plan starts, before the command was given.
            desk.queue.ended('1', ok=False, at=1.5)
            desk.start = stood
        return plan(*arguments, **options)  # type: ignore[arg-type]

    planning.plan = plan_and_fail  # type: ignore[method-assign, assignment]
    try:
        desk.order(2, desk.start + 0.2)
    finally:
        del planning.plan  # type: ignore[method-assign]
    assert len(calls) == 2
    np.testing.assert_array_equal(desk.sent[-1].motion.trajectory.position[0], stood)


def test_a_robot_that_does_not_stand_is_reported(planning: PathPlanning) -> None:
    desk = Desk(planning)

    desk.speed = 0.1
    desk.order(1, desk.start + 0.1)
    assert 'still moving' in desk.refusals['1']
    assert not desk.sent


def test_a_replacing_joint_motion_joins_the_running_one(desk: Desk) -> None:
    desk.planner.replace = True
    desk.order(1, desk.start + 0.5)
    desk.pass_time(0.2)
    desk.order(2, desk.start - 0.2)
    first, second = desk.sent
    assert second.join_time == pytest.approx(0.2 + REPLACE_LEAD)
    states = zip(
        first.motion.trajectory.sample(second.join_time), second.motion.trajectory.sample(0.0), strict=True
    )
    for before, after in states:
        np.testing.assert_allclose(after, before, atol=1e-9)  # rounding of polynomials
    assert [[*motion.ends] for motion in desk.queue.running] == [['2']]


@pytest.mark.parametrize('case', ['line', 'almost there', 'two run'])
def test_what_cannot_replace_waits(desk: Desk, case: str) -> None:
    desk.order(1, desk.start + 0.5)
    if case == 'two run':
        desk.order(2, desk.start)
    desk.planner.replace = True
    desk.pass_time(desk.sent[0].motion.duration - 0.01 if case == 'almost there' else 0.1)
    if case == 'line':
        desk.order(9, Pose(*desk.robot.direct_kinematics(desk.start)), LINE)
    else:
        desk.order(9, desk.start - 0.2)
    assert desk.sent[-1].id == '9'
    assert desk.sent[-1].join_time == 0.0
    np.testing.assert_array_equal(
        desk.sent[-1].motion.trajectory.position[0], desk.sent[-2].motion.trajectory.position[-1]
    )
