"""Bags of simulated cells: what they tell, the same in every run, and whole after Ctrl-C."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from robots_controller.recording.bag_file import read_bag
from robots_controller.report.run_report import run_report
from robots_controller.simulate import simulate
from robots_controller.simulation.record.events import (
    CommandStateChanged,
)
from robots_controller.simulation.simulation_run import SimulationRun
from robots_controller.testing import assert_bag_matches
from robots_core import load_robot_model
from robots_core.blocks.collision.scene_file import read_scene
from robots_core.blocks.collision_detection import CollisionDetection
from robots_core.errors import RobotsError
from written_bags import no_file_larger_than

from .simulated_program import PERIOD, PROGRAMS, ROBOT, run_text


@pytest.fixture(scope='module')
def welding() -> SimulationRun:
    return simulate(PROGRAMS / 'welding.lua', robot=ROBOT, drive='ideal')


def test_a_bag_contains_the_same_as_the_run(tmp_path: Path, welding: SimulationRun):
    run = simulate(PROGRAMS / 'welding.lua', robot=ROBOT, drive='ideal', bag=tmp_path / 'bag')
    bag = read_bag(tmp_path / 'bag')
    assert not bag.problem
    topics = ['/joint_reference', '/joint_states', '/digital_outputs', '/command_state', '/motion_result']
    messages = bag.deserialized(topics)
    start = messages['/joint_reference'][0][0]
    times = [1e-9 * (stamp - start) for stamp, _ in messages['/joint_reference']]
    assert times == pytest.approx(run.time.tolist(), abs=1e-9)
    references = [message.points[0].positions for _, message in messages['/joint_reference']]
    assert np.array_equal(references, run.reference[:, 0])
    assert np.array_equal([message.position for _, message in messages['/joint_states']], run.position)
    assert [message.data[0] for _, message in messages['/digital_outputs']] == [0, 1, 0]
    assert [message.data for _, message in messages['/command_state']] == [
        event.state for event in run.events if isinstance(event, CommandStateChanged)
    ]
    assert len(messages['/motion_result']) == len(run.motions)
    # And writing one changes nothing of what happens.
    assert np.array_equal(run.reference, welding.reference)
    assert run.events == welding.events


def test_a_bag_contains_how_close_the_robot_came(tmp_path: Path):
    scene = PROGRAMS / 'scenes' / 'car_frame.yaml'
    simulate(
        PROGRAMS / 'welding_around_pillar.lua', robot=ROBOT, drive='ideal', scene=scene, bag=tmp_path / 'bag'
    )
    found = read_bag(tmp_path / 'bag').deserialized(['/min_distance', '/collision_status', '/joint_states'])
    distances = np.array([message.data for _, message in found['/min_distance']])
    statuses = [
        {pair.key: pair.value for pair in message.values} for _, message in found['/collision_status']
    ]
    assert [float(values['distance']) for values in statuses] == distances.tolist()
    # Planned motions keep the margin; the robot passes the pillar with not much more.
    assert 0.005 <= distances.min() < 0.2
    robot = load_robot_model(ROBOT)
    detection = CollisionDetection(robot)
    detection.set_scene(read_scene(scene))
    states = {stamp: message.position for stamp, message in found['/joint_states']}
    for (stamp, message), values in list(zip(found['/min_distance'], statuses, strict=True))[::20]:
        closest = detection.distance(states[stamp])
        assert closest is not None
        assert message.data == closest.distance
        assert (values['first'], values['second']) == (closest.first, closest.second)


def test_the_table_of_the_demo_is_made_of_a_simulated_bag_too(tmp_path: Path):
    run = simulate(PROGRAMS / 'welding.lua', robot=ROBOT, drive='second_order', bag=tmp_path / 'bag')
    assert run.bag is not None
    report = run_report(run.bag, robot=ROBOT)
    assert report.ok
    assert [item.motion.line for item in report.motions] == [6, 7, 8, 12]


@pytest.mark.parametrize(
    ('limits', 'changed'),
    [
        ('setSpeed(0.3)', 'setSpeed(0.297)'),
        ('setSpeed(1, 0.3)', 'setSpeed(1, 0.297)'),
        ('setAcceleration(0.5)', 'setAcceleration(0.495)'),
        ('setAcceleration(1, 1)', 'setAcceleration(1, 0.99)'),
    ],
)
def test_a_limit_that_is_changed_by_a_percent_is_found_in_the_bag(tmp_path: Path, limits: str, changed: str):
    motions = 'ptpJointSpaceAngles(40, -90, 90, 0, 90, 0) linearRelative(0, 0, -0.5, 0, 0, 0)'
    for name, line in (('expected', limits), ('same', limits), ('other', changed)):
        run_text(tmp_path, f'{line} {motions}', bag=tmp_path / name)
    (tmp_path / 'tolerances.yaml').write_text(
        "ignore: ['*']\ntopics: {joint_reference: {mode: samples, time: 0.002, absolute: 1.0e-6}}"
    )
    assert_bag_matches(tmp_path / 'same', tmp_path / 'expected', tmp_path / 'tolerances.yaml')
    with pytest.raises(AssertionError, match='/joint_reference at'):
        assert_bag_matches(tmp_path / 'other', tmp_path / 'expected', tmp_path / 'tolerances.yaml')


def test_a_bag_needs_a_folder_of_its_own(tmp_path: Path):
    with pytest.raises(RobotsError, match='exists already'):
        run_text(tmp_path, 'wait(1)', bag=tmp_path)


@pytest.mark.parametrize('text', ['wait(60)', 'for n = 1, 9e9 do print(n) end'])
def test_a_full_disk_is_reported_without_a_traceback_and_the_bag_ends_whole(tmp_path: Path, text: str):
    bag = tmp_path / 'bag'
    with (
        no_file_larger_than(1_500_000),
        pytest.raises(RobotsError, match='bag cannot take more: File too'),
    ):
        run_text(tmp_path, text, bag=bag)
    assert read_bag(bag).problem == ''
    assert (bag / 'bag.mcap').stat().st_size > 400_000


def test_two_processes_write_the_same_bag_to_the_last_bit_and_need_no_ros(tmp_path: Path):
    code = (
        'import sys; from robots_controller.simulate import simulate; '
        f"simulate(sys.argv[1], robot='{ROBOT}', io=sys.argv[2], bag=sys.argv[3], longest=5.0); "
        "sys.exit('rclpy' in sys.modules)"
    )
    program, io = PROGRAMS / 'press_tending.lua', PROGRAMS / 'io' / 'press_tending.yaml'
    bags = [tmp_path / name / 'bag' for name in ('here', 'there')]
    simulate(program, robot=ROBOT, io=io, bag=bags[0], longest=5.0)
    subprocess.run(
        [sys.executable, '-c', code, str(program), str(io), str(bags[1])],
        # Where sets have another order.
        env={**os.environ, 'PYTHONHASHSEED': '2' if os.environ.get('PYTHONHASHSEED') == '1' else '1'},
        cwd=tmp_path,
        check=True,
    )
    for name in ('bag.mcap', 'metadata.yaml'):
        first, second = ((bag / name).read_bytes() for bag in bags)
        assert first == second
    assert len(read_bag(bags[0]).messages) > 2 * 5.0 / PERIOD


def test_ctrl_c_leaves_a_bag_that_can_be_read(tmp_path: Path):
    def interrupt(now: float, _line: int) -> None:
        if now > 4.0:
            signal.raise_signal(signal.SIGINT)

    before = signal.getsignal(signal.SIGINT)
    run = simulate(
        PROGRAMS / 'welding.lua', robot=ROBOT, drive='ideal', bag=tmp_path / 'bag', on_progress=interrupt
    )
    assert run.interrupted
    assert run.state == 'STOPPED'
    assert 4.0 < run.time[-1] < 4.1
    bag = read_bag(tmp_path / 'bag')
    assert not bag.problem
    assert sum(topic == '/joint_reference' for topic, _, _ in bag.messages) == run.time.size
    assert signal.getsignal(signal.SIGINT) is before


def test_ctrl_c_reaches_a_program_that_computes_for_ever(tmp_path: Path):
    program = tmp_path / 'program.lua'
    program.write_text('wait(0.1)\nwhile true do end')
    code = (
        'import os, signal, sys, threading; from robots_controller.simulate import simulate\n'
        'def watch(now, line):\n'
        '    if not timers:\n'
        '        timers.append(threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)))\n'
        '        timers[0].start()\n'
        'timers = []\n'
        "run = simulate(sys.argv[1], robot='bello_bot', on_progress=watch)\n"
        'sys.exit(not run.interrupted)'
    )
    subprocess.run([sys.executable, '-c', code, str(program)], cwd=tmp_path, check=True, timeout=240.0)
