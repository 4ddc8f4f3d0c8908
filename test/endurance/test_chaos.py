"""What the figures of faults are made of, on recordings of robots that are made up."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from chaos.judgement import OBSERVED, ON_PATH, OUTPUTS_SAFE, REACTION, FaultFigures, judge
from chaos.kept_faults import KeptFaults
from chaos.recording import JointSamples, Recording
from chaos.summary import Fault, closing_line, missed_goals, summary
from chaos.surroundings import PROGRAMS, Launched
from chaos.trial import random_trial
from printed_tables import as_markdown
from robots_controller.interpreter.lua_source import check_syntax, read_source
from robots_core import load_robot_model
from robots_core.periodic.watchdog import WATCHDOG

ROBOT = load_robot_model('kuka_kr210_r2700')
AXES = ROBOT.axes_data
PERIOD = 0.004
SPEED = 0.2 * AXES.velocity[0]  # rad/s of axis 1, about which all else stands
BRAKING = 0.5  # s
TIME = PERIOD * np.arange(-100, 1200)


def motion(stop: float, braking: float = BRAKING) -> JointSamples:
    """Axis 1 turns steadily, and brakes from a time on; infinite for never."""
    speed = SPEED * np.clip((stop + braking - TIME) / braking, 0.0, 1.0) if stop < np.inf else SPEED
    velocity = np.zeros((len(TIME), ROBOT.num_axes))
    velocity[:, 0] = speed
    position = np.tile(ROBOT.home, (len(TIME), 1))
    position[:, 0] += PERIOD * np.cumsum(velocity[:, 0]) - 1.0
    return JointSamples(TIME, TIME, position, velocity)


def recording(stop: float = 0.2, node: str = 'planning_node', **changes: object) -> Recording:
    samples = motion(stop)
    made = Recording(
        node=node,
        killed=True,
        references=samples,
        feedback=samples,
        path=motion(np.inf).position,
        latched=stop,
        reason='planner lost',
        drives=((-9.0, True),),
        words=((-1.0, 0b101), (-0.05, 0b101), (0.25, 0b100), (0.3, 0b100)),
        safe=0b100,
        resumed=3.0,
        commanded=3.2,
        moved=4.0,
        running=False,
    )
    return replace(made, **changes)  # type: ignore[arg-type]


def test_a_robot_that_stops_in_time_meets_all_goals() -> None:
    figures = judge(recording(), ROBOT)
    assert figures.stops
    assert figures.stands == pytest.approx(0.2 + BRAKING, abs=2 * PERIOD)
    assert figures.braking == pytest.approx(BRAKING, abs=2 * PERIOD)
    assert figures.deviation == pytest.approx(0.0, abs=1e-6)  # chords of an arc
    assert figures.outputs_safe == 0.25
    assert figures.usable_after == 1.0
    assert missed_goals(figures) == []


def test_the_goal_is_the_watchdog_and_a_reaction_before_the_braking() -> None:
    in_time, late = (judge(recording(WATCHDOG + REACTION + more), ROBOT) for more in (-0.02, 0.02))
    assert missed_goals(in_time) == []
    assert missed_goals(late) == ['stands']


def test_drives_without_a_controller_have_the_time_that_their_limits_take() -> None:
    least = SPEED / AXES.acceleration[0]
    samples = motion(0.02, least)
    figures = judge(
        recording(node='controller_node', feedback=samples, latched=np.inf, references=motion(np.inf)), ROBOT
    )
    assert figures.braking == pytest.approx(least)
    assert missed_goals(figures) == []


def test_a_robot_that_does_not_stop_never_stands() -> None:
    figures = judge(recording(stop=np.inf), ROBOT)
    assert figures.stands == np.inf
    assert 'stands' in missed_goals(figures)


@pytest.mark.parametrize('node', ['visualizer_node', 'direct_kinematics_node', 'io_bridge_node'])
def test_without_a_node_that_only_shows_the_robot_goes_on(node: str) -> None:
    figures = judge(recording(stop=np.inf, node=node, running=True, commanded=np.inf, moved=np.inf), ROBOT)
    assert not figures.stops
    assert np.isnan(figures.stands)
    assert np.isnan(figures.outputs_safe)
    assert figures.usable_after == 0.0
    assert missed_goals(figures) == []


def test_a_robot_that_stood_need_not_stop() -> None:
    standing = motion(-1.0)
    figures = judge(
        recording(references=standing, feedback=standing, latched=np.inf, path=standing.position), ROBOT
    )
    assert not figures.stops
    assert missed_goals(figures) == []


def test_a_lost_drive_is_judged_by_the_references() -> None:
    gone = motion(np.inf).between(-1.0, 0.0)
    figures = judge(recording(node='drive_node', feedback=gone), ROBOT)
    assert figures.stands == pytest.approx(0.2 + BRAKING, abs=2 * PERIOD)


@pytest.mark.parametrize(
    ('words', 'after'),
    [
        (((-1.0, 0b100), (0.1, 0b100)), 0.0),
        (((-1.0, 0b101), (0.1, 0b100), (0.2, 0b101), (0.31, 0b100)), 0.31),
        (((-1.0, 0b101), (0.1, 0b101)), np.inf),
        (((-1.0, 0b101), (0.1, 0b000)), np.inf),  # the one that is to be held is off
        (((-1.0, 0b101), (0.2, 0b100), (3.5, 0b101)), 0.2),  # the next run switches them
    ],
)
def test_outputs_are_safe_from_when_they_stay_so(words: tuple[tuple[float, int], ...], after: float) -> None:
    figures = judge(recording(words=words), ROBOT)
    assert figures.outputs_safe == after
    assert ('outputs' in missed_goals(figures)) == (after > OUTPUTS_SAFE)


def test_the_distance_from_the_path_is_that_of_the_flange() -> None:
    samples = motion(0.2)
    off = samples.position.copy()
    off[TIME > 0.1, 2] += 1e-3  # the elbow
    figures = judge(recording(feedback=replace(samples, position=off)), ROBOT)
    moved = ROBOT.direct_kinematics(off[-1])[0] - ROBOT.direct_kinematics(samples.position[-1])[0]
    assert figures.deviation == pytest.approx(float(np.linalg.norm(moved)), rel=1e-3)


@pytest.mark.parametrize(('node', 'missed'), [('planning_node', ['path']), ('drive_node', [])])
def test_a_robot_leaves_its_path_only_without_its_drives_or_controller(node: str, missed: list[str]) -> None:
    figures = replace(judge(recording(node=node), ROBOT), deviation=2.0 * ON_PATH)
    assert missed_goals(figures) == missed


def test_a_step_of_the_references_is_a_broken_limit_and_a_gap_between_them_is_none() -> None:
    samples = motion(0.2)
    step = samples.position.copy()
    step[TIME > 0.1, 1] += 1e-3
    figures = judge(recording(references=replace(samples, position=step)), ROBOT)
    assert 'references: A2' in figures.problems[0]
    assert 'limits' in missed_goals(figures)
    kept = (TIME < 0.05) | (TIME > 0.15)
    gap = JointSamples(TIME[kept], TIME[kept], step[kept], samples.velocity[kept])
    assert judge(recording(references=gap), ROBOT).problems == ()


def test_references_that_follow_the_feedback_of_brakes_have_no_limits() -> None:
    samples = motion(0.2)
    step = samples.position.copy()
    step[TIME > 2.0, 1] += 0.5
    lost = recording(node='drive_node', references=replace(samples, position=step))
    assert judge(lost, ROBOT).problems
    assert not judge(replace(lost, drives=((-9.0, True), (0.8, False), (3.2, True))), ROBOT).problems


def test_a_motion_that_nobody_commanded_is_named_and_one_that_somebody_did_is_not() -> None:
    samples = motion(0.2)
    for begin, problems in ((2.0, 1), (3.5, 0)):
        moved = samples.position.copy()
        moved[begin < TIME, 0] += 0.01
        figures = judge(recording(feedback=replace(samples, position=moved)), ROBOT)
        assert len(figures.problems) == problems


def test_a_robot_that_stood_does_not_begin_what_was_planned_meanwhile() -> None:
    still = motion(-1.0)
    position, velocity = still.position.copy(), still.velocity.copy()
    position[TIME > 2.0, 0] += 0.01
    begun = replace(still, position=position, velocity=velocity)
    for feedback, problems in ((still, 0), (begun, 1)):
        figures = judge(recording(stop=np.inf, feedback=feedback, references=still), ROBOT)
        assert not figures.stops
        assert len(figures.problems) == problems


def test_a_robot_that_no_reset_moves_again_is_not_usable() -> None:
    figures = judge(recording(moved=np.inf), ROBOT)
    assert missed_goals(figures) == ['usable']


def test_moments_follow_from_the_seed() -> None:
    trials = [random_trial(1, number, 'drive_node', killed=False) for number in range(20)]
    assert trials == [random_trial(1, number, 'drive_node', killed=False) for number in range(20)]
    assert len({trial.delay for trial in trials}) == 20
    assert {trial.revived for trial in trials} == {True, False}
    assert not random_trial(1, 0, 'drive_node', killed=True).revived


def test_the_table_has_medians_and_worst_values_by_node_and_says_which_goal_is_missed() -> None:
    good = judge(recording(), ROBOT)
    late = replace(good, stands=2.0)
    other: FaultFigures = judge(recording(stop=np.inf, node='visualizer_node', running=True), ROBOT)
    faults = [
        Fault('cell', 'planning_node', killed=True, figures=good),
        Fault('cell', 'planning_node', killed=True, figures=late),
        Fault('cell', 'planning_node', killed=False, figures=good),
        Fault('launch', 'visualizer_node', killed=True, figures=other),
    ]
    rows = [row.cells for row in summary(faults).rows]
    assert [row[:4] for row in rows] == [
        ('cell', '`planning_node`', 'killed', '2'),
        ('cell', '`planning_node`', 'frozen', '1'),
        ('launch', '`visualizer_node`', 'killed', '1'),
    ]
    assert rows[0][5] == '1.35 / 2.00'
    assert [row[-1] for row in rows] == ['stands', 'none', 'none']
    assert rows[2][5] == '-'
    assert closing_line(faults) == '4 faults, 1 that miss a goal'
    assert as_markdown(summary(faults)).count('\n') == 4


@pytest.mark.parametrize('name', ['seam', 'handling', 'curves'])
def test_the_programs_are_valid_and_their_cells_have_all_nodes(name: str, tmp_path: object) -> None:
    path = PROGRAMS / f'{name}.lua'
    cell = Launched(path, {}, tmp_path)  # type: ignore[arg-type]
    check_syntax(read_source(path))
    assert {'drive_node', 'controller_node', 'planning_node', 'lua_program_node', 'io_bridge_node'} <= set(
        cell.nodes
    )
    assert ('collision_node' in cell.nodes) == (name == 'seam')
    assert ('plc_node' in cell.nodes) == (name == 'curves')


def test_what_is_observed_is_longer_than_any_goal() -> None:
    assert OBSERVED > WATCHDOG + REACTION + 1.0


def test_faults_are_kept_with_all_figures(tmp_path: Path) -> None:
    figures = judge(recording(node='visualizer_node'), ROBOT)  # some are NaN
    lost = replace(figures, stands=np.inf, problems=('A1 moved', 'A2 moved'))
    keys = [(1, 'cell', 'seam', number, 'visualizer_node') for number in range(2)]
    kept = KeptFaults(tmp_path / 'faults')
    for key, each in zip(keys, (figures, lost), strict=True):
        kept.add(key, Fault('cell', 'visualizer_node', killed=True, figures=each))
    again = KeptFaults(tmp_path / 'faults')
    assert all(key in again for key in keys)
    assert (1, 'launch', 'seam', 0, 'visualizer_node') not in again
    assert repr(again.faults) == repr(kept.faults)
