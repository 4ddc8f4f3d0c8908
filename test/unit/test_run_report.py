from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from robots_controller.report.comparison import compare_runs
from robots_controller.report.motion_columns import SUMMARY
from robots_controller.report.page.page import report_page
from robots_controller.report.run_report import RunReport, run_report
from robots_controller.report.run_signals import energy
from robots_controller.report.tables import motion_table
from robots_core.errors import RobotsError
from robots_core.robot_choice import load_robot_model
from written_bags import BAG_START, BAG_TYPES, write_bag

from .recorded_program import PERIOD, RecordedProgram
from .report_bags import HEARD, LINE_SPEED, WAIT, tending_bag


@pytest.fixture(scope='module')
def report(tmp_path_factory: pytest.TempPathFactory) -> RunReport:
    return run_report(tending_bag(tmp_path_factory.mktemp('report') / 'bag'))


@pytest.fixture(scope='module')
def slow(tmp_path_factory: pytest.TempPathFactory) -> RunReport:
    """The same with a line that lasts half as long again."""
    return run_report(tending_bag(tmp_path_factory.mktemp('slow') / 'bag', slower=1.5))


def test_robot_and_program_are_those_of_the_bag(report: RunReport):
    assert report.run.robot.name == 'kuka_kr210_r2700'
    assert report.run.program_name == 'made_up.lua'
    assert report.run.program_state == 'FINISHED'


def test_time_begins_with_the_program(report: RunReport):
    assert report.run.program[0].line == 2
    assert report.run.program[0].time == 0.0
    assert report.run.time[0] >= 0.0


def test_spans_leave_no_moment_out(report: RunReport):
    spans = report.spans
    assert spans[0].start == 0.0
    assert spans[-1].end == report.run.duration
    assert all(before.end == after.start for before, after in pairwise(spans))


def test_times_of_all_lines_are_the_cycle_time(report: RunReport):
    assert sum(line.total for line in report.lines) == pytest.approx(report.run.duration, abs=1e-9)
    assert sum(report.times.values()) == pytest.approx(report.run.duration, abs=1e-9)


def test_each_line_is_split_by_what_it_did(report: RunReport):
    lines = {line.line: line for line in report.lines}
    moves = {item.motion.line: item.motion.duration for item in report.motions}
    assert lines[2].moving == pytest.approx(moves[2])
    assert lines[3].moving == pytest.approx(moves[3])
    # The bag's times are whole nanoseconds.
    assert lines[5].waiting == pytest.approx(WAIT, abs=1e-8)
    assert lines[6].io == pytest.approx(HEARD, abs=1e-8)
    assert lines[5].moving == lines[5].io == lines[6].moving == lines[6].waiting == 0.0


def test_tool_speed_decides_a_line_that_is_slower_than_the_axes_can(report: RunReport):
    decided = report.motions[1].deciding
    assert decided is not None
    assert (decided.quantity, decided.joint) == ('tool speed', '')
    # A speed of references, which are exact at their instants.
    assert decided.use == pytest.approx(LINE_SPEED, rel=1e-3)


def test_an_axis_at_its_limit_decides_a_joint_motion(report: RunReport):
    motion = report.motions[0]
    assert motion.deciding is not None
    use = motion.uses[motion.deciding.quantity]
    assert motion.deciding.joint == use.joint
    # A planner keeps to the limit within a part in a thousand, and samples may pass over the peak.
    assert use.ratio == pytest.approx(1.0, rel=2e-2)


def test_path_accuracy_reports_what_the_drives_lag_across_the_path(report: RunReport):
    line = report.motions[1]
    assert line.length == pytest.approx(0.5, rel=1e-3)
    assert 0.0 < line.path_deviation <= line.lag
    # The made-up drives lag 0.1 ms at the most: some 1e-4 s times the joints' tool speeds.
    assert line.lag < 1e-4 * 10.0 * LINE_SPEED


def test_channels_that_were_used_are_reported(report: RunReport):
    channels = {channel.name: channel for channel in report.run.io}
    assert set(channels) == {'digital_output.1', 'digital_input.2'}
    assert channels['digital_input.2'].value.tolist() == [0.0, 1.0]


def test_energy_is_at_least_what_the_lift_needs():
    time = np.linspace(0.0, 2.0, 501)
    power = np.stack([np.full(501, 3.0), -np.full(501, 3.0), np.sin(np.pi * time)], axis=1)
    # The third brakes in its second half: of sin, 2 / pi comes in. Trapezoids of 4 ms: error below 1e-5.
    assert energy(time, power) == pytest.approx([6.0, 0.0, 2.0 / np.pi], abs=1e-5)


def test_distances_are_reported_with_a_scene(tmp_path: Path, report: RunReport):
    scene = tmp_path / 'scene.yaml'
    r = report.signals.tool[-1]
    scene.write_text(
        f'objects:\n  - name: table\n    box: {{size: [0.1, 0.1, 0.1]}}\n'
        f'    pose: {{position: [{r[0]}, {r[1] + 0.3}, {r[2]}]}}\n'
    )
    near = run_report(report.run.source, scene=scene).clearance
    assert near is not None
    assert 'table' in (near.first, near.second)
    (motion,) = (item.motion for item in report.motions if item.motion.line == near.line)
    assert motion.start <= near.time <= motion.end
    assert 0.0 < near.smallest < 0.3
    # Nothing on the sampled curve is closer; the search is exact to a millimetre.
    assert near.curve[:, 1].min() >= near.smallest - 1e-3
    found = run_report(report.run.source, scene=scene)
    closest = {item.motion.line: item.closest for item in found.moved}
    assert closest[near.line] == near.smallest == min(closest.values())
    names = [name for name, _ in motion_table(found, SUMMARY).columns]
    assert 'closest mm' in names
    assert 'closest mm' not in [name for name, _ in motion_table(report, SUMMARY).columns]


def test_the_highest_uses_of_a_run_are_at_least_those_of_its_motions(report: RunReport):
    for quantity, use in report.uses.items():
        assert use.ratio >= max(item.uses[quantity].ratio for item in report.moved)
        assert use.ratio == report.signals.use[quantity].max()


def test_a_run_is_as_fast_as_itself(report: RunReport):
    comparison = compare_runs(report, report)
    assert comparison.difference == 0.0
    assert not comparison.largest
    assert 'as fast' in comparison.describe()


def test_comparison_says_what_got_slower_and_where(report: RunReport, slow: RunReport):
    comparison = compare_runs(report, slow)
    most = comparison.largest[0]
    assert (most.line.line, most.activity) == (3, 'moving')
    assert most.difference == pytest.approx(0.5 * report.motions[1].motion.duration, abs=2.0 * PERIOD)
    assert 'slower' in comparison.describe()
    assert 'line 3' in comparison.describe()
    assert compare_runs(slow, report).difference == pytest.approx(-comparison.difference)


@pytest.mark.parametrize(
    ('count', 'words'),
    [(1, 'line 3: +'), (2, '; lines 3 and 4 changed by about +'), (6, '; 6 lines changed by about +')],
)
def test_lines_that_changed_alike_are_not_ranked(report: RunReport, slow: RunReport, count: int, words: str):
    comparison = compare_runs(report, slow)
    most = comparison.largest[0]
    assert most.after is not None
    alike = tuple(replace(most, after=replace(most.after, line=most.after.line + k)) for k in range(count))
    assert words in replace(comparison, changes=alike).describe()


def test_refused_motions_are_reported(tmp_path: Path, report: RunReport):
    run = RecordedProgram(report.run.robot)
    run.rest(0.1)
    run.line(1, 'ptpJointSpaceAngles(200, 0, 0, 0, 0, 0)')
    run.refuse(run.q, 'too far')
    run.rest(0.1)
    bag = run.write(tmp_path / 'bag', state='FAILED', error='made_up.lua:1: too far')
    found = run_report(bag)
    assert [item.problem for item in found.motions] == ['too far']
    assert found.run.program_error == 'made_up.lua:1: too far'


def test_a_program_that_fails_at_once_is_reported(tmp_path: Path, report: RunReport):
    run = RecordedProgram(report.run.robot)
    run.rest(0.1)
    run.line(1, 'error("no")')
    found = run_report(run.write(tmp_path / 'bag', state='FAILED', error='made_up.lua:1: no'))
    assert found.run.duration == 0.0
    assert found.run.program_error == 'made_up.lua:1: no'
    assert found.energy.tolist() == [0.0] * 6
    assert 'no' in report_page(found)


def test_the_bag_of_a_driver_is_reported_by_its_feedback(tmp_path: Path):
    types, robot = BAG_TYPES.types, load_robot_model('kuka_kr210_r2700')
    names, none = list(robot.axes_data.names), np.array([])
    messages = []
    for k in range(501):  # q = 0.1 - 0.1 cos(2 t) of each axis
        t = 0.004 * k
        nanoseconds = BAG_START + round(1e9 * t)
        header = types['std_msgs/msg/Header'](
            types['builtin_interfaces/msg/Time'](*divmod(nanoseconds, 1_000_000_000)), ''
        )
        q, q_dot = (np.full(6, value) for value in (0.1 - 0.1 * np.cos(2.0 * t), 0.2 * np.sin(2.0 * t)))
        messages.append(
            (t, '/joint_states', types['sensor_msgs/msg/JointState'](header, names, q, q_dot, none))
        )
    found = run_report(write_bag(tmp_path / 'bag', messages), robot=robot.name)
    run = found.run
    assert run.period == pytest.approx(0.004)
    assert run.duration == pytest.approx(2.0)
    np.testing.assert_array_equal(run.reference[0], run.feedback[0])
    # A difference over two periods differs from the derivative by 1/6 h^2 of the third one, at ends by h.
    np.testing.assert_allclose(run.reference[2][1:-1, 0], 0.4 * np.cos(2.0 * run.time[1:-1]), atol=1e-5)
    assert found.problems == ('it holds no joint_reference; references are computed from the feedback',)
    assert 'references are computed from the feedback' in report_page(found)


def test_a_bag_without_feedback_is_refused(tmp_path: Path):
    bag = write_bag(tmp_path / 'bag', [(0.0, '/trigger', BAG_TYPES.types['std_msgs/msg/Bool'](data=True))])
    with pytest.raises(RobotsError, match=r'no /joint_states.*holds /trigger'):
        run_report(bag)
