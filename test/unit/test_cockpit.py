"""A driver's inputs and motions of a vehicle, as the cabin gets them, and the file of the cabin."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from robots_core import Pose
from robots_core.blocks import (
    Cabin,
    Cockpit,
    DrivenVehicle,
    DriverInputs,
    VehicleData,
    VehicleMotion,
    WashoutSettings,
    read_cabin,
)
from robots_core.blocks.motion_cueing.vehicle_inputs import read_input
from robots_core.errors import InvalidInputError

from .simulated_program import PROGRAMS

G = 9.80665
DT = 0.004
FILE = PROGRAMS / 'motion_simulator' / 'cabin.yaml'
CAR = VehicleData()


@pytest.fixture
def cabin() -> Cabin:
    return replace(read_cabin(FILE), washout=WashoutSettings())


def drive(vehicle: DrivenVehicle, inputs: DriverInputs, time: float) -> list[VehicleMotion]:
    return [vehicle.step(inputs) for _ in range(round(time / DT))]


def test_the_car_gains_the_speed_that_its_driver_feels_and_never_more_than_its_highest() -> None:
    vehicle = DrivenVehicle(CAR, DT)
    motions = drive(vehicle, DriverInputs(0.0, 1.0), 5.0)
    assert vehicle.speed == pytest.approx(sum(motion.specific_force[0] for motion in motions) * DT)
    # Of dv/dt = a (1 - v / v_max), later by the time constant of the pedal.
    after = 5.0 - CAR.response
    expected = CAR.highest_speed * (1.0 - np.exp(-CAR.acceleration * after / CAR.highest_speed))
    assert vehicle.speed == pytest.approx(expected, rel=0.02)
    drive(vehicle, DriverInputs(0.0, 1.0), 200.0)
    assert vehicle.speed == pytest.approx(CAR.highest_speed, rel=1e-3)


def test_the_car_corners_as_the_single_track_model_in_steady_state() -> None:
    vehicle, inputs = DrivenVehicle(CAR, DT), DriverInputs(0.1, 0.0)
    vehicle.speed = 12.0
    motion = drive(vehicle, inputs, 3.0)[-1]
    angle, speed = 0.1 * CAR.largest_steering, vehicle.speed
    gradient = CAR.wheelbase / CAR.characteristic_speed**2  # steering angle = l / R + gradient * a_y
    radius = speed / motion.angular_velocity[2]
    assert angle == pytest.approx(CAR.wheelbase / radius + gradient * speed**2 / radius)
    np.testing.assert_allclose(motion.specific_force, [0.0, speed**2 / radius, G], atol=1e-9)


def test_grip_bounds_what_a_driver_can_ask_for() -> None:
    vehicle = DrivenVehicle(CAR, DT)
    vehicle.speed = 30.0
    motion = drive(vehicle, DriverInputs(-1.0, 0.0), 2.0)[-1]
    assert motion.specific_force[1] == pytest.approx(-CAR.grip)
    assert motion.angular_velocity[2] == pytest.approx(-CAR.grip / vehicle.speed)


def test_a_car_that_has_stopped_stands() -> None:
    vehicle = DrivenVehicle(CAR, DT)
    vehicle.speed = 5.0
    motion = drive(vehicle, DriverInputs(0.3, -1.0), 3.0)[-1]
    assert vehicle.speed == 0.0
    np.testing.assert_array_equal(motion.specific_force, [0.0, 0.0, G])
    np.testing.assert_array_equal(motion.angular_velocity, 0.0)


def test_rare_motions_of_a_vehicle_reach_the_cabin_without_stairs(cabin: Cabin) -> None:
    cockpit, rows = Cockpit(cabin, DT), []
    for k in range(100):
        if k % 5 == 0:  # 50 Hz
            cockpit.take(VehicleMotion(np.array([0.1 * k, 0.0, G]), np.zeros(3)))
        rows.append(cockpit.step().wanted.specific_force[0])
    scale = cabin.washout.force_scale[0]
    np.testing.assert_allclose(np.diff(rows[10:]), scale * 0.1, rtol=1e-9)


def test_a_driver_who_falls_silent_brings_the_cabin_to_rest(cabin: Cabin) -> None:
    cockpit = Cockpit(cabin, DT)
    steps = []
    for k in range(round(20.0 / DT)):
        if k < 1000 and k % 12 == 0:
            cockpit.take(DriverInputs(0.1, 1.0))
        steps.append(cockpit.step())
    moved = np.array([step.cabin[1] for step in steps])
    assert np.abs(moved[:1000]).max() > 0.05
    assert any('no motion of the vehicle' in limit for limit in steps[1200].limits)
    assert np.abs(moved[-1]).max() < 1e-2
    np.testing.assert_allclose(steps[-1].felt.specific_force, [0.0, 0.0, G], atol=0.02)


@pytest.mark.parametrize(
    ('axes', 'reason'),
    [
        ([0.0], 'joy has 1 axes; needed are steering and pedal'),
        ([1.5, 0.0], 'steering = 1.5; valid is -1 to 1'),
        ([0.0, float('nan')], 'pedal = nan'),
    ],
)
def test_inputs_that_are_none_are_refused(axes: list[float], reason: str) -> None:
    with pytest.raises(InvalidInputError, match=reason):
        read_input('joy', SimpleNamespace(axes=axes))


def test_a_car_needs_figures_above_zero() -> None:
    with pytest.raises(InvalidInputError, match='wheelbase = 0'):
        VehicleData(wheelbase=0.0)


def test_head_and_flange_are_where_they_belong(cabin: Cabin) -> None:
    cockpit = Cockpit(cabin, DT)
    step = cockpit.step()
    assert cabin.flange_of(step).distance_to(cabin.flange) == pytest.approx((0.0, 0.0), abs=1e-12)
    assert cabin.head_at(cabin.flange).distance_to(Pose.identity()) == pytest.approx((0.0, 0.0), abs=1e-12)
    poses, twists = [], []
    for _ in range(150):
        cockpit.take(VehicleMotion(np.array([1.0, -2.0, G + 1.0]), np.array([0.3, -0.2, 0.4])))
        step = cockpit.step()
        poses.append(cabin.flange_of(step))
        twists.append(cabin.twist_of(step))
        assert cabin.head_at(poses[-1]).distance_to(step.pose) == pytest.approx((0.0, 0.0), abs=1e-9)
    moved = [one.error_to(other) / DT for one, other in pairwise(poses)]
    # Within a period a velocity changes by its acceleration; the flange is 0.8 m from the head.
    np.testing.assert_allclose(twists[1:], moved, atol=2.0 * max(cabin.envelope.acceleration) * DT)


@pytest.mark.parametrize(
    ('old', 'new', 'reason'),
    [
        ('flange: {', 'hand: {', 'flange is missing'),
        ('  velocity: [0.8, 1.2, 0.5, 0.3, 0.3, 0.6]\n', '', r'velocity is missing'),
        ('reach: [0.4, 1.0,', 'reach: [0.4,', 'reach must have 6 bounds'),
        ('reach: [0.4,', 'reach: [-0.4,', 'reach of surge = -0.4 m'),
        ('tilt_frequency: [4.0, 0.8]', 'tilt_frequency: 4.0', r'4.0 must be a list of numbers'),
        ('tilt_frequency:', 'tilt_frequenzy:', "did you mean 'tilt_frequency'"),
        ('washout:', 'vehicle: {grip: -1}\nwashout:', r'grip = -1 m/s\^2 must be a finite number above 0'),
    ],
)
def test_files_that_are_no_cabin_are_refused(tmp_path: Path, old: str, new: str, reason: str) -> None:
    text = FILE.read_text()
    assert old in text
    path = tmp_path / 'cabin.yaml'
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(InvalidInputError, match=rf'cabin.yaml:\d+: .*{reason}'):
        read_cabin(path)
