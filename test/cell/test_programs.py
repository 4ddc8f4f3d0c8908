"""Every program of programs/ on its robot, from the command to its recorded bag."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from debris_removal.recorded_bodies import read_bodies
from robots_controller.cell.contact_setup import read_contact
from robots_controller.control.controller_settings import ControllerSettings
from robots_controller.recording.motion_record import MOTION_TOPICS, MotionRecord, recorded_motions
from robots_controller.report.run_report import RunReport, run_report
from robots_core import BaseRobotModel, load_robot_model
from robots_planning import Trajectory
from rover_mission.recorded_mission import read_mission
from short_programs import PROGRAMS
from wheel_laboratory.recorded_wheel import read_runs

from .bag_checks import Messages, changes, check_references, read_messages
from .lockstep_runs import LockstepRuns

IO_TOPICS = ('digital_inputs', 'digital_outputs', 'analog_inputs', 'analog_outputs')
CONTACT = PROGRAMS / 'wheel_laboratory' / 'regolith_simulant.yaml'
SURFACE, WHEEL = 0.60, 0.39  # m: of its soil, and from the flange to the wheel's lowest point
# References follow the path half a window of their moving average behind its progress.
BEHIND = 0.5 * ControllerSettings().smoothing_time  # s


@dataclass(frozen=True, eq=False)
class Run:
    """A program that has run."""

    robot: BaseRobotModel
    bag: Messages
    motions: tuple[MotionRecord, ...]
    report: RunReport
    references: Trajectory
    period: float

    @property
    def switch_delay(self) -> float:
        """Outputs switch at the next period of the controller, s."""
        return self.period + 1e-4

    def switched_between(self, *, without: tuple[int, ...] = ()) -> list[tuple[int, float, str, str]]:
        """For each output switched: channel, value, and the lines of the motions before and after."""
        found = []
        for time, channel, value in changes(self.bag, 'digital_outputs'):
            if channel in without:
                continue
            before = [motion for motion in self.motions if motion.end <= time]
            after = [motion for motion in self.motions if motion.start >= time]
            assert len(before) + len(after) == len(self.motions), f'output {channel} switched in a motion'
            places = (before[-1] if before else None, after[0] if after else None)
            found.append((channel, value, *(f'{c.file}:{c.line}' if c else '' for c in places)))
        return found

    def line_of(self, text: str, program: str) -> str:
        """'file:line' of the one line of a program that begins with a text."""
        lines = (PROGRAMS / program).read_text().splitlines()
        (number,) = (number for number, line in enumerate(lines, 1) if line.strip().startswith(text))
        return f'{program}:{number}'


def run_program(lockstep_runs: LockstepRuns, program: str, robot: str, *, streamed: bool = False) -> Run:
    """Run a program to its end; check what holds for every program."""
    cell = lockstep_runs.run(program)
    assert cell.returncode == 0, cell.text
    assert 'every target reached, every limit kept' in cell.text
    bag = read_messages(cell.bag, ['/' + topic for topic in (*MOTION_TOPICS, 'joint_reference', *IO_TOPICS)])
    model = load_robot_model(robot)
    report = run_report(cell.bag, robot=robot)
    assert report.ok
    assert not [one for one in report.motions if one.passing is not None and one.passing.distance <= 0.0]
    motions = recorded_motions({topic[1:]: rows for topic, rows in bag.items()}, model)
    period = 1.0 / cell.rate
    references = check_references(bag, model, period, streamed=streamed)
    return Run(model, bag, motions, report, references, period)


def test_palletizing(lockstep_runs: LockstepRuns) -> None:
    run = run_program(lockstep_runs, 'palletizing.lua', 'kuka_kr210_r2700')
    pick, place = 'palletizing/pick.lua', 'palletizing/place.lua'
    down = {name: run.line_of('ptpCartesianSpace', name) for name in (pick, place)}
    up = {name: run.line_of('linearRelative', name) for name in (pick, place)}
    box = [(1, 1.0, down[pick], up[pick]), (1, 0.0, down[place], up[place])]
    assert run.switched_between() == 2 * box
    # On its way between conveyor and pallet it runs through above both.
    passed = {
        run.report.place(one.motion): one.passing for one in run.report.motions if one.passing is not None
    }
    number = {
        name: {'up': up[name], 'over': run.line_of('ptpJointSpacePosition', name)} for name in (pick, place)
    }
    for name, lines in number.items():
        corners = [passed[line.removeprefix('palletizing/')] for line in lines.values()]
        assert [corner.joints for corner in corners] == [False, True], name
        assert [corner.zone for corner in corners] == pytest.approx([0.10, np.radians(5.0)])


def test_press_tending(lockstep_runs: LockstepRuns) -> None:
    run = run_program(lockstep_runs, 'press_tending.lua', 'kuka_kr210_r2700')
    program = 'press_tending.lua'
    down, up = (
        run.line_of('ptpCartesianSpace(place)', program),
        run.line_of('ptpCartesianSpace(above', program),
    )
    outside = run.line_of('ptpJointSpaceAngles(0, -100', program)
    lines = (PROGRAMS / program).read_text().splitlines()
    to_press = [number for number, text in enumerate(lines, 1) if 'above(PRESS' in text]
    switched = run.switched_between(without=(3,))
    assert [item[:2] for item in switched] == [(2, 1.0), (2, 0.0), (1, 1.0), (1, 0.0), (2, 1.0), (2, 0.0)]
    assert {item[2:] for item in switched if item[0] == 2} == {(down, up)}
    assert {item[2:] for item in switched if item[0] == 1} == {(outside, f'{program}:{to_press[1]}')}
    # The pulse continues while the robot moves.
    (rise, _, one), (fall, _, zero) = (item for item in changes(run.bag, 'digital_outputs') if item[1] == 3)
    assert (one, zero) == (1.0, 0.0)
    assert fall - rise == pytest.approx(0.3, abs=run.switch_delay)
    # The robot stands outside while the press is not ready.
    inputs = [(time, value) for time, channel, value in changes(run.bag, 'digital_inputs') if channel == 1]
    (closed, _), (opened, _) = inputs[-2:]
    assert not [motion for motion in run.motions if motion.start < opened and motion.end > closed]


def test_laser_seam(lockstep_runs: LockstepRuns) -> None:
    run = run_program(lockstep_runs, 'laser_seam.lua', 'kuka_kr210_r2700')
    seam = run.motions[1:]
    assert [motion.message for motion in seam] == ['passed'] * (len(seam) - 1) + ['reached']
    # Each line is done by one of several plans, one after the other without a gap.
    assert len({id(motion.plan) for motion in seam}) > 2
    for before, after in pairwise(seam):
        assert after.before is before
        assert after.start == pytest.approx(before.end, abs=1e-9)
    (on, _, one), (off, _, zero) = changes(run.bag, 'digital_outputs')
    assert (one, zero) == (1.0, 0.0)
    assert seam[0].start < on < seam[0].end
    assert seam[-1].start < off < seam[-1].end
    # Welding at one speed; the first line begins and the last one ends at rest.
    speeds = [figures.fastest for figures in run.report.motions[3:-2]]
    assert max(speeds) < 1.01 * min(speeds)


def test_wheel_laboratory(lockstep_runs: LockstepRuns) -> None:
    run = run_program(lockstep_runs, 'wheel_laboratory.lua', 'kuka_kr210_r3100', streamed=True)
    down, up = (run.motions[k] for k in (-3, -2))
    (wheel,) = read_runs(lockstep_runs.run('wheel_laboratory.lua').bag, read_contact(CONTACT))
    # Pressed by force between the line down to the soil and the line up from it, then driven.
    assert wheel.slip == 0.2
    assert SURFACE < down.pose.r[2] - WHEEL < SURFACE + 0.01
    pressed = (wheel.time > wheel.driving - 0.2) & (wheel.time < wheel.driving)
    np.testing.assert_allclose(wheel.load[pressed], wheel.wanted, rtol=1e-2)
    driven = wheel.time > wheel.driving
    assert np.abs(wheel.load[driven] - wheel.wanted).max() < 3.0
    assert wheel.steady('speed').mean() == pytest.approx(0.03, rel=1e-2)
    moving = driven & (wheel.speed > 0.02)  # it swings back a little when it stops
    assert (np.diff(wheel.drawbar_pull[moving]) > 0.0).all()
    way = up.pose.r - down.pose.r
    assert way[1] == pytest.approx(0.03 * (2.0 - 0.5 * 0.6), abs=2e-3)  # 0.6 s to gain its speed
    (on, *_), (off, *_) = changes(run.bag, 'digital_outputs')
    assert down.end < on < off < up.start


def test_debris_removal(lockstep_runs: LockstepRuns) -> None:
    run_program(lockstep_runs, 'debris_removal.lua', 'debris_arm?gravity=0,0,0', streamed=True)
    bodies = read_bodies(lockstep_runs.run('debris_removal.lua').bag)
    held, refused, at_rest = bodies.inputs
    assert held is not None
    assert at_rest is not None
    assert held < at_rest
    assert refused is None
    assert 'impulse on the target' in bodies.report
    # Nothing acts from outside; the target had all of the momentum, and the wheels have it now.
    assert np.abs(bodies.drift).max() < 1e-9
    # Both count as standing at 1e-4 rad/s, and have up to 1500 kg m^2.
    np.testing.assert_allclose(bodies.momentum[0, 1], bodies.momentum[-1, 2], atol=0.15)
    assert np.abs(bodies.rates(bodies.target)[0]).max() == pytest.approx(0.035, rel=0.01)
    for poses in (bodies.base, bodies.target):
        assert np.abs(bodies.rates(poses)[-1]).max() < 2e-4
    away = [(bodies.tool(k).inverse() @ bodies.target[k]).r for k in range(len(bodies.time))]
    after = np.array(away)[bodies.time > held + 0.1]
    np.testing.assert_allclose(after, after[[0]].repeat(len(after), axis=0), atol=1e-3)


def test_rover_placement(lockstep_runs: LockstepRuns) -> None:
    run = run_program(lockstep_runs, 'rover_placement.lua', 'rover_jaco')
    name = 'rover_placement.lua'
    lines = (PROGRAMS / name).read_text().splitlines()
    down, up, lower, raise_ = (
        f'{name}:{number}' for number, line in enumerate(lines, 1) if line.startswith('linearRelative')
    )
    assert run.switched_between() == [(1, 1.0, down, up), (1, 0.0, lower, raise_)]
    # The package weighs from when the hand has it until it is released.
    carried = [motion.settings.payload[0] for motion in run.motions]
    assert carried == [0.0, 0.0, 1.4, 1.4, 1.4, 0.0, 0.0]
    mission = read_mission(lockstep_runs.run(name).bag, PROGRAMS / 'scenes' / 'rover_placement.yaml')
    assert mission.clearance.min() > 5e-3
    # At rest the ground carries everything.
    bodies = sum(run.robot.rigid_dynamics_model.masses)
    still = np.abs(mission.ground[[0, -1], 2])
    np.testing.assert_allclose(still, 9.81 * bodies, rtol=1e-3)


def test_motion_simulator(lockstep_runs: LockstepRuns) -> None:
    run = run_program(lockstep_runs, 'motion_simulator.lua', 'kuka_kr500_r2830')
    middle, back = run.motions
    references = read_messages(lockstep_runs.run('motion_simulator.lua').bag, ['/reference_pose'])
    wanted = [(sent, message.pose) for sent, message in references['/reference_pose']]
    start = wanted[0][0]
    assert middle.end <= start < back.start
    # Until the program takes the robot back.
    wanted = [(sent, pose) for sent, pose in wanted if sent < start + 2.9]
    time = np.array([sent for sent, _ in run.bag['/joint_reference']])
    ways = []
    for sent, pose in wanted[:: round(0.1 * 250.0)]:
        r, _ = run.robot.direct_kinematics(run.references.position[np.searchsorted(time, sent)])
        ways.append((r[0] - 1.6, pose.position.x - 1.6))
    given, asked = np.array(ways).T
    # While the car speeds up the cabin moves forward, and the robot is some periods behind it.
    assert asked.max() > 0.02
    np.testing.assert_allclose(given, asked, atol=5e-3)


def test_all_programs_are_run_by_some_test(request: Any) -> None:
    folder = Path(request.path).parent
    tests = '\n'.join(file.read_text() for file in folder.glob('test_*.py'))
    assert not [file.name for file in PROGRAMS.glob('*.lua') if f"'{file.name}'" not in tests]
