"""Every program of programs/, simulated on its robot, and its report opened."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from functools import cache
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from cell_options import simulate_options
from robots_controller.program.files.program_header import read_program_header
from robots_controller.recording.bag_file import read_bag
from robots_controller.report.run_report import run_report
from robots_controller.simulate import simulate
from robots_controller.simulation.command_line import run
from robots_core.exit_codes import ExitCode
from short_programs import PROGRAMS, SHORTEST, short_copy

from .report_browsers import KALEIDO, open_pages
from .test_report_page import Page

DEADLINE = 100.0  # s
HALF_A_MEGABYTE = 500_000
# The motion through the pillar is refused.
FAIL = ('welding_collision',)
# Opened in browsers: a long one, one that ends early, one of another kind of robot.
OPENED = ('palletizing', 'welding_collision', 'debris_removal')

# Run as it is, as one whose curves have many points; all others in the short form of the cells' tests.
WHOLE = ('palletizing',)


def simulated(folder: Path, program: Path, *options: str) -> int:
    """Simulate as the command does, bag and report in a folder; returns its exit code."""
    outputs = ('--bag', str(folder / 'bag'), '--report', str(folder / 'report.html'))
    return run(simulate_options([str(program), *outputs, *options]), Console(quiet=True))


@pytest.fixture(scope='module')
def report_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], tuple[int, Path]]:
    """Exit code of the simulation of a program, and its report; each is simulated once."""

    @cache
    def made(name: str) -> tuple[int, Path]:
        folder, program = tmp_path_factory.mktemp(name), f'{name}.lua'
        path = PROGRAMS / program if name in WHOLE else short_copy(folder / 'programs', program, SHORTEST)
        return simulated(folder, path), folder / 'report.html'

    return made


@pytest.mark.parametrize('program', sorted(path.stem for path in PROGRAMS.glob('*.lua')))
def test_its_report_opens_without_an_error(program: str, report_of: Callable[[str], tuple[int, Path]]):
    code, path = report_of(program)
    assert code == (ExitCode.FAILED if program in FAIL else ExitCode.OK)
    Page(path.read_text(encoding='utf-8'))  # raises what its script raises


def test_reports_open_in_a_browser(report_of: Callable[[str], tuple[int, Path]], tmp_path: Path):
    paths = [report_of(name)[1] for name in OPENED]
    # The one that starts fastest is enough: `test_report_page` opens its reports in each.
    for opened in open_pages(KALEIDO, paths, tmp_path / 'browser'):
        assert opened.errors == []
        # Every plot is drawn, and the robot shaded.
        assert all(colours > 2 for _, colours in opened.colours)
        assert dict(opened.colours)['robot'] > 50


@pytest.mark.parametrize('name', ['palletizing', 'welding_collision', 'welding_around_pillar'])
def test_a_report_shows_what_was_simulated(name: str, tmp_path: Path):
    program = short_copy(tmp_path / 'programs', f'{name}.lua')
    header = read_program_header(program)
    known = simulate(program, robot=header.robot, drive='ideal', scene=header.scene, bag=tmp_path / 'bag')
    report = run_report(tmp_path / 'bag', scene=header.scene or None)
    assert report.run.program_state == known.state
    # The bag's stamps are whole nanoseconds.
    assert report.run.duration == pytest.approx(known.duration, abs=1e-6)
    assert [item.ok for item in report.motions] == [motion.ok for motion in known.motions]
    # Also where motions run through to the next, each has its time.
    assert all(item.motion.duration > 0.0 for item in report.motions if item.ok)
    assert (report.clearance is not None) == bool(header.scene)


def test_make_simulates_a_program_with_bag_and_report():
    shown = subprocess.run(
        ['make', '-n', 'simulate', 'PROGRAM=programs/press_tending.lua'],
        cwd=PROGRAMS.parent,
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    command = shown[shown.index('folder=') :]
    for text in (
        '/simulate "programs/press_tending.lua"',
        '--bag "$folder/bag"',
        '--report "$folder/report.html"',
    ):
        assert text in command


def test_a_bar_shows_the_line_the_time_and_how_fast_it_goes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv('TERM', 'xterm')  # a dumb terminal shows no bars
    monkeypatch.setattr('robots_controller.simulation.command_line.DRAW_PERIOD', 0.01)
    program = tmp_path / 'long.lua'
    program.write_text(
        'for i = 1, 4 do\n  ptpJointSpaceAngles(20, -90, 90, 0, 90, 0)\n'
        '  ptpJointSpaceAngles(-20, -90, 90, 0, 90, 0)\nend'
    )
    options = simulate_options([str(program), '--robot', 'kuka_kr210_r2700', '--drive', 'ideal'])
    shown = StringIO()
    assert run(options, Console(file=shown, force_terminal=True, width=100, color_system=None)) == ExitCode.OK
    speed = r'(?:[1-9]\d* times|0\.\d\d of) real time'
    times = [float(time) for time in re.findall(rf'line [23], (\d+\.\d) s, {speed}', shown.getvalue())]
    assert len(set(times)) > 1
    assert times == sorted(times)


def test_ctrl_c_leaves_a_bag_and_a_report(tmp_path: Path):
    program = tmp_path / 'endless.lua'
    program.write_text(
        'while true do\n  for i = -1, 1, 2 do ptpJointSpaceAngles(20 * i, -90, 90, 0, 90, 0) end\nend'
    )
    bag, report = tmp_path / 'bag', tmp_path / 'report.html'
    module, options = 'robots_controller.commands.robots', ['--robot', 'kuka_kr210_r2700', '--drive', 'ideal']
    command = [sys.executable, '-m', module, 'simulate', str(program), *options]
    process = subprocess.Popen([*command, '--bag', str(bag), '--report', str(report)], cwd=tmp_path)
    try:
        deadline = time.monotonic() + DEADLINE
        # Its first megabyte is written seconds of the simulation after the start.
        while not any(file.stat().st_size > HALF_A_MEGABYTE for file in bag.glob('*.mcap')):
            assert process.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        assert process.wait(DEADLINE) == ExitCode.INTERRUPTED
    finally:
        process.kill()
    assert not read_bag(bag).problem
    page = report.read_text(encoding='utf-8')
    assert 'endless.lua' in page
    Page(page)


def test_a_report_is_of_the_tool_that_was_set(tmp_path: Path):
    program = tmp_path / 'turn.lua'
    program.write_text(
        'ptpJointSpaceAngles(0, -90, 90, 0, 60, 0)\nsetTool(0, 0, 0.3, 0, 0, 0)\n'
        'linearRelative(0, 0, 0, 0, 30, 0, "tool")'
    )
    assert simulate(program, robot='kuka_kr210_r2700', drive='ideal', bag=tmp_path / 'bag').ok
    report = run_report(tmp_path / 'bag')
    # The robot turns about the tool's tip, which a planned line leaves by 10 um at most.
    turn = report.motions[1]
    assert turn.length < 1e-4
    assert turn.fastest < 1e-3
    assert turn.path_deviation < 1e-5


def test_a_report_is_of_the_payload_that_was_set(tmp_path: Path):
    program = tmp_path / 'payload.lua'
    there, back = 'ptpJointSpaceAngles(0, -60, 60, 0, 60, 0)\n', 'ptpJointSpaceAngles(0, -90, 90, 0, 60, 0)\n'
    program.write_text(back + there + back + 'setPayload(150, 0, 0, 0.2)\n' + there)
    assert simulate(program, robot='kuka_kr210_r2700', drive='ideal', bag=tmp_path / 'bag').ok
    _, empty, _, loaded = run_report(tmp_path / 'bag').motions
    assert loaded.uses['torque'].ratio > 1.1 * empty.uses['torque'].ratio


def test_channels_have_their_names_and_a_report_its_source(tmp_path: Path):
    (tmp_path / 'program.lua').write_text('setDigitalOutput(1, 1) waitDigitalInput(2, true)')
    (tmp_path / 'plc.yaml').write_text(
        'signals: {start_press: digital_output.1, press_closed: digital_input.2}\n'
        'rules: [{when: start_press rises, after: 0.2, set: {press_closed: true}}]'
    )
    io = tmp_path / 'plc.yaml'
    simulate(tmp_path / 'program.lua', robot='bello_bot', drive='ideal', io=io, bag=tmp_path / 'bag')
    report = run_report(tmp_path / 'bag', source='simulated')
    labels = {channel.name: channel.label for channel in report.run.io}
    assert labels == {'digital_output.1': 'start_press', 'digital_input.2': 'press_closed'}
    assert report.run.source == 'simulated'
    assert run_report(tmp_path / 'bag').run.source == str(tmp_path / 'bag')


def test_every_line_of_a_few_counts(tmp_path: Path):
    program = tmp_path / 'program.lua'
    program.write_text(
        'for i = 1, 3 do\n  setDigitalOutput(1, i % 2)\n  setDigitalOutput(2, 1)\n  wait(0.1)\nend'
    )
    simulate(program, robot='bello_bot', drive='ideal', bag=tmp_path / 'bag')
    visits = {line.line: line.visits for line in run_report(tmp_path / 'bag').lines}
    assert [visits[number] for number in (2, 3, 4)] == [3, 3, 3]


def test_two_simulations_have_the_same_report(tmp_path: Path):
    for folder in ('a', 'b'):
        simulate(PROGRAMS / 'welding.lua', robot='kuka_kr210_r2700', drive='ideal', bag=tmp_path / folder)
    first, second = (run_report(tmp_path / folder) for folder in ('a', 'b'))
    assert first.lines == second.lines
    assert first.energy.tolist() == second.energy.tolist()
