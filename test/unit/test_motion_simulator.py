"""The motion simulator: its manoeuvre, its bag, and what its robot makes of it."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise, product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motion_simulator.cabin import (
    ENVELOPE,
    FLANGE_IN_MIDDLE,
    HEAD_IN_FLANGE,
    HEAD_IN_MIDDLE,
    RATE,
    ROBOT,
    SETTINGS,
    cue,
    flange,
    flange_twist,
    head,
)
from motion_simulator.double_lane_change import DoubleLaneChange
from motion_simulator.recorded_cabin import RecordedCabin, read_cabin
from motion_simulator.references import (
    GAP,
    IMU,
    POSE,
    TWIST,
    VehicleRecording,
    lane_change,
    reasons,
    recorded,
    write,
)
from robots_controller.commands.command_table import CHECK_PROGRAM
from robots_controller.program.program_header import read_program_header
from robots_controller.recording.bag_file import read_bag
from robots_controller.simulate import simulate
from robots_core import Pose, load_robot_model
from robots_core.blocks import VehicleMotion
from robots_core.errors import RobotsError
from written_bags import BAG_TYPES, write_bag

from .simulated_program import PROGRAMS

PROGRAM = PROGRAMS / 'motion_simulator.lua'
BAG = PROGRAMS / 'motion_simulator' / 'double_lane_change'
G = 9.80665
T = BAG_TYPES.types


def lateral_acceleration(x: float, speed: float) -> float:
    """Of a point that keeps its speed along the road: the path's second derivative by hand."""
    total = 0.0
    for sign, height, width, start in ((1.0, 4.05, 25.0, 27.19), (-1.0, 5.7, 21.95, 56.46)):
        k = 2.4 / width
        z = k * (x - start) - 1.2
        total += sign * 0.5 * height * k**2 * -2.0 * np.tanh(z) / np.cosh(z) ** 2
    return float(total * speed**2)


def test_the_car_feels_what_its_path_says() -> None:
    car = DoubleLaneChange()
    for x in (10.0, 25.0, 42.0, 55.0, 70.0):
        time = car.rest + car.speeding_up + x / car.speed
        motion = car.motion(time)
        # Seen along the road, whatever the heading and the leaning are.
        across = lateral_acceleration(x, car.speed)
        assert np.linalg.norm(motion.specific_force) == pytest.approx(np.hypot(G, across), abs=1e-4)
    for time in (0.0, car.duration):
        np.testing.assert_allclose(car.motion(time).specific_force, [0.0, 0.0, G], atol=1e-9)
        np.testing.assert_allclose(car.motion(time).angular_velocity, 0.0, atol=1e-9)


def test_the_car_turns_as_its_path_does() -> None:
    car = DoubleLaneChange()
    times = np.arange(0.0, car.duration, 0.01)
    yaw = sum(car.motion(time).angular_velocity[2] for time in times) * 0.01
    assert yaw == pytest.approx(0.0, abs=1e-3)  # along the road at both ends
    forward = sum(car.motion(time).specific_force[0] for time in times) * 0.01
    assert forward == pytest.approx(0.0, abs=0.2)  # at rest at both ends; it leans and turns in between


def test_head_and_flange_are_where_they_belong() -> None:
    step = cue([VehicleMotion.at_rest()])[0]
    assert flange(step).distance_to(FLANGE_IN_MIDDLE) == pytest.approx((0.0, 0.0), abs=1e-12)
    assert head(flange(step)).distance_to(step.pose) == pytest.approx((0.0, 0.0), abs=1e-12)
    np.testing.assert_array_equal(flange_twist(step), 0.0)
    np.testing.assert_allclose(HEAD_IN_MIDDLE.T, np.eye(3), atol=1e-12)


def test_the_twist_of_the_flange_is_how_its_pose_moves() -> None:
    motion = VehicleMotion(np.array([1.0, -2.0, G + 1.0]), np.array([0.3, -0.2, 0.4]))
    steps = cue([motion] * 200)[50:]
    poses = [flange(step) for step in steps]
    moved = [one.error_to(other) * RATE for one, other in pairwise(poses)]
    # Within a period a velocity changes by its acceleration; the flange is 0.8 m from the head.
    most = 2.0 * max(ENVELOPE.acceleration) / RATE
    np.testing.assert_allclose([flange_twist(step) for step in steps[1:]], moved, atol=most)


def test_the_robot_reaches_its_envelope_in_one_configuration() -> None:
    robot = load_robot_model(ROBOT)
    middle = robot.inverse_kinematics_analytic(FLANGE_IN_MIDDLE.r, FLANGE_IN_MIDDLE.T)
    q = middle[np.abs(middle).max(axis=1).argmin()]
    for signs in product([-1.0, 0.0, 1.0], repeat=6):
        way = np.array(ENVELOPE.reach) * signs
        place = HEAD_IN_MIDDLE @ Pose.from_angles(way[:3], way[:2:-1]) @ HEAD_IN_FLANGE.inverse()
        found = robot.inverse_kinematics_analytic(place.r, place.T)
        assert len(found), f'{way} is out of reach'
        # Another configuration turns an axis by more than half a turn.
        assert np.abs(found - q).max(axis=1).min() < np.pi / 2.0


def test_the_recording_of_the_program_is_that_of_the_generator() -> None:
    assert Path(read_program_header(PROGRAM).references).resolve() == BAG
    made, kept = lane_change(), recorded(BAG)
    np.testing.assert_allclose(kept.time, made.time, atol=1e-9)
    for field in ('specific_force', 'angular_velocity'):
        here, there = ([getattr(motion, field) for motion in found.motions] for found in (kept, made))
        np.testing.assert_allclose(here, there, atol=1e-6)
    steps = cue(kept.sampled())
    messages = read_bag(BAG).deserialized([POSE])[POSE]
    assert len(messages) == len(steps)
    # Rounded to single precision, of up to 2 m.
    for (_, message), step in list(zip(messages, steps, strict=True))[::50]:
        p, o = message.pose.position, message.pose.orientation
        pose = Pose.from_quaternion([p.x, p.y, p.z], [o.x, o.y, o.z, o.w])
        assert pose.distance_to(flange(step)) == pytest.approx((0.0, 0.0), abs=1e-6)


def test_the_manoeuvre_stays_inside_the_envelope() -> None:
    steps = cue(recorded(BAG).sampled())
    assert not [reason for reason in reasons(steps) if 'beyond' in reason or reason.startswith('no motion')]
    used = np.abs([step.cabin[0] for step in steps]).max(axis=0) / ENVELOPE.reach
    assert used.max() < 1.0


def imu(time: float, force: list[float]) -> tuple[float, str, Any]:
    vector, quaternion = T['geometry_msgs/msg/Vector3'], T['geometry_msgs/msg/Quaternion']
    stamp = T['builtin_interfaces/msg/Time'](*divmod(round(1e9 * time), 1_000_000_000))
    header, none = T['std_msgs/msg/Header'](stamp, 'car'), np.zeros(9)
    message = T['sensor_msgs/msg/Imu'](
        header, quaternion(0.0, 0.0, 0.0, 1.0), none, vector(0.0, 0.0, 0.1), none, vector(*force), none
    )
    return time, '/car/imu', message


def test_a_recorded_motion_of_any_rate_is_cued(tmp_path: Path) -> None:
    samples = [imu(k / 30.0, [k / 30.0, 0.0, G]) for k in range(60)]
    found = recorded(write_bag(tmp_path / 'car', samples), '/car/imu')
    motions = found.sampled()
    forces = [motion.specific_force[0] for motion in motions if motion is not None]
    assert len(forces) == len(motions)
    np.testing.assert_allclose(forces, np.arange(len(motions)) / RATE, atol=1e-6)
    steps = cue(motions)
    write(tmp_path / 'made', found, steps)
    assert len(read_bag(tmp_path / 'made').deserialized([POSE])[POSE]) == len(steps)
    assert len(recorded(tmp_path / 'made').motions) == 60


def test_gaps_of_a_recording_bring_the_cabin_to_rest() -> None:
    time = np.array([0.0, 0.05, 0.1, 4.0, 4.05])
    force = VehicleMotion(np.array([1.0, 0.0, G]), np.zeros(3))
    motions = VehicleRecording(time, [force] * 5).sampled()
    missing = [motion is None for motion in motions]
    assert missing.count(True) == pytest.approx((4.0 - 0.1) * RATE, abs=1.0)
    assert max(np.diff(time)[np.diff(time) <= GAP]) < GAP
    steps = cue(motions)
    assert any(reason.startswith('no motion of the vehicle') for reason in reasons(steps))
    assert np.linalg.norm(steps[-30].wanted.specific_force - [0.0, 0.0, G]) < 0.05


@pytest.mark.parametrize(
    ('messages', 'topic', 'reason'),
    [
        ([imu(0.0, [0.0, 0.0, G])], '/car/imu', 'has 1 messages; needed are 2 or more with increasing'),
        ([imu(0.0, [0.0, 0.0, G])], '/imu', '/imu must be .*Imu, found is nothing; it holds /car/imu'),
        (
            [imu(0.0, [0.0, 0.0, G]), imu(0.1, [np.nan, 0.0, G])],
            '/car/imu',
            r'message 2 of /car/imu: specific_force\[0\] is nan',
        ),
    ],
)  # fmt: skip
def test_recordings_that_cannot_be_cued_are_refused(
    tmp_path: Path, messages: Any, topic: str, reason: str
) -> None:
    with pytest.raises(RobotsError, match=reason):
        recorded(write_bag(tmp_path / 'car', messages), topic)


@pytest.fixture(scope='module')
def guided(tmp_path_factory: pytest.TempPathFactory) -> RecordedCabin:
    bag = tmp_path_factory.mktemp('run') / 'bag'
    run = simulate(PROGRAM, robot=ROBOT, references=BAG, drive='ideal', bag=bag)
    assert run.ok, run.error
    assert [motion.ok for motion in run.motions] == [True, True]
    return read_cabin(bag, BAG)


def test_the_robot_follows_inside_its_limits(guided: RecordedCabin) -> None:
    axes = guided.robot.axes_data
    q, q_dot, q_ddot = guided.reference
    assert ((q >= axes.lower) & (q <= axes.upper)).all()
    assert (np.abs(q_dot) <= axes.velocity).all()
    assert (np.abs(q_ddot) <= axes.acceleration * (1.0 + 1e-9)).all()
    position, angle = guided.tracking()
    # At up to 1 m/s, periods of 4 ms and the controller's moving average make the robot late.
    assert position.max() < 0.02
    assert angle.max() < 0.01
    assert (np.abs(guided.cabin()) <= np.array(ENVELOPE.reach)).all()


def test_the_person_feels_what_the_cueing_gives(guided: RecordedCabin) -> None:
    felt = np.array([motion.specific_force for motion in guided.felt()])
    given = np.array([step.felt.specific_force for step in guided.steps])
    there = np.column_stack([np.interp(guided.drive_time, guided.time, column) for column in given.T])
    # But for a delay of some periods and the corners of the rate-limited tilt.
    assert np.sqrt(((felt - there) ** 2).mean(axis=0)).max() < 0.05
    wanted = np.array([step.wanted.specific_force for step in guided.steps])
    for axis in (0, 1):
        there = np.interp(guided.drive_time, guided.time, wanted[:, axis])
        assert np.corrcoef(felt[:, axis], there)[0, 1] > 0.7


def test_a_manoeuvre_beyond_the_envelope_that_breaks_off_keeps_all_limits(tmp_path: Path) -> None:
    motions = recorded(BAG).sampled()[: round(13.5 * RATE)]  # to where the cabin is fastest
    unscaled = replace(SETTINGS, force_scale=(1.0,) * 3, rate_scale=(1.0,) * 3)
    steps = cue(motions, unscaled)
    assert any(reason.startswith('sway of') for reason in reasons(steps))
    assert (np.abs([step.cabin[0] for step in steps]) <= np.array(ENVELOPE.reach) + 1e-12).all()
    write(tmp_path / 'cut', VehicleRecording(np.zeros(0), []), steps)
    program = tmp_path / 'program.lua'
    program.write_text(PROGRAM.read_text().replace('TIME = 26', 'TIME = 20.5'))
    run = simulate(program, robot=ROBOT, references=tmp_path / 'cut', drive='ideal')
    assert run.ok, run.error
    axes, (q, q_dot, q_ddot) = load_robot_model(ROBOT).axes_data, np.moveaxis(run.reference, 1, 0)
    assert ((q >= axes.lower) & (q <= axes.upper)).all()
    assert (np.abs(q_dot) <= axes.velocity).all()
    assert (np.abs(q_ddot) <= axes.acceleration * (1.0 + 1e-9)).all()
    # Poses end 7 s before the program takes the robot back. The slowest axis brakes with 0.4 rad/s^2 from
    # 2.3 rad/s at most: it stands after 6 s.
    since_poses = run.time - (run.motions[-1].commanded - 7.0)
    assert q_dot[np.searchsorted(since_poses, 0.0)].any()
    assert not q_dot[(since_poses > 6.0) & (since_poses < 6.9)].any()


def test_a_run_that_was_not_guided_is_refused(tmp_path: Path) -> None:
    program = tmp_path / 'still.lua'
    program.write_text('wait(0.1)\n')
    simulate(program, robot=ROBOT, bag=tmp_path / 'bag')
    with pytest.raises(RobotsError, match='holds no /reference_pose: the robot was not guided'):
        read_cabin(tmp_path / 'bag', BAG)


def test_the_program_of_the_cockpit_reads_well(capsys: pytest.CaptureFixture[str]) -> None:
    assert CHECK_PROGRAM.run([str(PROGRAMS / 'motion_simulator' / 'cockpit.lua')]) == 0, (
        capsys.readouterr().out
    )


def test_the_recording_names_its_topics() -> None:
    assert {IMU, POSE, TWIST} == set(read_bag(BAG).topics)
