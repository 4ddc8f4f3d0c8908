"""Robots that recorded sensors and persons guide in a simulation."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robots_controller.recording.bag_file import read_bag
from robots_controller.simulation.record import ros_messages as ros
from robots_controller.simulation.record.events import CommandStateChanged
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core import Pose, load_robot_model
from robots_core.errors import RobotsError
from robots_planning.guidance.jog_axes import JogAxes
from written_bags import BAG_START, write_bag

from .simulated_program import PERIOD, ROBOT, run_text

RATE = 50.0  # Hz, of the sensor
RADIUS, TURN = 0.05, 2.0  # m and s of the circle that it measures
SPEED, ACCELERATION = 4.0 * np.pi * RADIUS / TURN, (4.0 * np.pi / TURN) ** 2 * RADIUS  # highest, m/s, m/s^2
# The reference of a period is where the robot is at its end, and poses are extrapolated until the next one,
# with the mean speed since the one before.
BEHIND = SPEED * PERIOD + ACCELERATION / RATE**2
POSE, TWIST = 'geometry_msgs/msg/PoseStamped', 'geometry_msgs/msg/TwistStamped'
MOVE = 'ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)\n'
ROBOT_MODEL = load_robot_model(ROBOT)
READY = np.radians([0.0, -90.0, 90.0, 0.0, 90.0, 0.0])
Messages = Iterable[tuple[float, str, Any]]


def stamped(k: int) -> int:
    """Stamp of the k-th message, ns."""
    return BAG_START + round(1e9 * k / RATE)


def circle(time: float) -> Pose:
    """Where the sensor leads the tool, from where the program has moved it."""
    r, T = ROBOT_MODEL.direct_kinematics(READY)
    # It starts and ends at rest.
    angle = (
        2.0 * np.pi * (min(time / TURN, 1.0) - np.sin(2.0 * np.pi * min(time / TURN, 1.0)) / (2.0 * np.pi))
    )
    return Pose(r + RADIUS * np.array([0.0, np.sin(angle), 1.0 - np.cos(angle)]), T)


def sensor(duration: float = 2.5) -> Messages:
    for k in range(int(duration * RATE)):
        yield k / RATE, '/reference_pose', ros.BUILD.pose_stamped(stamped(k), circle(k / RATE))


def twist(stamp: int, values: Iterable[float], frame: str = 'base') -> Any:
    numbers = [
        ros.message('geometry_msgs/msg/Vector3', *map(float, part))
        for part in np.reshape(list(values), (2, 3))
    ]
    return ros.message(
        TWIST, ros.BUILD.header(stamp, frame), ros.message('geometry_msgs/msg/Twist', *numbers)
    )


def no_pose() -> Any:
    point = ros.message('geometry_msgs/msg/Point', 1.0, 0.0, 1.0)
    quaternion = ros.message('geometry_msgs/msg/Quaternion', 0.0, 0.0, 0.0, 0.0)
    return ros.message(
        POSE, ros.BUILD.header(BAG_START, 'base'), ros.message('geometry_msgs/msg/Pose', point, quaternion)
    )


def jogs(velocity: list[float], duration: float = 1.0) -> Messages:
    names = ROBOT_MODEL.axes_data.names
    for k in range(int(duration * RATE)):
        message = ros.BUILD.joint_state(stamped(k), names[::-1], np.zeros(6), np.array(velocity[::-1]))
        yield k / RATE, '/teach_joints', message


def tool_jogs(values: list[float], frame: JogAxes, duration: float = 1.0) -> Messages:
    for k in range(int(duration * RATE)):
        yield k / RATE, '/teach_twist', twist(stamped(k), values, frame)


def states(run: SimulationRun) -> list[str]:
    return [event.state for event in run.events if isinstance(event, CommandStateChanged)]


def tool_path(run: SimulationRun) -> Any:
    """Positions of the tool by the references, (k, 3) m, and their times from the hand-over, s."""
    times = [event.time for event in run.events if isinstance(event, CommandStateChanged)]
    handed_over = times[states(run).index('TRAJECTORY')]
    here = run.time >= handed_over
    return run.time[here] - handed_over, np.array(
        [ROBOT_MODEL.direct_kinematics(q)[0] for q in run.reference[here, 0]]
    )


@pytest.mark.parametrize('method', ['constrained', 'damped_least_squares', 'analytical'])
def test_the_tool_follows_the_sensor(tmp_path: Path, method: str):
    bag = write_bag(tmp_path / 'sensor', sensor())
    run = run_text(tmp_path, f'{MOVE}print(followReference(3))', references=bag, guided=method)
    assert run.ok, run.error
    assert run.printed == ('false',)
    assert states(run) == ['IDLE', 'PTPJOINT_JOINT', 'IDLE', 'TRAJECTORY', 'IDLE']
    time, r = tool_path(run)
    wanted = np.array([circle(t).r for t in time])
    assert np.linalg.norm(r - wanted, axis=1).max() < BEHIND
    assert np.ptp(r[:, 1]) == pytest.approx(2.0 * RADIUS, abs=BEHIND)
    axes = ROBOT_MODEL.axes_data
    assert (np.abs(run.reference[:, 1]) <= axes.velocity).all()
    assert (np.abs(run.reference[:, 2]) <= axes.acceleration * (1.0 + 1e-9)).all()
    assert not run.velocity[-1].any()


@pytest.mark.parametrize('method', ['constrained', 'damped_least_squares', 'analytical'])
def test_a_jump_of_the_reference_is_followed_inside_the_limits(tmp_path: Path, method: str):
    r, T = ROBOT_MODEL.direct_kinematics(READY)
    jump = Pose.from_angles(r + np.array([0.05, 0.1, -0.05]), Pose(r, T).angles() + 0.1)
    poses = (
        (k / RATE, '/reference_pose', ros.BUILD.pose_stamped(stamped(k), jump)) for k in range(int(3 * RATE))
    )
    bag = write_bag(tmp_path / 'sensor', poses)
    run = run_text(tmp_path, f'{MOVE}followReference(4)', references=bag, guided=method)
    assert run.ok, run.error
    reached = Pose(*ROBOT_MODEL.direct_kinematics(run.reference[-1, 0]))
    assert max(reached.distance_to(jump)) < 1e-5
    axes, q = ROBOT_MODEL.axes_data, run.reference[:, 0]
    within = 1.0 + 1e-5  # second differences over (4 ms)^2 round to 1e-9 rad/s^2
    assert (np.abs(np.diff(q, axis=0)) <= axes.velocity * PERIOD * within).all()
    assert (np.abs(np.diff(q, 2, axis=0)) <= axes.acceleration * PERIOD**2 * within).all()


def test_the_tool_is_led_by_twists_alone(tmp_path: Path):
    velocity = np.array([0.0, 0.05, 0.0, 0.0, 0.0, 0.0])
    twists = ((k / RATE, '/reference_twist', twist(stamped(k), velocity)) for k in range(int(2 * RATE)))
    run = run_text(
        tmp_path, f'{MOVE}print(followReference(3))', references=write_bag(tmp_path / 'sensor', twists)
    )
    assert run.ok, run.error
    time, r = tool_path(run)
    there = np.searchsorted(time, 1.0)
    np.testing.assert_allclose(
        (r[there + 100] - r[there]) / (time[there + 100] - time[there]), velocity[:3], atol=1e-4
    )
    # Two seconds of it, and the timeout until it brakes.
    assert r[-1, 1] - r[0, 1] == pytest.approx(2.2 * 0.05, abs=0.005)
    assert not run.velocity[-1].any()


@pytest.mark.parametrize('rate', [100.0, 250.0, 1000.0])
def test_any_rate_of_the_controller_does(tmp_path: Path, rate: float):
    bag = write_bag(tmp_path / 'sensor', sensor())
    run = run_text(tmp_path, f'{MOVE}followReference(3)', references=bag, rate=rate)
    time, r = tool_path(run)
    wanted = np.array([circle(t).r for t in time])
    assert np.linalg.norm(r - wanted, axis=1).max() < BEHIND + SPEED / rate


def test_an_input_takes_the_robot_back_while_it_moves(tmp_path: Path):
    bag = write_bag(tmp_path / 'sensor', sensor())
    text = f'{MOVE}setDigitalOutput(1, 1) print(followReference(10, 2)) {MOVE}'
    (tmp_path / 'plc.yaml').write_text(
        'rules: [{when: digital_output.1 rises, after: 1.0, set: {digital_input.2: 1}}]'
    )
    run = run_text(tmp_path, text, references=bag, io=tmp_path / 'plc.yaml')
    assert run.ok, run.error
    assert run.printed == ('true',)
    time, r = tool_path(run)
    half = np.searchsorted(time, 1.0)
    assert r[half, 2] == pytest.approx(circle(1.0).r[2], abs=BEHIND + 2 * SPEED * PERIOD)
    # It brakes on from there, and the next motion begins when it stands.
    assert run.motions[-1].ok
    commanded = np.searchsorted(run.time, run.motions[-1].commanded, side='right') - 1
    assert not run.reference[commanded, 1].any()


def test_axes_are_jogged(tmp_path: Path):
    bag = write_bag(tmp_path / 'jogs', jogs([0.1, 0.0, 0.0, 0.0, 0.0, -0.05]))
    run = run_text(tmp_path, f'{MOVE}print(jog(3))', references=bag)
    assert run.ok, run.error
    assert states(run)[-2:] == ['TEACH', 'IDLE']
    way = run.position[-1] - READY
    assert way[1:5] == pytest.approx(0.0, abs=1e-9)
    # From the first command until 0.1 s after the last; it brakes a little longer than it accelerates.
    assert 1.0 < way[0] / 0.1 < 1.1
    assert 1.0 < way[5] / -0.05 < 1.1


def test_a_tool_moves_straight_along_its_own_axis(tmp_path: Path):
    bag = write_bag(tmp_path / 'jogs', tool_jogs([0.0, 0.0, -0.05, 0.0, 0.0, 0.0], 'tool'))
    run = run_text(tmp_path, f'{MOVE}jog(3)', references=bag)
    assert run.ok, run.error
    r0, T0 = ROBOT_MODEL.direct_kinematics(READY)
    r, T = ROBOT_MODEL.direct_kinematics(run.reference[-1, 0])
    way = T0.T @ (r - r0)
    assert way[2] == pytest.approx(-0.05, abs=0.01)
    # Braking leaves the line by what the axes need to stop one by one from a slow jog.
    assert np.abs(way[:2]).max() < 1e-3
    np.testing.assert_allclose(T, T0, atol=5e-3)


@pytest.mark.parametrize('frame', ['base', 'tool'])
def test_the_program_s_tool_is_jogged(tmp_path: Path, frame: JogAxes):
    bag = write_bag(tmp_path / 'jogs', tool_jogs([0.0, 0.0, 0.0, 0.0, 0.0, 0.2], frame))
    text = f'setTool(0, 0.3, 0.2, 0, 0, 0)\n{MOVE}jog(3)'
    run = run_text(tmp_path, text, references=bag)
    assert run.ok, run.error
    tool = Pose([0.0, 0.3, 0.2], np.eye(3))
    flanges = [Pose(*ROBOT_MODEL.direct_kinematics(q)) for q in (READY, run.position[-1])]
    before, after = (flange @ tool for flange in flanges)
    # The flange goes around the tool; let go, each axis brakes on its own, and moves the tool a little.
    assert np.linalg.norm(flanges[1].r - flanges[0].r) > 0.05
    assert np.linalg.norm(after.r - before.r) < 0.01
    turned = before.T.T @ after.T if frame == 'tool' else after.T @ before.T.T
    assert turned[2, 2] == pytest.approx(1.0, abs=1e-4)
    assert np.arctan2(turned[1, 0], turned[0, 0]) > 0.15  # about the axis z of that frame


def test_a_bag_has_what_guided_the_robot_and_guides_it_again(tmp_path: Path):
    bag = write_bag(tmp_path / 'sensor', sensor())
    runs = []
    for name, references in (('a', bag), ('b', bag), ('c', tmp_path / 'a' / 'bag')):
        (tmp_path / name).mkdir()
        written = tmp_path / name / 'bag'
        runs.append(run_text(tmp_path, f'{MOVE}followReference(3)', references=references, bag=written))
    assert len({(tmp_path / name / 'bag' / 'bag.mcap').read_bytes() for name in 'ab'}) == 1
    found = read_bag(tmp_path / 'a' / 'bag').deserialized(
        ['/reference_pose', '/joint_trajectory', '/motion_result']
    )
    assert len(found['/reference_pose']) == 125
    assert found['/motion_result'][-1][1].message == 'the stream ended'
    assert any(len(message.points) == 1 for _, message in found['/joint_trajectory'])
    # Recorded when the cell looked, up to a period after it came.
    assert runs[2].reference[:, 0] == pytest.approx(runs[0].reference[:, 0], abs=1e-3)


def test_a_recorded_cell_guides_from_where_it_handed_its_robot_over(tmp_path: Path):
    early = [(0.0, '/guide', ros.BUILD.value('NONE')), *sensor(1.0)]
    later = [(0.5, '/guide', ros.BUILD.value('SENSOR'))]
    bag = write_bag(tmp_path / 'cell', early + later)
    run = run_text(tmp_path, f'{MOVE}followReference(2)', references=bag)
    time, r = tool_path(run)
    wanted = np.array([circle(0.5 + t).r for t in time])
    caught_up = (time > 0.3) & (time < 0.45)
    assert np.linalg.norm((r - wanted)[caught_up], axis=1).max() < 5e-3


def test_a_recorded_arc_is_no_guidance(tmp_path: Path):
    start = Pose(*ROBOT_MODEL.direct_kinematics(READY))
    poses = ([*(start.r + way), *np.degrees(start.angles())] for way in ([-0.05, 0.05, 0.0], [0.0, 0.1, 0.0]))
    arc = f'circCartesianSpace({", ".join(f"{{{str(list(map(float, pose)))[1:-1]}}}" for pose in poses)})'
    text = f'{MOVE}{arc}\n{MOVE}followReference(3)'
    runs = []
    for name, references in (('a', write_bag(tmp_path / 'sensor', sensor())), ('b', tmp_path / 'a' / 'bag')):
        (tmp_path / name).mkdir()
        runs.append(run_text(tmp_path, text, references=references, bag=tmp_path / name / 'bag'))
    assert runs[0].reference[:, 0] == pytest.approx(runs[1].reference[:, 0], abs=1e-3)


def test_a_guided_robot_stops_before_it_collides(tmp_path: Path):
    r, _ = ROBOT_MODEL.direct_kinematics(READY)
    # 12 mm beside the robot's hand, which the sensor leads 50 mm to that side.
    post = f'{{name: post, box: {{size: [0.1, 0.01, 0.1]}}, pose: {{position: [{r[0]}, 0.1, {r[2]}]}}}}'
    (tmp_path / 'scene.yaml').write_text(f'objects: [{post}]')
    bag, text = write_bag(tmp_path / 'sensor', sensor()), f'{MOVE}print(followReference(3))'
    free = run_text(tmp_path, text, references=bag)
    kept = run_text(tmp_path, text, references=bag, scene=tmp_path / 'scene.yaml', bag=tmp_path / 'bag')
    assert kept.error is not None
    assert 'stopped before a collision' in kept.error.reason  # a stop, until a person resets it
    found = read_bag(tmp_path / 'bag').deserialized(['/min_distance', '/motion_result'])
    assert 0.0 < min(message.data for _, message in found['/min_distance']) < 0.012
    assert found['/motion_result'][-1][1].message == 'stopped before a collision'
    assert np.ptp(tool_path(free)[1][:, 1]) == pytest.approx(2.0 * RADIUS, abs=BEHIND)
    assert tool_path(kept)[1][:, 1].max() < 0.012


@pytest.mark.parametrize(
    ('messages', 'reason'),
    [
        (
            [(0.0, '/other', ros.BUILD.value('x'))],
            'guides a robot: needed is one of reference_pose, .*; it holds /other',
        ),
        (
            [(0.0, '/teach_twist', twist(BAG_START, np.zeros(6), 'mars'))],
            r"message 1 of /teach_twist: frame 'mars' is unknown; tools are jogged in base, base_link, tool",
        ),
        (
            [(0.0, '/reference_pose', no_pose())],
            'message 1 of /reference_pose: the quaternion has length 0',
        ),
        (
            [(0.0, '/teach_joints', ros.BUILD.joint_state(BAG_START, ['A1'], np.zeros(1), np.zeros(1)))],
            'message 1 of /teach_joints: .*needed is one of each of A1, A2',
        ),
    ],
)  # fmt: skip
def test_recordings_that_cannot_guide_are_said(tmp_path: Path, messages: Any, reason: str):
    bag = write_bag(tmp_path / 'bag', messages)
    with pytest.raises(RobotsError, match=reason):
        run_text(tmp_path, 'followReference(1)', references=bag)


@pytest.mark.parametrize(
    ('function', 'messages', 'reason'),
    [
        ('jog', sensor(0.1), 'jog: .*sensor holds no teach_twist or teach_joints, only reference_pose'),
        (
            'followReference',
            jogs([0.1] * 6, 0.1),
            'holds no reference_pose or reference_twist, only teach_joints',
        ),
    ],
)
def test_what_a_recording_lacks_is_said_at_the_line(
    tmp_path: Path, function: str, messages: Messages, reason: str
):
    run = run_text(tmp_path, f'wait(1)\n{function}(5)', references=write_bag(tmp_path / 'sensor', messages))
    assert run.error is not None
    assert run.error.line == 2
    with pytest.raises(RobotsError, match=reason):
        raise run.error
