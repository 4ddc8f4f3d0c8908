"""MotionCueing against transfer functions that SciPy computes, and its bad cases."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robots_core.blocks import CabinEnvelope, CueingStep, MotionCueing, VehicleMotion, WashoutSettings
from robots_core.errors import InvalidInputError
from robots_core.validation import Array

G = 9.80665
UP = np.array([0.0, 0.0, G])
DT = 0.004
COARSE = 0.02  # s, for motions of which only the end matters
SETTINGS = WashoutSettings(
    force_scale=(0.5, 0.6, 0.7),
    rate_scale=(0.5, 0.6, 0.7),
    translation_frequency=(2.5, 1.5, 4.0),
    translation_damping=(1.0, 0.7, 1.2),
    return_frequency=(0.6, 0.5, 0.8),
    rotation_frequency=(0.6, 0.8, 1.0),
    rotation_damping=(1.0, 0.7, 0.8),
    tilt_frequency=(2.0, 1.0),
    tilt_damping=(1.0, 0.8),
)
WIDE = CabinEnvelope(reach=(9.0,) * 3 + (1.0,) * 3, velocity=(9.0,) * 6, acceleration=(90.0,) * 6)
NARROW = CabinEnvelope(
    reach=(0.3, 0.4, 0.2, 0.2, 0.15, 0.25),
    velocity=(0.6, 0.8, 0.5, 0.3, 0.3, 0.4),
    acceleration=(1.5, 2.0, 1.0, 0.5, 0.6, 0.7),
)
# Products of two signals are this much smaller than the signals: what the filter does is linear to 1e-6.
SMALL = 1e-6
Signals = Callable[[float], tuple[Iterable[float], Iterable[float]]]


def run(
    force: Array, rate: Array | None = None, *, envelope: CabinEnvelope = WIDE, dt: float = DT
) -> list[CueingStep]:
    """Steps for forces beside gravity and angular velocities, (k, 3) each."""
    cueing = MotionCueing(SETTINGS, envelope, dt)
    rate = np.zeros_like(force) if rate is None else rate
    return [cueing.step(VehicleMotion(row + UP, turning)) for row, turning in zip(force, rate, strict=True)]


def along(axis: int, values: Array) -> Array:
    rows = np.zeros((len(values), 3))
    rows[:, axis] = values
    return rows


def cabin(steps: list[CueingStep]) -> Array:
    return np.array([step.cabin[0] for step in steps])


def washout(steps: list[CueingStep]) -> Array:
    return np.array([step.washout[0] for step in steps])


def position_of_acceleration(axis: int) -> tuple[Array, Array]:
    """Numerator and denominator of the high-pass, integrated twice."""
    w, z, b = (
        values[axis]
        for values in (
            SETTINGS.translation_frequency,
            SETTINGS.translation_damping,
            SETTINGS.return_frequency,
        )
    )
    return np.array([1.0, 0.0]), np.polymul([1.0, 2.0 * z * w, w**2], [1.0, b])


def low_pass(axis: int) -> tuple[Array, Array]:
    w, z = SETTINGS.tilt_frequency[axis], SETTINGS.tilt_damping[axis]
    return np.array([w**2]), np.array([1.0, 2.0 * z * w, w**2])


def high_pass_of_rest(axis: int) -> tuple[Array, Array]:
    """From the force to the position: what the low-pass leaves, through the high-pass, integrated twice."""
    (a, b), (_, d) = position_of_acceleration(axis), low_pass(axis)
    return np.polymul(a, np.polysub(d, low_pass(axis)[0])), np.polymul(b, d)


def answer(system: tuple[Sequence[float] | Array, Sequence[float] | Array], values: Array) -> Array:
    """Of a system at rest to samples with straight lines between them."""
    from scipy.signal import lsim  # noqa: PLC0415  # takes half a second to load

    _, found, _ = lsim(system, values, np.arange(len(values)) * DT)
    return np.asarray(found)


def frequency_response(system: tuple[Array, Array], frequency: float) -> complex:
    numerator, denominator = (np.polyval(part, 1j * frequency) for part in system)
    return complex(numerator / denominator)


def impulse_like(length: int) -> Array:
    """A start from zero, a jump and a ramp: straight lines between the samples."""
    values = np.zeros(length)
    values[10:200] = 1.0
    values[200:400] = np.linspace(1.0, -2.0, 200)
    return SMALL * values


def test_heave_is_the_third_order_high_pass_integrated_twice() -> None:
    values = impulse_like(2000)
    found = washout(run(along(2, values)))[:, 2]
    expected = answer(position_of_acceleration(2), 0.7 * values)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())


@pytest.fixture(scope='module')
def turned() -> Array:
    """The washout for turns about all axes at once, which small as they are leave each other alone."""
    return washout(run(np.zeros((2000, 3)), np.tile(impulse_like(2000)[:, None], 3)))


@pytest.mark.parametrize('axis', [0, 1, 2])
def test_rotation_is_the_second_order_high_pass_integrated_once(axis: int, turned: Array) -> None:
    values, found = impulse_like(2000), turned[:, 3 + axis]
    w, z = SETTINGS.rotation_frequency[axis], SETTINGS.rotation_damping[axis]
    scaled = SETTINGS.rate_scale[axis] * values
    expected = answer(([1.0, 0.0], [1.0, 2.0 * z * w, w**2]), scaled)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=10.0 * SMALL * np.abs(expected).max())


@pytest.fixture(scope='module')
def tilted() -> Array:
    """The washout for forces along x and y at once."""
    values = impulse_like(2000)
    return washout(run(along(0, values) + along(1, values)))


@pytest.mark.parametrize(('axis', 'angle', 'sign'), [(0, 4, -1.0), (1, 3, 1.0)])
def test_tilt_is_the_low_pass_of_the_force_over_gravity(
    axis: int, angle: int, sign: float, tilted: Array
) -> None:
    values, found = impulse_like(2000), tilted[:, angle]
    scaled = SETTINGS.force_scale[axis] * values
    expected = answer(low_pass(axis), sign * scaled / G)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=10.0 * SMALL * np.abs(expected).max())


FREQUENCIES = (0.3, 1.0, 3.0, 10.0)  # rad/s


@pytest.fixture(scope='module')
def waves() -> tuple[Array, list[CueingStep]]:
    """Times and steps for forces along x and y that are sums of sines: what is linear answers each alone."""
    # The slowest pole has died away to 5e-5 before the last period of the slowest sine.
    settled = 10.0 / min(SETTINGS.return_frequency[:2])
    time = np.arange(round((settled + 2.0 * np.pi / FREQUENCIES[0]) / DT)) * DT
    values = SMALL * np.sin(np.outer(time, FREQUENCIES)).sum(axis=1)
    steps = run(along(0, values) + along(1, values))
    last = time >= settled
    return time[last], steps[-int(last.sum()) :]


@pytest.mark.parametrize('axis', [0, 1])
@pytest.mark.parametrize('frequency', FREQUENCIES)
def test_frequency_response_of_position_and_felt_force(
    axis: int, frequency: float, waves: tuple[Array, list[CueingStep]]
) -> None:
    time, steps = waves
    scale = SETTINGS.force_scale[axis] * SMALL

    def response(values: Array) -> complex:
        """From the scaled force, by the best fit of sines and cosines."""
        angles = np.outer(time, FREQUENCIES)
        parts, *_ = np.linalg.lstsq(np.hstack([np.sin(angles), np.cos(angles)]), values, rcond=None)
        number = FREQUENCIES.index(frequency)
        return complex(parts[number], parts[len(FREQUENCIES) + number]) / scale

    of_position = frequency_response(high_pass_of_rest(axis), frequency)
    of_tilt = frequency_response(low_pass(axis), frequency)
    # Filters see straight lines between samples where the sine bends by (omega dt)^2 / 8 at most.
    tolerance = (frequency * DT) ** 2 + 1e-4
    found = response(washout(steps)[:, axis])
    assert abs(found - of_position) < tolerance * abs(of_position)
    felt = response(np.array([step.felt.specific_force[axis] for step in steps]))
    # The felt acceleration is the mean of the period: half a period old.
    delayed = -(frequency**2) * of_position * np.exp(-0.5j * frequency * DT)
    assert abs(felt - (delayed + of_tilt)) < 10.0 * tolerance


@pytest.mark.parametrize('axis', [0, 1])
def test_a_sustained_force_is_felt_by_tilting_alone(axis: int) -> None:
    steps = run(along(axis, np.full(1500, 2.0)), dt=COARSE)
    end = steps[-1]
    expected = np.array([0.0, 0.0, G])
    expected[axis] = SETTINGS.force_scale[axis] * 2.0
    assert end.felt.specific_force[axis] == pytest.approx(expected[axis], abs=1e-6)
    assert np.abs(end.cabin[0, :2]).max() < 1e-4
    # Gravity alone: its length is that of rest.
    assert np.linalg.norm(end.felt.specific_force) == pytest.approx(G, abs=1e-4)


def test_a_sustained_rotation_brings_the_cabin_back() -> None:
    steps = run(np.zeros((1200, 3)), along(2, np.full(1200, 0.3)), dt=COARSE)
    assert np.abs(cabin(steps)[:, 5]).max() > 0.05
    assert abs(steps[-1].cabin[0, 5]) < 1e-6


def test_the_tilt_is_no_faster_and_no_larger_than_its_limits() -> None:
    steps = run(along(1, np.full(1000, 9.0)), dt=COARSE)
    roll = washout(steps)[:, 3]
    assert np.abs(np.diff(roll)).max() <= SETTINGS.tilt_rate * COARSE * (1.0 + 1e-9)
    assert roll.max() == pytest.approx(SETTINGS.largest_tilt, abs=1e-12)
    assert any('tilt of roll is limited to 0.0524 rad/s' in step.limits for step in steps)
    assert 'tilt of roll is limited to 0.25 rad' in steps[-1].limits


@pytest.mark.parametrize('dt', [0.004, 0.01, 0.02])
def test_any_period_gives_the_same_motion(dt: float) -> None:
    (fine, expected), (time, found) = mixed(0.001), mixed(dt)
    there = np.column_stack([np.interp(time, fine, column) for column in expected.T])
    # The attitude of one period turns the force of the next: an error of first order in the period.
    np.testing.assert_allclose(found, there, atol=0.1 * dt)


@cache
def mixed(period: float) -> tuple[Array, Array]:
    """Times, and the cabin for forces and turns of several frequencies."""
    time = np.arange(round(6.0 / period)) * period
    force = np.column_stack([2.0 * np.sin(time), 1.5 * np.sin(1.7 * time), np.sin(3.0 * time)])
    return time, cabin(run(force, 0.1 * force, dt=period))


def test_what_is_felt_is_what_the_poses_of_the_cabin_say() -> None:
    time = np.arange(1500) * DT
    force = np.column_stack([2.0 * np.sin(time), 1.5 * np.sin(1.7 * time), np.sin(3.0 * time)])
    smooth = replace(WIDE, acceleration=(9.0,) * 3 + (1.0,) * 3)
    steps = run(force, 0.2 * force, envelope=smooth)
    poses = [step.pose for step in steps]
    r = np.array([pose.r for pose in poses])
    turned = Rotation.from_matrix([pose.T for pose in poses])
    middle = slice(1, -1)
    # At the middle of two periods: second differences, and half the rotation over both.
    acceleration = (r[2:] - 2.0 * r[1:-1] + r[:-2]) / DT**2
    expected = turned[middle].inv().apply(acceleration + UP)
    forces = np.array([step.felt.specific_force for step in steps])
    mean = 0.5 * (forces[1:-1] + forces[2:])
    np.testing.assert_allclose(mean, expected, atol=2e-2)
    rate = (turned[:-2].inv() * turned[2:]).as_rotvec() / (2.0 * DT)
    found = np.array([step.felt.angular_velocity for step in steps[middle]])
    # Within two periods it changes by no more than the acceleration.
    np.testing.assert_allclose(found, rate, atol=1.0 * DT)


def test_wanted_is_the_scaled_motion_within_its_limits() -> None:
    step = run(np.array([[4.0, -30.0, 1.0]]), np.array([[0.1, 5.0, -0.2]]))[0]
    np.testing.assert_allclose(step.wanted.specific_force, [2.0, -6.0, G + 0.7])
    np.testing.assert_allclose(step.wanted.angular_velocity, [0.05, 0.6, -0.14])
    assert 'specific force y = -30 m/s^2 is beyond 10 m/s^2' in step.limits
    assert 'angular velocity y = 5 rad/s is beyond 1 rad/s' in step.limits


def test_a_manoeuvre_beyond_the_envelope_is_held_back_with_a_reason() -> None:
    time = np.arange(1500) * DT
    steps = run(along(0, 8.0 * np.sign(np.sin(2.0 * time))), envelope=NARROW)
    assert np.abs(cabin(steps)).max(axis=0)[0] <= NARROW.reach[0] + 1e-12
    reasons = [limit for step in steps for limit in step.limits]
    assert any(limit.startswith('surge of') and limit.endswith('m is beyond 0.3 m') for limit in reasons)
    assert any('behind: limited in speed or acceleration' in limit for limit in reasons)


def test_inside_the_envelope_the_cabin_follows_the_filter() -> None:
    time = np.arange(1500) * DT
    steps = run(along(0, np.sin(2.0 * time)), envelope=NARROW)
    # They differ by what an acceleration of up to 0.6 m/s^2 does within a period.
    np.testing.assert_allclose(cabin(steps), washout(steps), atol=0.6 * DT**2)
    assert not any('surge' in limit for step in steps for limit in step.limits)


def test_a_signal_that_stops_brings_the_cabin_to_rest_and_says_so() -> None:
    cueing = MotionCueing(SETTINGS, NARROW, COARSE)
    motion = VehicleMotion(np.array([3.0, -2.0, G + 1.0]), np.array([0.2, 0.1, -0.3]))
    for _ in range(100):
        moving = cueing.step(motion)
    assert np.abs(moving.cabin[1]).max() > 0.01
    held = [cueing.step(None) for _ in range(round(SETTINGS.timeout / COARSE))]
    assert not any('no motion of the vehicle' in limit for step in held for limit in step.limits)
    np.testing.assert_array_equal(held[-1].wanted.specific_force, moving.wanted.specific_force)
    steps = [cueing.step(None) for _ in range(2000)]
    assert 'no motion of the vehicle for 0.22 s: the cabin returns to its middle' in steps[0].limits
    np.testing.assert_array_equal(steps[-1].wanted.specific_force, [0.0, 0.0, G])
    assert np.abs(steps[-1].cabin).max() < 1e-6
    # When samples come again the input is taken up without a jump.
    forces = [
        cueing.step(motion).wanted.specific_force for _ in range(round(SETTINGS.fade_time / COARSE) + 1)
    ]
    changes = np.abs(np.diff([steps[-1].wanted.specific_force, *forces], axis=0))
    assert changes.max() <= 1.0001 * COARSE / SETTINGS.fade_time * 1.5
    np.testing.assert_allclose(forces[-1], moving.wanted.specific_force)


def test_reset_starts_again_in_the_middle() -> None:
    cueing = MotionCueing(SETTINGS, NARROW, DT)
    motion = VehicleMotion(np.array([3.0, -2.0, G]), np.array([0.2, 0.1, -0.3]))
    first = [cueing.step(motion).cabin for _ in range(50)]
    cueing.reset()
    np.testing.assert_array_equal([cueing.step(motion).cabin for _ in range(50)], first)


@pytest.mark.parametrize(
    ('force', 'rate', 'reason'),
    [
        ([0.0, np.nan, G], [0.0] * 3, r'specific_force\[1\] is nan, every value must be a finite number'),
        ([0.0, 0.0, G], [np.inf, 0.0, 0.0], r'angular_velocity\[0\] is inf'),
        ([0.0, G], [0.0] * 3, r'specific_force must have shape \(3,\), got \(2,\)'),
    ],
)
def test_samples_that_are_no_motion_are_refused(force: list[float], rate: list[float], reason: str) -> None:
    with pytest.raises(InvalidInputError, match=reason):
        VehicleMotion(np.array(force), np.array(rate))


@pytest.mark.parametrize(
    ('change', 'reason'),
    [
        ({'tilt_rate': 0.0}, r'tilt_rate = 0.0 rad/s must be a finite number above 0'),
        ({'force_scale': (0.5, np.nan, 0.5)}, r'force_scale.y = nan must be a finite number above 0'),
        ({'force_scale': (0.5, 0.5)}, r'force_scale = \(0.5, 0.5\) must have a number for each of xyz'),
        ({'tilt_damping': 1.0}, 'tilt_damping = 1.0 must have a number for each of xy'),
        ({'tilt_frequency': (1.0, -1.0)}, r'tilt_frequency.y = -1.0 rad/s must be'),
        ({'largest_tilt': 1.0}, 'largest_tilt = 1 rad must be below 1 rad'),
    ],
)
def test_settings_that_are_none_are_refused(change: dict[str, object], reason: str) -> None:
    with pytest.raises(InvalidInputError, match=reason):
        replace(SETTINGS, **change)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ('change', 'reason'),
    [
        ({'reach': (1.0, 1.0, 1.0, 1.0, 1.5, 1.0)}, 'reach of pitch = 1.5 rad must be at most 1.2 rad'),
        ({'velocity': (1.0, 0.0, 1.0, 1.0, 1.0, 1.0)}, 'velocity of sway = 0.0 m/s must be'),
        ({'acceleration': (1.0,) * 5}, 'acceleration must have 6 bounds'),
    ],
)
def test_envelopes_that_are_none_are_refused(change: dict[str, object], reason: str) -> None:
    with pytest.raises(InvalidInputError, match=reason):
        replace(WIDE, **change)  # type: ignore[arg-type]


def test_a_period_must_be_positive() -> None:
    with pytest.raises(InvalidInputError, match=r'dt = 0\.0 s must be a finite number above 0'):
        MotionCueing(SETTINGS, WIDE, 0.0)
