"""Laws of measured tools, bases and payloads: what was known is found; what cannot be found is refused."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.blocks import (
    MotionSamples,
    identify_payload,
    measure_base,
    measure_tool_center,
    measure_tool_orientation,
)
from robots_core.blocks.calibration.three_points import AXES, Axis
from robots_core.blocks.multibody.loaded_robot import LoadedRobot
from robots_core.blocks.multibody.payload import Payload
from robots_core.errors import InvalidInputError, MeasurementError
from robots_core.orientation import rotation_from_vector
from robots_core.validation import Array

NOISE = 2e-5  # m, of one touch

numbers = st.floats(-1.0, 1.0)
vectors = st.tuples(numbers, numbers, numbers).map(np.array)
seeds = st.integers(0, 2**32 - 1)
poses = st.builds(lambda r, turn: Pose(r, rotation_from_vector(3.0 * turn)), vectors, vectors)
AXIS = X, _, Z = np.eye(3)


def unit(vector: Array) -> Array:
    return np.asarray(vector / np.linalg.norm(vector))


def touches(tool: Pose, touched: Array, rng: np.random.Generator, *, count: int = 4) -> list[Pose]:
    """Poses of tool0 in which the tip is at one point: the flange is turned about several axes."""
    middle = rotation_from_vector(rng.uniform(-2.0, 2.0, 3))
    found = []
    for number in range(count):
        about = np.eye(3)[number % 3] * (-1.0) ** (number // 3)
        T = middle @ rotation_from_vector(rng.uniform(0.4, 1.2) * (about + rng.uniform(-0.2, 0.2, 3)))
        found.append(Pose(touched - T @ tool.r, T))
    return found


@given(vectors, vectors, seeds, st.integers(4, 8))
def test_a_known_tool_is_found_within_a_tenth_of_a_millimetre(
    r: Array, touched: Array, seed: int, count: int
) -> None:
    rng = np.random.default_rng(seed)
    tool = Pose(r, np.eye(3))
    exact = touches(tool, touched, rng, count=count)
    found = measure_tool_center(exact)
    np.testing.assert_allclose(found.r, r, atol=1e-9)
    np.testing.assert_allclose(found.touched, touched, atol=1e-9)
    assert found.residuals.shape == (count,)
    assert found.residuals.max() < 1e-9
    noisy = [Pose(pose.r + np.clip(rng.normal(size=3), -2.0, 2.0) * NOISE, pose.T) for pose in exact]
    found = measure_tool_center(noisy)
    assert np.linalg.norm(found.r - r) < 1e-4
    assert found.residuals.max() < 1e-4


@given(vectors, vectors, seeds, st.integers(0, 4), vectors)
def test_the_point_that_was_touched_badly_is_named(
    r: Array, touched: Array, seed: int, bad: int, way: Array
) -> None:
    points = touches(Pose(r, np.eye(3)), touched, np.random.default_rng(seed), count=5)
    shift = 0.02 * unit(way + 2.0 * X)
    points[bad] = Pose(points[bad].r + shift, points[bad].T)
    with pytest.raises(MeasurementError, match=f'valid is at most 1 mm; point {bad + 1} fits') as raised:
        measure_tool_center(points)
    assert raised.value.details['index'] == bad
    measure_tool_center(points, largest_residual=0.05)


@given(vectors, vectors, st.lists(st.floats(-3.0, 3.0), min_size=4, max_size=6), vectors)
def test_turns_about_one_axis_alone_are_refused(
    r: Array, touched: Array, turns: list[float], about: Array
) -> None:
    axis = unit(about + 2.0 * Z)
    points = [Pose(touched - T @ r, T) for T in (rotation_from_vector(turn * axis) for turn in turns)]
    with pytest.raises(MeasurementError, match='differ too little') as raised:
        measure_tool_center(points)
    if np.ptp(turns) > 1.0 and axis[2] > 0.9:
        assert ', 1.00] of tool0' in str(raised.value) or ', 0.9' in str(raised.value)


def test_three_points_are_too_few() -> None:
    points = touches(Pose.identity(), np.zeros(3), np.random.default_rng(0), count=3)
    with pytest.raises(MeasurementError, match='3 points; the tool centre point needs at least 4'):
        measure_tool_center(points)


@given(poses, poses, poses, st.sampled_from(AXES), vectors)
def test_a_known_orientation_of_a_tool_is_found(
    tool: Pose, first: Pose, second: Pose, axis: Axis, sizes: Array
) -> None:
    along, across, beside = [*(0.05 + 0.3 * np.abs(sizes[:2])), sizes[2]]
    touched = np.array([0.5, -0.2, 0.1])
    number = 'xyz'.index(axis[-1])
    on_axis = (-along if axis.startswith('-') else along) * AXIS[number]
    in_plane = across * AXIS[(number + 1) % 3] + beside * AXIS[number]
    flanges = []
    for turned, point in ((first, on_axis), (second, in_plane)):  # the fixed point is there in the tool
        T = turned.T @ tool.T.T
        flanges.append(Pose(touched - turned.T @ point - T @ tool.r, T))
    found = measure_tool_orientation(tool.r, touched, *flanges, axis=axis)
    np.testing.assert_allclose(found.r, tool.r, atol=1e-12)
    np.testing.assert_allclose(found.T, tool.T, atol=1e-9)


@given(poses, st.floats(0.03, 2.0), st.floats(0.03, 2.0), numbers)
def test_a_known_base_is_found(base: Pose, along: float, across: float, beside: float) -> None:
    points = (
        base.r + base.T @ point for point in ([0.0, 0.0, 0.0], [along, 0.0, 0.0], [beside, across, 0.0])
    )
    found = measure_base(*points)
    np.testing.assert_allclose(found.r, base.r, atol=1e-12)
    np.testing.assert_allclose(found.T, base.T, atol=1e-9)


@given(vectors, vectors, numbers)
def test_points_on_a_line_or_too_near_are_refused(origin: Array, way: Array, part: float) -> None:
    x = origin + way + 2.0 * X
    with pytest.raises(MeasurementError, match=r'point in the plane is .* mm from the x axis'):
        measure_base(origin, x, origin + part * (x - origin))
    with pytest.raises(MeasurementError, match=r'point on the x axis is .* mm from the origin'):
        measure_base(origin, origin + 0.01 * way / max(float(np.linalg.norm(way)), 1.0), x)


def test_an_unknown_axis_is_refused() -> None:
    pose = Pose.identity()
    with pytest.raises(InvalidInputError, match="axis = 'w' is unknown; valid are x, y, z, -x, -y, -z"):
        measure_tool_orientation(np.zeros(3), np.zeros(3), pose, pose, axis='w')  # type: ignore[arg-type]


# -- payload ----------------------------------------------------------------------------------------------

ROBOTS = ('kuka_kr210_r2700', 'ur5e', 'kuka_kr500_linear_axis')


@cache
def robot_of(name: str) -> BaseRobotModel:
    return load_robot_model(name)


def swing(robot: BaseRobotModel, moved: int, seed: int) -> MotionSamples:
    """The last axes swing, each with its own frequency; without torques."""
    n, rng = robot.num_axes, np.random.default_rng(seed)
    t = np.arange(0.0, 8.0, 0.1)[:, None]
    w = rng.uniform(0.7, 2.5, n)
    a = np.minimum(0.6, 0.3 * robot.axes_data.velocity / w) * (np.arange(n) >= n - moved)
    phase = w * t + rng.uniform(0.0, 6.0, n)
    q, q_dot = np.array(robot.home) + a * np.sin(phase), a * w * np.cos(phase)
    return MotionSamples(q, q_dot, -a * w**2 * np.sin(phase), np.zeros_like(q))


def with_torques(samples: MotionSamples, robot: BaseRobotModel, rng: np.random.Generator) -> MotionSamples:
    """Torques by the robot's own dynamics, with friction that no model has, rotors, and noise."""
    axes = robot.axes_data
    motion = zip(samples.q, samples.q_dot, samples.q_ddot, strict=True)
    tau = np.array([robot.rigid_dynamics(*one)[0] for one in motion])
    tau += axes.reflected_inertia * samples.q_ddot
    tau += (axes.coulomb_friction + 0.03 * axes.effort) * np.sign(samples.q_dot)
    tau += (axes.viscous_friction + 0.01 * axes.effort / axes.velocity) * samples.q_dot
    return replace(samples, tau=tau + 0.002 * axes.effort * rng.normal(size=tau.shape))


@settings(max_examples=30)
@given(st.sampled_from(ROBOTS), st.floats(0.2, 1.0), vectors, seeds)
def test_a_known_payload_is_found_within_its_uncertainty(
    name: str, load: float, center: Array, seed: int
) -> None:
    robot, rng = robot_of(name), np.random.default_rng(seed)
    mass = load * (200.0 if name.startswith('kuka') else 5.0)
    inertia = 0.02 * mass * np.diag([1.0, 1.5, 2.0])
    loaded = LoadedRobot(robot, Payload(mass, 0.1 * center, inertia))
    try:
        found = identify_payload(robot, with_torques(swing(robot, 4, seed), loaded, rng))
    except MeasurementError:  # some swings are too small
        reject()
    assert found.payload.mass == pytest.approx(mass, abs=6.0 * found.mass_std)
    assert (np.abs(found.payload.center - 0.1 * center) <= 6.0 * found.center_std).all()
    assert found.mass_std < 0.05 * mass
    assert found.center_std.max() < 0.02


def test_a_payload_in_a_motion_that_excites_it_is_found() -> None:
    robot = robot_of('kuka_kr210_r2700')
    loaded = LoadedRobot(robot, Payload(80.0, np.array([0.05, -0.1, 0.25])))
    found = identify_payload(robot, with_torques(swing(robot, 4, 1), loaded, np.random.default_rng(1)))
    assert found.payload.mass == pytest.approx(80.0, abs=1.0)
    np.testing.assert_allclose(found.payload.center, [0.05, -0.1, 0.25], atol=5e-3)
    assert (found.torque_error[2:] > 0.0).all()
    assert (found.torque_error[:2] == 0.0).all()  # they stood


def test_motions_that_excite_too_little_are_refused() -> None:
    robot, rng = robot_of('kuka_kr210_r2700'), np.random.default_rng(0)
    loaded = LoadedRobot(robot, Payload(50.0, np.array([0.0, 0.0, 0.2])))
    first_alone = with_torques(swing(robot, 6, 0), loaded, rng)
    q_dot, q_ddot = (np.where(np.arange(6) == 0, one, 0.0) for one in (first_alone.q_dot, first_alone.q_ddot))
    still = replace(first_alone, q=np.zeros_like(q_dot), q_dot=q_dot, q_ddot=q_ddot)
    with pytest.raises(MeasurementError, match=r'too short; needed are over 88: move several axes'):
        identify_payload(robot, still)
    last_alone = with_torques(swing(robot, 1, 0), loaded, rng)
    twice = MotionSamples(*(np.tile(one, (2, 1)) for one in vars(last_alone).values()))
    with pytest.raises(MeasurementError, match=r'move axes that lift it|distinguished'):
        identify_payload(robot, twice)
    nothing = with_torques(swing(robot, 4, 0), robot, rng)
    with pytest.raises(MeasurementError, match='cannot be distinguished from 0'):
        identify_payload(robot, nothing)
    with pytest.raises(InvalidInputError, match='the samples have 6 axes, the robot has 7'):
        identify_payload(robot_of('kuka_kr500_linear_axis'), nothing)


@given(seeds)
def test_a_recording_becomes_the_motion_that_it_is_of(seed: int) -> None:
    rng = np.random.default_rng(seed)
    t = np.cumsum(rng.uniform(0.002, 0.006, 800))  # with times that are not even
    w = rng.uniform(0.5, 3.0, 2)
    q, tau = np.sin(w * t[:, None]), 50.0 * np.cos(w * t[:, None])
    found = MotionSamples.from_recording(t, q, tau)
    np.testing.assert_allclose(found.q_ddot, -(w**2) * found.q, atol=0.1)
    np.testing.assert_allclose(found.tau, 50.0 / w * found.q_dot, atol=2e-2)


def test_recordings_that_are_none_are_refused() -> None:
    t, q = np.arange(5.0), np.zeros((5, 2))
    with pytest.raises(MeasurementError, match='no recording of a motion'):
        MotionSamples.from_recording(t, q, q)
    with pytest.raises(InvalidInputError, match='numbers that ascend'):
        MotionSamples.from_recording(t[::-1], q, q)
    with pytest.raises(InvalidInputError, match='tau has shape'):
        MotionSamples.from_recording(t, q, q[:, :1])
    with pytest.raises(InvalidInputError, match='not a finite number'):
        MotionSamples(q, q, q, q + np.nan)
