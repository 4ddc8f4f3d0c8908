"""The verdict on a program that runs through real nodes is that of its simulation."""

from __future__ import annotations

from pathlib import Path

import pytest

from robots_controller.report.run_report import RunReport, run_report
from robots_controller.simulate import simulate

from .lockstep_runs import LockstepRuns

ROBOT = 'kuka_kr210_r2700'
# Along itself and back, then a way that a handler ends by a motion of its own.
PROGRAM = """\
ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)
local p = getCartesianPosition()
local function at(y, z) return {p[1], p[2] + y, p[3] + z, p[4], p[5], p[6]} end
ptpCartesianSpace(at(0.1, 0), {blend = 0.02})
ptpCartesianSpace(p, {blend = 0.02})
ptpCartesianSpace(at(0.1, 0), {blend = 0.02})
ptpCartesianSpace(p)
onDigitalInput(1, true, function() ptpCartesianSpace(at(0.1, -0.05)) end)
setDigitalOutput(1, true)
ptpCartesianSpace(at(0.2, 0), {blend = 0.02})
ptpCartesianSpace(at(0.2, -0.1))
"""
INPUT = 'rules:\n  - {when: digital_output.1 rises, after: 0.3, set: {digital_input.1: on}}\n'


def figures(report: RunReport) -> list[tuple[int, bool, bool]]:
    return [(item.motion.line, item.motion.ended_early, item.motion.moved) for item in report.motions]


def test_chains_that_come_back_and_motions_that_a_handler_ends_are_no_failure(
    lockstep_runs: LockstepRuns, tmp_path: Path
) -> None:
    program, plc = tmp_path / 'part.lua', tmp_path / 'plc.yaml'
    program.write_text(PROGRAM)
    plc.write_text(INPUT)
    cell = lockstep_runs.run_file(program, '--robot', ROBOT, '--io', str(plc))
    assert cell.returncode == 0, cell.text
    assert '1 ended by the program, every other target reached, every limit kept' in cell.text
    live = run_report(cell.bag)
    assert simulate(program, robot=ROBOT, io=plc, rate=cell.rate, bag=tmp_path / 'bag').ok
    simulated = run_report(tmp_path / 'bag')
    assert live.ok, live.problems
    assert simulated.ok, simulated.problems
    assert figures(live) == figures(simulated)
    for one, other in zip(live.motions, simulated.motions, strict=True):
        if one.motion.moved:
            assert one.motion.duration == pytest.approx(other.motion.duration, abs=2.0 * live.run.period)
