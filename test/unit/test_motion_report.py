"""The report on a run: tool, base and blended motions count as the program meant them."""

from __future__ import annotations

from dataclasses import replace
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from robots_controller.recording.bag_file import Bag, read_bag
from robots_controller.report.run_report import RunReport, run_report
from robots_controller.report.terminal import show_verdict
from robots_controller.simulate import simulate

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
def report(bag: Path) -> RunReport:
    return run_report(bag)


def shown(report: RunReport) -> str:
    text = StringIO()
    show_verdict(report, Console(file=text, width=500))
    return text.getvalue()


def test_every_motion_is_as_the_program_meant_it(report: RunReport) -> None:
    assert report.ok, shown(report)
    assert [item.motion.line for item in report.motions] == [3, 5, 6, 7, 8, 9, 1]
    assert [report.place(item.motion) for item in report.motions] == [
        '3',
        '5',
        '6',
        '7',
        '8',
        '9',
        'home.lua:1',
    ]
    assert 'every target reached, every limit kept' in shown(report)


def test_a_blended_motion_reports_its_zone_and_how_near_it_passed(report: RunReport) -> None:
    passings = {one.motion.line: one.passing for one in report.motions if one.passing is not None}
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
    for item in report.motions:
        assert np.isnan(item.position_error) == (item.passing is not None)


def test_the_parts_of_a_chain_add_up_to_it(report: RunReport) -> None:
    motions = report.run.motions
    assert [motion.own for motion in motions] == [True, False, False, True, False, True, True]
    for chain in (motions[:1], motions[1:4], motions[4:6], motions[6:]):
        plan = chain[0].plan
        assert plan is not None
        assert all(motion.plan is plan for motion in chain)
        assert sum(motion.planned for motion in chain) == pytest.approx(plan.duration)
        assert min(motion.planned for motion in chain) > 0.0
    settings = motions[1].settings
    assert settings.tool[:3] == (0.0, 0.0, pytest.approx(0.2))
    assert settings.base[:3] == pytest.approx((0.1, -0.2, 0.3))


def test_lines_are_straight_outside_their_zones_alone(report: RunReport) -> None:
    deviations = {
        one.motion.line: one.line_deviation for one in report.motions if one.line_deviation is not None
    }
    assert list(deviations) == [5, 6, 7]
    # The corners are cut by millimetres; what is left are the planner's 10 um and the controller's average.
    assert max(deviations.values()) < 2e-5


def test_a_robot_with_another_tool_has_missed(bag: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same bag without its settings: the flange is not where the tool should be."""

    def without_settings(path: Path) -> Bag:
        whole = read_bag(path)
        return replace(whole, messages=tuple(m for m in whole.messages if m[0] != '/motion_settings'))

    monkeypatch.setattr('robots_controller.report.recorded_run.read_bag', without_settings)
    report = run_report(bag)
    assert not report.ok
    missed = {item.motion.line for item in report.motions if 'the target was missed by' in item.problem}
    assert missed == {7}  # the line of poses; joints are joints with any tool
    assert 'the target was passed outside its zone' in report.motions[1].problem


def test_a_refused_motion_is_reported_with_its_reason(tmp_path: Path) -> None:
    program = tmp_path / 'wrong.lua'
    program.write_text('ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)\nptpCartesianSpace(9, 0, 1, 0, 0, 0)\n')
    assert simulate(program, robot=ROBOT, bag=tmp_path / 'bag').error is not None
    report = run_report(tmp_path / 'bag')
    assert not report.ok
    assert [item.ok for item in report.motions] == [True, False]
    assert report.run.program_state == 'FAILED'
    assert f'line 2: {report.motions[1].problem}' in shown(report)
    assert report.motions[1].problem in report.run.program_error
