"""Every program of programs/, simulated on its robot, and its report opened."""

from __future__ import annotations

from pathlib import Path

import pytest

from robots_controller.report import run_report, write_report
from robots_controller.simulate import simulate

from .report_browsers import BROWSERS, open_page
from .test_report_page import Page

PROGRAMS = Path(__file__).parents[2] / 'programs'
ROBOTS = {
    'bello_bot_tour': 'bello_bot',
    'rover_placement': 'kinova_j2n6s300',
    'three_axis_grasp': 'debris_arm?gravity=0,0,0',
    'wheel_test': 'kuka_kr210_r3100',
}
SCENES = dict.fromkeys(('welding_collision', 'welding_around_pillar'), 'car_frame')
# The motion through the pillar is refused.
FAIL = ('welding_collision',)


@pytest.mark.parametrize('name', sorted(path.stem for path in PROGRAMS.glob('*.lua')))
def test_its_report_opens_without_an_error(name: str, tmp_path: Path):
    io = PROGRAMS / 'io' / f'{name}.yaml'
    scene = PROGRAMS / 'scenes' / f'{SCENES[name]}.yaml' if name in SCENES else ''
    run = simulate(
        PROGRAMS / f'{name}.lua',
        robot=ROBOTS.get(name, 'kuka_kr210_r2700'),
        drive='ideal',
        scene=scene,
        io=io if io.exists() else '',
        bag=tmp_path / 'bag',
    )
    assert run.ok == (name not in FAIL), run.error
    path = tmp_path / 'report.html'
    report = write_report(tmp_path / 'bag', path, robot=run.robot, scene=scene or None)
    # The bag's stamps are whole nanoseconds.
    assert report.run.duration == pytest.approx(run.duration, abs=1e-6)
    assert len(report.motions) == sum(motion.ok for motion in run.motions)
    # Also where motions run through to the next, each has its time.
    assert all(item.duration > 0.0 for item in report.motions)
    assert (report.clearance is not None) == bool(scene)
    Page(path.read_text(encoding='utf-8'))  # raises what its script raises
    for browser in BROWSERS:
        opened = open_page(browser, path, tmp_path / 'profile')
        assert opened.errors == []
        # Every plot is drawn, and the robot shaded.
        assert all(colours > 2 for _, colours in opened.colours)
        assert dict(opened.colours)['robot'] > 50


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
