"""Verdicts on runs that are right, and on runs that are not."""

from __future__ import annotations

from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from cell_options import simulate_options
from robots_controller.report.run_report import RunReport, run_report
from robots_controller.simulate import simulate
from robots_controller.simulation.command_line import run
from robots_core.errors import RobotsError
from robots_core.exit_codes import ExitCode

ROBOT = 'kuka_kr210_r2700'
START = """\
ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)
local p = getCartesianPosition()
local function at(y, z) return {p[1], p[2] + y, p[3] + z, p[4], p[5], p[6]} end
"""
ALONG_ITSELF = (
    START
    + """\
ptpCartesianSpace(at(0.3, 0), {blend = 0.03})
ptpCartesianSpace(p, {blend = 0.03})
ptpCartesianSpace(at(0.3, 0), {blend = 0.03})
ptpCartesianSpace(p)
"""
)
TWO_LAPS = (
    START
    + """\
for lap = 1, 2 do
  ptpCartesianSpace(at(0.3, 0), {blend = 0.03})
  ptpCartesianSpace(at(0.3, -0.3), {blend = 0.03})
  ptpCartesianSpace(at(0, -0.3), {blend = 0.03})
  ptpCartesianSpace(p, {blend = lap == 1 and 0.03 or nil})
end
"""
)
INTERRUPTED = (
    START
    + """\
onDigitalInput(1, true, function() HANDLER end)
ptpCartesianSpace(at(0.5, 0), {blend = 0.02})
ptpCartesianSpace(at(0.5, -0.3))
setDigitalOutput(1, 1)
"""
)
INPUT = 'rules:\n  - {when: start, after: 3.0, set: {digital_input.1: on}}\n'


def simulated(folder: Path, text: str, *, io: str = '', scene: str = '') -> RunReport:
    (folder / 'part.lua').write_text(text)
    (folder / 'io.yaml').write_text(io or INPUT)
    simulate(
        folder / 'part.lua', robot=ROBOT, bag=folder / 'bag', io=folder / 'io.yaml' if io else '', scene=scene
    )
    return run_report(folder / 'bag')


@pytest.mark.parametrize(
    ('text', 'lines'),
    [(ALONG_ITSELF, [1, 4, 5, 6, 7]), (TWO_LAPS, [1, 5, 6, 7, 8, 5, 6, 7, 8])],
    ids=['along itself', 'two laps'],
)
def test_a_chain_that_comes_back_is_judged_motion_by_motion(
    text: str, lines: list[int], tmp_path: Path
) -> None:
    report = simulated(tmp_path, text)
    assert report.ok, report.problems
    assert [item.motion.line for item in report.motions] == lines
    # All ways are 300 mm long and as fast: motions of a chain differ by what they do at their ends.
    planned = [item.motion.planned for item in report.motions[1:]]
    assert min(planned) > 0.8 * max(planned)
    for item in report.motions[1:-1]:
        assert item.motion.duration == pytest.approx(item.motion.planned, abs=report.run.period)
        assert item.length == pytest.approx(0.3, rel=0.1)


def test_the_cycle_time_of_a_chain_is_split_between_its_lines(tmp_path: Path) -> None:
    report = simulated(tmp_path, ALONG_ITSELF)
    moving = {line.line: line.moving for line in report.lines}
    for item in report.motions:
        assert moving[item.motion.line] == pytest.approx(item.motion.duration, abs=2.0 * report.run.period)


@pytest.mark.parametrize('handler', ["return 'abort'", 'ptpCartesianSpace(at(0.1, -0.1))'])
def test_a_motion_that_a_handler_ends_is_no_failure(handler: str, tmp_path: Path) -> None:
    report = simulated(tmp_path, INTERRUPTED.replace('HANDLER', handler), io=INPUT)
    assert report.run.program_state == 'FINISHED'
    assert report.ok, report.problems
    ended = [item for item in report.motions if item.motion.ended_early]
    assert [item.motion.line for item in ended] == [5]
    assert ended[0].motion.duration < ended[0].motion.planned + 0.1
    # Its references are judged all the same.
    assert ended[0].line_deviation is not None
    assert ended[0].uses['velocity'].ratio > 0.0
    assert '1 ended by the program' in shown(tmp_path)


def test_a_chain_that_fails_is_a_failure_of_its_line(tmp_path: Path) -> None:
    report = simulated(
        tmp_path,
        START + 'ptpCartesianSpace(at(0.3, 0), {blend = 0.03})\nptpCartesianSpace(at(0.3, 5))\nwait(1)\n',
    )
    assert not report.ok
    assert report.run.program_state == 'FAILED'
    assert [item.motion.line for item in report.motions if not item.ok] == [5]
    assert 'program failed' in shown(tmp_path)


def test_motions_that_are_stopped_from_outside_fail(tmp_path: Path) -> None:
    """The program fails with them: nothing in it has dealt with the stop."""
    wall = 'objects:\n  - {name: wall, box: {size: [0.1, 0.1, 0.1]}, pose: {position: [1.55, 0.25, 1.7]}}\n'
    (tmp_path / 'scene.yaml').write_text(wall)
    report = simulated(tmp_path, ALONG_ITSELF, scene=str(tmp_path / 'scene.yaml'))
    assert not report.ok
    assert report.run.program_state == 'FAILED'


@pytest.mark.parametrize(
    ('end', 'code'), [('', ExitCode.OK), ('ptpCartesianSpace(at(9, 0))', ExitCode.FAILED)]
)
def test_simulate_gives_its_verdict_without_a_bag_too(end: str, code: int, tmp_path: Path) -> None:
    program = tmp_path / 'part.lua'
    program.write_text(START + end)
    text = StringIO()
    options = simulate_options([str(program), '--robot', ROBOT])
    assert run(options, Console(file=text, width=200)) == code
    assert ('every target reached, every limit kept' in text.getvalue()) == (code == ExitCode.OK)
    assert 'PTPJOINT_JOINT' in text.getvalue()
    assert [path.name for path in tmp_path.iterdir()] == ['part.lua']


def test_a_program_is_checked_before_it_is_simulated(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    program = tmp_path / 'part.lua'
    program.write_text(START + 'if 1 > 2 then setDigtalOutput(1, true) end\n')
    with pytest.raises(RobotsError, match=r'part\.lua has a problem, and nothing was started; --no-check'):
        run(simulate_options([str(program), '--robot', ROBOT]), Console(quiet=True))
    line = START.count('\n') + 1
    wanted = f"part.lua:{line}: there is no function setDigtalOutput; did you mean 'setDigitalOutput'?"
    assert capsys.readouterr().err.strip() == wanted
    assert (
        run(simulate_options([str(program), '--robot', ROBOT, '--no-check']), Console(quiet=True))
        == ExitCode.OK
    )


def shown(folder: Path) -> str:
    """What `simulate` prints of the program in a folder."""
    text = StringIO()
    options = simulate_options([str(folder / 'part.lua'), '--robot', ROBOT, '--io', str(folder / 'io.yaml')])
    run(options, Console(file=text, width=200))
    return text.getvalue()
