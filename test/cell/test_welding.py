"""The welding program, from one command to its recorded bag (paper, section 4.4 and figure 9)."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.rosbag2 import Reader

from cell_options import nodes_of_cell
from robots_controller.report.run_report import run_report
from robots_core import Pose, load_robot_model
from short_programs import PROGRAMS

from .bag_checks import changes, check_references, read_messages, reference_trajectory
from .lockstep_runs import LockstepRun, LockstepRuns

ROBOT = 'kuka_kr210_r2700'
TOPICS = (
    '/command_state',
    '/digital_outputs',
    '/joint_reference',
    '/joint_states',
    '/joint_trajectory',
    '/motion_progress',
    '/motion_result',
    '/program_status',
    '/ptpcartesian',
    '/ptpjoint_joint',
    '/robot_description',
    '/tcp_pose',
)


@pytest.fixture(scope='module')
def cell(lockstep_runs: LockstepRuns) -> LockstepRun:
    """The demo, which has run."""
    return lockstep_runs.run('welding.lua')


@pytest.fixture(scope='module')
def bag(cell: LockstepRun) -> dict[str, list[tuple[float, Any]]]:
    return read_messages(cell.bag, TOPICS)


def test_the_program_finishes(cell: LockstepRun) -> None:
    assert cell.returncode == 0, cell.text


def test_shows_every_line_every_motion_and_the_table(cell: LockstepRun) -> None:
    program = (PROGRAMS / 'welding.lua').read_text().splitlines()
    shown = [line for line in program if line and not line.startswith('--')]
    position = 0
    for line in shown:  # in the program's order
        found = cell.text.find(line, position)
        assert found >= 0, f'{line!r} is not shown in order:\n{cell.text}'
        position = found
    assert 'Welding Program 1' in cell.text
    assert cell.text.count('PTPCARTESIAN to (0.37') == 3
    assert cell.text.count('reached after') == 4
    assert 'digital output 1 -> 1' in cell.text
    assert 'every target reached, every limit kept' in cell.text


def test_the_bag_holds_all_topics_as_mcap(cell: LockstepRun) -> None:
    with Reader(cell.bag) as reader:
        assert {connection.topic for connection in reader.connections} >= set(TOPICS)
    assert (cell.bag / 'metadata.yaml').is_file()
    assert [file.suffix for file in cell.bag.iterdir() if file.suffix != '.yaml'] == ['.mcap']


def test_the_documentation_lists_the_topics(cell: LockstepRun) -> None:
    page = (PROGRAMS.parent / 'docs' / 'reference' / 'topics.md').read_text()
    table = page[page.index('## Topics') : page.index('## Services')]
    rows = [line.split('|')[1:-1] for line in table.splitlines() if line.startswith('| `')]
    listed = {name for row in rows for name in re.findall(r'`([^`]+)`', row[0])}
    running = {node.executable for node in nodes_of_cell(robot=ROBOT)}
    from_nodes = {
        name
        for row in rows
        if running & set(re.findall(r'(?<!in orbit )\b\w+_node\b(?!, in orbit)', row[2]))
        for name in re.findall(r'`([^`]+)`', row[0])
    }
    with Reader(cell.bag) as reader:
        recorded = {connection.topic for connection in reader.connections}
    ros_own = {'/rosout', '/parameter_events', '/tf', '/tf_static'}
    assert {topic.removeprefix('/') for topic in recorded - ros_own - {'/diagnostics'}} <= listed
    # This cell has no zones to claim, and frames are published only where tf2_msgs is installed.
    assert {f'/{name}' for name in from_nodes - {'trigger', 'zone_claims', '/tf', '/tf_static'}} <= recorded


def test_command_states_alternate_between_idle_and_motion(bag: dict[str, Any]) -> None:
    states = [message.data for _, message in bag['/command_state']]
    assert states == [
        'IDLE',
        'PTPJOINT_JOINT', 'IDLE',
        'PTPCARTESIAN', 'IDLE',
        'PTPCARTESIAN', 'IDLE',
        'PTPCARTESIAN', 'IDLE',
    ]  # fmt: skip


def test_the_welding_gun_switches_between_the_motions(bag: dict[str, Any]) -> None:
    switched = changes(bag, 'digital_outputs')
    assert [(index, value) for _, index, value in switched] == [(1, 1.0), (1, 0.0)]
    ends = [time for time, _ in bag['/motion_result']]
    starts = [time for topic in ('/ptpjoint_joint', '/ptpcartesian') for time, _ in bag[topic]]
    on, off = (time for time, *_ in switched)
    assert ends[2] < on < off < sorted(starts)[3]
    assert off - on == pytest.approx(1.0, abs=1e-6)  # wait(1); messages of one instant are nanoseconds apart


def test_references_keep_all_limits(bag: dict[str, Any]) -> None:
    check_references(bag, load_robot_model(ROBOT))


def test_cartesian_motions_stay_on_their_lines(bag: dict[str, Any]) -> None:
    robot = load_robot_model(ROBOT)
    results = [time for time, _ in bag['/motion_result']]
    for number, (_, command) in enumerate(bag['/ptpcartesian'], 1):
        start, end = bag['/joint_trajectory'][number][0], results[number]
        references = [message for time, message in bag['/joint_reference'] if start <= time <= end]
        trajectory = reference_trajectory(references)
        q = trajectory.sample(np.arange(0.0, trajectory.duration, 1e-3))[0]
        r = np.array([robot.direct_kinematics(row)[0] for row in q])
        p = command.pose.position
        target = np.array([p.x, p.y, p.z])
        direction = (target - r[0]) / np.linalg.norm(target - r[0])
        away = r - r[0]
        distance = np.linalg.norm(away - np.outer(away @ direction, direction), axis=1)
        assert distance.max() <= 1e-4
        assert np.linalg.norm(r[-1] - target) <= 1e-4


def test_the_robot_stands_at_every_target(cell: LockstepRun, bag: dict[str, Any]) -> None:
    report = run_report(cell.bag, robot=ROBOT)
    assert report.ok
    assert [item.motion.kind.title for item in report.motions] == ['PTPJOINT_JOINT'] + 3 * ['PTPCARTESIAN']
    assert [item.motion.line for item in report.motions] == [6, 7, 8, 12]
    robot = load_robot_model(ROBOT)
    last = bag['/joint_states'][-1][1]
    stood = Pose(*robot.direct_kinematics(np.array(last.position)))
    # The listing's last target, with KUKA's A, B, C.
    angles = np.radians([-42.03, 117.47, -35.89])
    position, orientation = stood.distance_to(Pose.from_angles([0.375, -1.78, 1.21], angles, 'zyx'))
    assert position <= 1e-4
    assert orientation <= np.radians(0.01)


def test_every_node_left_its_log(cell: LockstepRun) -> None:
    logs = {file.name for file in Path(cell.bag.parent, 'log').iterdir()}
    assert 'controller_node.log' in logs
    assert 'Traceback' not in ''.join(Path(cell.bag.parent, 'log', name).read_text() for name in logs)
