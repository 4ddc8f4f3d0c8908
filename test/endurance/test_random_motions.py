"""Random motions: a few that run with the suite, and what looks for broken limits in them."""

from __future__ import annotations

import numpy as np
import pytest

from limit_differences import broken_limits, limit_uses
from printed_tables import as_markdown
from random_motions import motion_run
from random_motions.motion_run import MotionFigures, plan_uses, run_seed
from random_motions.random_motion import RandomMotion, random_motion
from random_motions.summary import closing_line, summary
from robots_core import available_robot_models, load_robot_model
from robots_planning import LinearJoint, PathPlanning, Trajectory
from robots_planning.motion_kinds import JOINT, MOTION_KINDS
from robots_planning.motion_settings import MotionSettings

# Every robot once, and motions that have broken limits: a speed between the nodes of its cap (815, 1827), and
# accelerations between the points of plans that keep jerk limits (1216, 2718).
SEEDS = (*range(len(available_robot_models())), 815, 1216, 1827, 2718)
MANY = range(400)
ROBOT = load_robot_model('kuka_kr210_r2700')
AXES = ROBOT.axes_data
PERIOD = 1e-3


@pytest.mark.parametrize('seed', SEEDS)
def test_a_random_motion_keeps_every_limit_at_every_instant(seed: int) -> None:
    assert run_seed(seed).problems == ()


def test_motions_follow_from_their_seeds_and_differ() -> None:
    motions = [random_motion(seed, ROBOT) for seed in MANY]
    again = [random_motion(seed, ROBOT) for seed in MANY]
    assert [str(motion) for motion in motions] == [str(motion) for motion in again]
    assert len({str(motion) for motion in motions}) == len(MANY)


def test_they_use_every_kind_planner_and_event() -> None:
    motions = [random_motion(seed, ROBOT) for seed in MANY]
    commands = [command for motion in motions for command in motion.commands]
    assert {kind for kind, _, _ in commands} == set(MOTION_KINDS)
    assert {settings.joint_planner for _, _, settings in commands} == {'linear_joint', 'linear_joint_axes'}
    assert {s.cartesian_planner for _, _, s in commands} == {'limited', 'dynamic_programming'}
    assert {settings.jerk_limited for _, _, settings in commands} == {True, False}
    assert {bool(motion.overrides) for motion in motions} == {True, False}
    assert {motion.stop_at < np.inf for motion in motions} == {True, False}
    assert {len(motion.commands) > 1 for motion in motions} == {True, False}
    assert {motion.tool_speed_limit > 0.0 for motion in motions} == {True, False}


def swings(velocity: float, acceleration: float) -> np.ndarray:
    """Positions of axis 4, which swings with these parts of its limits."""
    rate = acceleration * AXES.acceleration[3] / (velocity * AXES.velocity[3])
    amplitude = velocity * AXES.velocity[3] / rate
    q = np.tile(ROBOT.home, (4000, 1))
    q[:, 3] += amplitude * np.sin(rate * PERIOD * np.arange(len(q)))
    return q


@pytest.mark.parametrize(
    ('velocity', 'acceleration', 'broken'),
    [(1.0, 1.0, []), (1.001, 1.0, ['velocity']), (1.0, 1.001, ['acceleration'])],
)
def test_differences_distinguish_a_limit_that_is_kept_from_one_that_is_not(
    velocity: float, acceleration: float, broken: list[str]
) -> None:
    found = list(broken_limits(AXES, limit_uses(AXES, swings(velocity, acceleration), PERIOD)))
    assert [line.split()[:2] for line in found] == [['A4', quantity] for quantity in broken]


def test_jerk_is_looked_at_where_it_is_limited() -> None:
    q = np.tile(ROBOT.home, (100, 1))
    t = PERIOD * np.arange(100)
    q[:, 0] += 1.01 * AXES.jerk[0] * t**3 / 6.0
    assert not list(broken_limits(AXES, limit_uses(AXES, q, PERIOD)))
    (line,) = broken_limits(AXES, limit_uses(AXES, q, PERIOD, jerk=True))
    assert line.startswith('A1 jerk')
    assert '101.00 %' in line


def test_an_axis_outside_its_range_is_named_with_the_bound() -> None:
    q = np.tile(ROBOT.home, (10, 1))
    q[:, 2] = AXES.upper[2] + 1e-6
    (line,) = broken_limits(AXES, limit_uses(AXES, q, PERIOD))
    assert line.startswith('A3 position')
    assert f'{AXES.upper[2]:.6g}' in line


def test_differences_over_a_gap_do_not_count() -> None:
    q = np.concatenate([swings(0.5, 0.5)] * 2)
    q[len(q) // 2 :, 0] += 0.3
    steady = np.ones(len(q) - 1, bool)
    assert list(broken_limits(AXES, limit_uses(AXES, q, PERIOD, steady=steady)))
    steady[len(q) // 2 - 1] = False
    assert not list(broken_limits(AXES, limit_uses(AXES, q, PERIOD, steady=steady)))


def fast_motion() -> tuple[RandomMotion, Trajectory]:
    settings = MotionSettings()
    target = ROBOT.home + 0.3
    plan = LinearJoint(ROBOT).generate(ROBOT.home, target)
    faster = Trajectory(plan.time / 1.1, plan.position, 1.1 * plan.velocity, 1.21 * plan.acceleration)
    motion = RandomMotion(
        seed=0,
        robot=ROBOT.name,
        start=ROBOT.home,
        commands=((JOINT, target, settings),),
        period=0.004,
        smoothing_time=0.02,
        tool_speed_limit=0.0,
        overrides=(),
        stop_at=np.inf,
        fast_stop=False,
    )
    return motion, faster


def test_a_plan_that_breaks_limits_is_found_and_so_is_the_controller_s_refusal() -> None:
    motion, faster = fast_motion()
    _, problems = plan_uses(motion, ROBOT, PathPlanning(ROBOT), faster, with_torque=False)
    assert {line.split()[2] for line in problems} >= {'acceleration', 'jerk'}
    _, failures = motion_run.follow(motion, ROBOT, faster)
    assert 'refused by the limit guard' in failures[0]


def test_an_error_that_is_none_of_ours_is_a_problem(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(motion_run, 'random_motion', fail)
    (problem,) = run_seed(3).problems
    assert 'ZeroDivisionError' in problem


def test_the_table_has_a_row_per_robot_and_one_for_all() -> None:
    found = [
        MotionFigures(0, 'a', '', {'velocity': 0.5, 'jerk': 1.0}, (), 1800.0),
        MotionFigures(1, 'b', 'PlanningError'),
        MotionFigures(2, 'a', '', {'velocity': 0.75}, ('plan: too fast',), 1800.0),
        MotionFigures(3, 'b', 'PlanningError'),
    ]
    table = summary(found)
    cells = {row.cells[0]: row.cells for row in table.rows}
    assert cells['`a`'][1:5] == ('2', '', '0.7500000', '-')
    assert cells['`b`'][1:4] == ('2', '2 PlanningError', '-')
    assert cells['all'][1:4] == ('4', '2 PlanningError', '0.7500000')
    assert [row.cells[-1] for row in table.rows] == ['1', '0', '1']
    assert closing_line(found).startswith('4 motions, 2 planned and followed (1.0 hours of motion), 1 with')
    assert as_markdown(table).splitlines()[2].startswith('| `a` | 2 |')
