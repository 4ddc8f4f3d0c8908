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
        assert open_page(browser, path, tmp_path / 'profile').errors == []


def test_two_simulations_have_the_same_report(tmp_path: Path):
    for folder in ('a', 'b'):
        simulate(PROGRAMS / 'welding.lua', robot='kuka_kr210_r2700', drive='ideal', bag=tmp_path / folder)
    first, second = (run_report(tmp_path / folder) for folder in ('a', 'b'))
    assert first.lines == second.lines
    assert first.energy.tolist() == second.energy.tolist()
