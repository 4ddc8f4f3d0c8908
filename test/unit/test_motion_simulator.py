"""The motion simulator: its manoeuvre, its bag, and what its robots make of it."""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from guiding_messages import car_header, joy
from motion_simulator.double_lane_change import DoubleLaneChange
from motion_simulator.recorded_cabin import RecordedCabin, read_recorded_cabin, reasons
from motion_simulator.references import IMU_RATE, VehicleRecording, lane_change, recorded, write
from robots_controller.commands.command_table import CHECK_PROGRAM
from robots_controller.program.files.program_header import read_program_header
from robots_controller.recording.bag_file import read_bag
from robots_controller.simulate import simulate
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.blocks import Cockpit, read_cabin
from robots_core.errors import RobotsError
from written_bags import BAG_TYPES, write_bag

from .simulated_program import PROGRAMS

PROGRAM = PROGRAMS / 'motion_simulator.lua'
FOLDER = PROGRAMS / 'motion_simulator'
ON_AXIS, BAG, CABIN = FOLDER / 'on_linear_axis.lua', FOLDER / 'double_lane_change', FOLDER / 'cabin.yaml'
ROBOT, SLIDING = 'kuka_kr500_r2830', 'kuka_kr500_linear_axis'
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
    motions = [car.motion(time) for time in times]
    yaw = sum(motion.angular_velocity[2] for motion in motions) * 0.01
    assert yaw == pytest.approx(0.0, abs=1e-3)  # along the road at both ends
    forward = sum(motion.specific_force[0] for motion in motions) * 0.01
    assert forward == pytest.approx(0.0, abs=0.2)  # at rest at both ends; it leans and turns in between


def test_the_robot_reaches_its_envelope_in_one_configuration() -> None:
    robot, cabin = load_robot_model(ROBOT), read_cabin(CABIN)
    middle = robot.inverse_kinematics_analytic(cabin.flange.r, cabin.flange.T)
    q = middle[np.abs(middle).max(axis=1).argmin()]
    for signs in product([-1.0, 0.0, 1.0], repeat=6):
        way = np.array(cabin.envelope.reach) * signs
        head = Pose.from_angles(way[:3], way[:2:-1])
        place = cabin.flange @ cabin.head @ head @ cabin.head.inverse()
        found = robot.inverse_kinematics_analytic(place.r, place.T)
        assert len(found), f'{way} is out of reach'
        # Another configuration turns an axis by more than half a turn.
        assert np.abs(found - q).max(axis=1).min() < np.pi / 2.0


def test_the_programs_name_what_moves_their_robots(capsys: pytest.CaptureFixture[str]) -> None:
    for program, robot, cabin in (
        (PROGRAM, ROBOT, CABIN),
        (ON_AXIS, SLIDING, FOLDER / 'cabin_on_axis.yaml'),
    ):
        header = read_program_header(program)
        assert (header.robot, Path(header.cabin), Path(header.references)) == (robot, cabin, BAG)
    for program in (ON_AXIS, FOLDER / 'cockpit.lua'):
        assert CHECK_PROGRAM.run([str(program)]) == 0, capsys.readouterr().out


@pytest.fixture(scope='module')
def kept() -> VehicleRecording:
    """The recording of the programs."""
    return recorded(BAG)


def test_the_recording_of_the_programs_is_that_of_the_generator(kept: VehicleRecording) -> None:
    made = lane_change()
    assert list(read_bag(BAG).topics) == ['/vehicle_imu']
    np.testing.assert_allclose(kept.time, made.time, atol=1e-9)
    for field in ('specific_force', 'angular_velocity'):
        here, there = ([getattr(motion, field) for motion in found.motions] for found in (kept, made))
        np.testing.assert_allclose(here, there, atol=1e-6)


@pytest.mark.parametrize('cabin', ['cabin.yaml', 'cabin_on_axis.yaml'])
def test_the_manoeuvre_stays_inside_the_envelope(cabin: str, kept: VehicleRecording) -> None:
    cockpit = Cockpit(read_cabin(FOLDER / cabin), 1.0 / IMU_RATE)
    steps = []
    for motion in kept.motions:
        cockpit.take(motion)
        steps.append(cockpit.step())
    assert not [reason for reason in reasons(steps) if 'beyond' in reason or reason.startswith('no motion')]
    used = np.abs([step.cabin[0] for step in steps]).max(axis=0) / cockpit.cabin.envelope.reach
    assert used.max() < 1.0


def imu(time: float, force: list[float]) -> tuple[float, str, Any]:
    vector, quaternion, none = T['geometry_msgs/msg/Vector3'], T['geometry_msgs/msg/Quaternion'], np.zeros(9)
    level = quaternion(0.0, 0.0, 0.0, 1.0)
    message = T['sensor_msgs/msg/Imu'](
        car_header(time), level, none, vector(0.0, 0.0, 0.1), none, vector(*force), none
    )
    return time, '/car/imu', message


def test_a_recorded_motion_of_any_topic_is_taken(tmp_path: Path) -> None:
    samples = [imu(k / 30.0, [k / 30.0, 0.0, G]) for k in range(60)]
    found = recorded(write_bag(tmp_path / 'car', samples), '/car/imu')
    write(tmp_path / 'made', found)
    again = recorded(tmp_path / 'made')
    np.testing.assert_allclose(again.time, found.time)
    forces = [motion.specific_force[0] for motion in again.motions]
    np.testing.assert_allclose(forces, again.time, atol=1e-6)


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


def simulated(folder: Path, program: Path, inputs: list[Any], time: float, cabin: str = '') -> SimulationRun:
    """Simulate a program that is guided for a time, in s, by other inputs, with its own cabin or another."""
    text = program.read_text()
    assert 'TIME = 26' in text
    path = folder / 'program.lua'
    path.write_text(text.replace('TIME = 26', f'TIME = {time}'))
    references = write_bag(folder / 'inputs', inputs)
    header = read_program_header(program)
    return simulate(
        path,
        robot=header.robot,
        cabin=cabin or header.cabin,
        references=references,
        drive='ideal',
        bag=folder / 'bag',
    )


def check_limits(robot: BaseRobotModel, rows: Any) -> None:
    """Of positions, velocities and accelerations, (3, m, n)."""
    axes, (q, q_dot, q_ddot) = robot.axes_data, rows
    assert ((q >= axes.lower) & (q <= axes.upper)).all()
    assert (np.abs(q_dot) <= axes.velocity).all()
    assert (np.abs(q_ddot) <= axes.acceleration * (1.0 + 1e-9)).all()


@pytest.fixture(scope='module')
def driven(tmp_path_factory: pytest.TempPathFactory) -> RecordedCabin:
    """A person who speeds up around a curve and brakes, on the linear axis; then the signal stops."""
    folder = tmp_path_factory.mktemp('run')
    inputs = [joy(0.05 * k, 0.15 if k > 20 else 0.0, 1.0 if k < 50 else -0.6) for k in range(70)]
    run = simulated(folder, ON_AXIS, inputs, 5.2)
    assert run.ok, run.error
    assert [motion.ok for motion in run.motions] == [True, True]
    cabin = FOLDER / 'cabin_on_axis.yaml'
    return read_recorded_cabin(folder / 'bag', robot=SLIDING, cabin=cabin)


def test_a_driven_cabin_is_followed_inside_all_limits(driven: RecordedCabin) -> None:
    check_limits(driven.robot, driven.reference)
    position, angle = driven.tracking()
    # At up to 1 m/s, periods of 4 ms and the controller's moving average make the robot late.
    assert position.max() < 0.02
    assert angle.max() < 0.01
    ways = driven.ways()
    assert (np.abs(ways) <= np.array(driven.cabin.envelope.reach)).all()
    # The axis that the pose does not need takes its part of the way, in its direction.
    slid = driven.drives[0, :, 0] - driven.drives[0, 0, 0]
    assert np.ptp(slid) > 0.3 * np.ptp(ways[:, 0])
    assert np.corrcoef(slid, ways[:, 0])[0, 1] > 0.95


def test_the_person_feels_what_the_cueing_gives(driven: RecordedCabin) -> None:
    felt = np.array([motion.specific_force for motion in driven.felt()])
    given, wanted = (
        np.array([getattr(step, name).specific_force for step in driven.steps]) for name in ('felt', 'wanted')
    )
    there = np.column_stack([np.interp(driven.drive_time, driven.time, column) for column in given.T])
    # But for a delay of some periods and the corners of the rate-limited tilt.
    assert np.sqrt(((felt - there) ** 2).mean(axis=0)).max() < 0.05
    for axis in (0, 1):
        there = np.interp(driven.drive_time, driven.time, wanted[:, axis])
        assert np.corrcoef(felt[:, axis], there)[0, 1] > 0.7


def test_the_cabin_comes_to_rest_when_its_driver_falls_silent(driven: RecordedCabin) -> None:
    assert any('no motion of the vehicle' in limit for limit in driven.steps[-1].limits)
    assert abs(driven.steps[-1].wanted.specific_force[:2]).max() < 1e-9
    speed = np.abs([step.cabin[1] for step in driven.steps]).max(axis=1)
    assert speed[-1] < 0.5 * speed.max()


def test_a_manoeuvre_beyond_the_envelope_that_breaks_off_keeps_all_limits(tmp_path: Path) -> None:
    cabin = tmp_path / 'cabin.yaml'
    slow, quick = 'translation_frequency: [0.9, 0.3, 2.5]', 'translation_frequency: [2.5, 2.5, 4.0]'
    cabin.write_text(CABIN.read_text().replace(slow, quick).replace('[0.2, 0.1, 0.5]', '[0.6, 0.6, 0.6]'))
    # As if the car hit something, again and again.
    inputs = [imu(0.01 * k, [0.0, 40.0 * (-1.0) ** (k // 60), G])[2] for k in range(200)]
    messages = [(0.01 * k, '/vehicle_imu', message) for k, message in enumerate(inputs)]
    run = simulated(tmp_path, PROGRAM, messages, 7.0, str(cabin))
    assert run.ok, run.error
    found = read_recorded_cabin(tmp_path / 'bag', robot=ROBOT, cabin=cabin)
    assert any(reason.startswith('specific force y = 40') for reason in reasons(found.steps))
    assert (np.abs([step.cabin[0] for step in found.steps]) <= np.array(found.cabin.envelope.reach)).all()
    check_limits(found.robot, np.moveaxis(run.reference, 1, 0))
    assert np.abs(found.drives[1, -1]).max() < 0.1 * np.abs(found.drives[1]).max()


def test_a_run_that_was_not_guided_is_refused(tmp_path: Path) -> None:
    program = tmp_path / 'still.lua'
    program.write_text('wait(0.1)\n')
    simulate(program, robot=ROBOT, bag=tmp_path / 'bag')
    with pytest.raises(RobotsError, match='holds no /reference_pose: the robot was not guided'):
        read_recorded_cabin(tmp_path / 'bag', robot=ROBOT, cabin=CABIN)


def test_a_cabin_needs_inputs_of_a_driver_or_a_vehicle(tmp_path: Path) -> None:
    program = tmp_path / 'program.lua'
    program.write_text('followReference(1)\n')
    run = simulate(program, robot=ROBOT, cabin=CABIN)
    assert 'a simulation has no driver; --references names a recording of one' in str(run.error)
    bag = write_bag(tmp_path / 'car', [imu(0.0, [0.0, 0.0, G])])
    needed = 'needed is one of vehicle_imu, joy, teach_twist, teach_joints; it holds /car/imu'
    with pytest.raises(RobotsError, match=needed):
        simulate(program, robot=ROBOT, cabin=CABIN, references=bag)
    broken = write_bag(tmp_path / 'broken', [joy(0.0, 2.0, 0.0)])
    with pytest.raises(RobotsError, match=r'message 1 of /joy: steering = 2\.0; valid is -1 to 1'):
        simulate(program, robot=ROBOT, cabin=CABIN, references=broken)
