"""The report on a run: tool, base and blended motions count as the program meant them."""

from __future__ import annotations

from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from robots_controller.recording.bag_reading import read_messages
from robots_controller.recording.motion_record import recorded_motions
from robots_controller.report.motion_report import TOPICS, MotionReport, motion_report
from robots_controller.simulate import simulate
from robots_core import load_robot_model

ROBOT = 'kuka_kr210_r2700'
PROGRAM = """\
setTool(0, 0, 0.2, 0, 0, 0)
setBase(0.1, -0.2, 0.3, 30, 0, 0)
ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)
local p = getCartesianPosition()
ptpCartesianSpace({p[1], p[2] + 0.3, p[3], p[4], p[5], p[6]}, {blend = 0.03})
ptpCartesianSpace({p[1], p[2] + 0.3, p[3] - 0.3, p[4] + 20, p[5], p[6]}, {blend = 0.05})
ptpCartesianSpace(p)
ptpJointSpaceAngles({0, -80, 90, 0, 90, 0}, {jointBlend = 10})
ptpJointSpaceAngles(20, -80, 90, 0, 90, 0)
call("home", 3)
"""
SUBPROGRAM = """\
ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)
"""


@pytest.fixture(scope='module')
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp('run')
    (folder / 'part.lua').write_text(PROGRAM)
    (folder / 'home.lua').write_text(SUBPROGRAM)
    run = simulate(folder / 'part.lua', robot=ROBOT, bag=folder / 'bag')
    assert run.error is None
    return folder / 'bag'


@pytest.fixture(scope='module')
def report(bag: Path) -> MotionReport:
    return motion_report(bag, ROBOT)


def shown(report: MotionReport) -> str:
    text = StringIO()
    report.show(Console(file=text, width=500))
    return text.getvalue()


def test_every_motion_is_as_the_program_meant_it(report: MotionReport) -> None:
    assert report.ok, shown(report)
    assert [row.line for row in report.rows] == [3, 5, 6, 7, 8, 9, 1]
    assert [row.place for row in report.rows] == ['3', '5', '6', '7', '8', '9', 'home.lua:1']
    assert 'every target reached, every limit kept' in shown(report)


def test_a_blended_motion_tells_its_zone_and_how_near_it_passed(report: MotionReport) -> None:
    passings = {row.line: row.passing for row in report.rows if row.passing is not None}
    assert {line: (p.zone, p.joints) for line, p in passings.items()} == {
        5: (pytest.approx(0.03), False),
        6: (pytest.approx(0.05), False),
        8: (pytest.approx(np.radians(10.0)), True),
    }
    for passing in passings.values():
        assert 0.0 < passing.distance < passing.zone
    assert f'{passings[5].describe()}' in shown(report)
    assert passings[5].describe().endswith('of 30 mm')
    assert passings[8].describe().endswith('of 10 deg')
    for row in report.rows:
        assert np.isnan(row.position_error) == (row.passing is not None)


def test_the_parts_of_a_chain_add_up_to_it(bag: Path, report: MotionReport) -> None:
    messages = read_messages(bag, ['/' + topic for topic in TOPICS])
    robot = load_robot_model(ROBOT)
    motions = recorded_motions({topic[1:]: rows for topic, rows in messages.items()}, robot)
    assert [len(motion.commands) for motion in motions] == [1, 3, 2, 1]
    planned = [row.planned for row in report.rows]
    for motion, rows in zip(motions, (planned[:1], planned[1:4], planned[4:6], planned[6:]), strict=True):
        assert motion.plan is not None
        assert sum(rows) == pytest.approx(motion.plan.duration)
        assert min(rows) > 0.0
    settings = motions[1].commands[0].settings
    assert settings.tool[:3] == (0.0, 0.0, pytest.approx(0.2))
    assert settings.base[:3] == pytest.approx((0.1, -0.2, 0.3))


def test_lines_are_straight_outside_their_zones_alone(report: MotionReport) -> None:
    deviations = {row.line: row.line_deviation for row in report.rows if row.line_deviation is not None}
    assert list(deviations) == [5, 6, 7]
    # The corners are cut by millimetres; what is left are the planner's 10 um and the controller's average.
    assert max(deviations.values()) < 2e-5


def test_a_robot_with_another_tool_has_missed(bag: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same bag without its settings: the flange is not where the tool should be."""
    real = read_messages

    def without_settings(path: Path, topics: list[str]) -> dict[str, list[tuple[float, object]]]:
        return {topic: [] if topic == '/motion_settings' else m for topic, m in real(path, topics).items()}

    monkeypatch.setattr('robots_controller.report.motion_report.read_messages', without_settings)
    report = motion_report(bag, ROBOT)
    assert not report.ok
    missed = {row.line for row in report.rows if 'the target was missed by' in row.problem}
    assert missed == {7}  # the line of poses; joints are joints with any tool
    assert 'the target was passed outside its zone' in report.rows[1].problem


def test_a_refused_motion_is_told_with_its_reason(tmp_path: Path) -> None:
    program = tmp_path / 'wrong.lua'
    program.write_text('ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)\nptpCartesianSpace(9, 0, 1, 0, 0, 0)\n')
    assert simulate(program, robot=ROBOT, bag=tmp_path / 'bag').error is not None
    report = motion_report(tmp_path / 'bag', ROBOT)
    assert not report.ok
    assert [row.ok for row in report.rows] == [True, False]
    assert report.program_state == 'FAILED'
    assert f'line 2: {report.rows[1].problem}' in shown(report)
    assert report.rows[1].problem in report.program_error
