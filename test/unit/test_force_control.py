"""Force control on springs, its bounds, and what must stop the robot."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from robots_core.blocks import ForceControl, ForceControlSettings, ForceWatch
from robots_core.errors import InvalidInputError
from robots_core.validation import Array

DT = 0.004  # s
SETTINGS = ForceControlSettings(
    press=np.array([0.0, 0.0, -2.0]),
    drive=np.array([0.0, 1.0, 0.0]),
    gain=1e-3,
    press_speed=0.02,
    drive_speed=0.05,
    acceleration=0.1,
    travel=0.06,
    force_limit=120.0,
    contact_force=5.0,
    timeout=0.2,
)


def changed(**values: Any) -> ForceControlSettings:
    return replace(SETTINGS, **values)


def pressed(settings: ForceControlSettings, stiffness: float, wanted: float, periods: int) -> Array:
    """Forces (periods,) on a spring that begins where the tool stands."""
    control, way, forces = ForceControl(settings, DT), 0.0, []
    for _ in range(periods):
        forces.append(stiffness * way)
        way += DT * float(control.step(-forces[-1] * settings.press, wanted, 0.0)[:3] @ settings.press)
    return np.array(forces)


def test_the_error_decays_by_gain_and_stiffness() -> None:
    stiffness, wanted = 5000.0, 15.0  # N/m, N: slower than the highest speed from the start on
    forces = pressed(SETTINGS, stiffness, wanted, 500)
    decay = 1.0 - SETTINGS.gain * stiffness * DT
    np.testing.assert_allclose(wanted - forces, wanted * decay ** np.arange(500), atol=1e-9)


@pytest.mark.parametrize('direction', [[1.0, 0.0, 0.0], [0.3, -0.2, 0.9]])
def test_any_direction_is_pressed_alike(direction: list[float]) -> None:
    press = np.array(direction)
    drive = np.cross(press, [0.1, 0.7, 0.3])
    settings = changed(press=press, drive=drive)
    np.testing.assert_allclose(
        pressed(settings, 4000.0, 40.0, 300), pressed(SETTINGS, 4000.0, 40.0, 300), atol=1e-9
    )


def test_speeds_are_bounded_and_driving_is_gained_and_lost_by_its_acceleration() -> None:
    control = ForceControl(SETTINGS, DT)
    twists = [control.step(np.zeros(3), 100.0, 0.05 if k < 300 else 0.0) for k in range(600)]
    velocity = np.array(twists)[:, :3]
    np.testing.assert_allclose(velocity @ SETTINGS.press, SETTINGS.press_speed)
    driven = velocity @ SETTINGS.drive
    assert driven.max() == pytest.approx(0.05)
    assert driven[-1] == 0.0
    assert np.abs(np.diff(driven, prepend=0.0)).max() <= SETTINGS.acceleration * DT + 1e-15
    assert not np.array(twists)[:, 3:].any()
    assert control.travel == pytest.approx(600 * DT * SETTINGS.press_speed)


def test_pressing_into_nothing_ends_at_its_travel() -> None:
    control = ForceControl(SETTINGS, DT)
    for _ in range(round(SETTINGS.travel / SETTINGS.press_speed / DT)):
        control.step(np.zeros(3), 64.0, 0.0)
    with pytest.raises(
        InvalidInputError, match=r'pressed 0.06 m far, .*; the force is 0.0 N, wanted are 64 N'
    ):
        control.step(np.zeros(3), 64.0, 0.0)
    control.begin()
    assert control.travel == 0.0


@pytest.mark.parametrize(
    ('wanted', 'speed', 'reason'),
    [
        (120.0, 0.0, 'a load of 120 N is commanded; valid is 0 to below 120 N'),
        (-1.0, 0.0, 'a load of -1 N is commanded'),
        (float('nan'), 0.0, 'a load of nan N'),
        (10.0, 0.06, 'a speed of 0.06 m/s is commanded; valid is -0.05 to 0.05 m/s'),
        (10.0, float('nan'), 'a speed of nan m/s'),
    ],
)
def test_commands_out_of_range_are_refused(wanted: float, speed: float, reason: str) -> None:
    with pytest.raises(InvalidInputError, match=reason):
        ForceControl(SETTINGS, DT).step(np.zeros(3), wanted, speed)


@pytest.mark.parametrize(
    ('values', 'reason'),
    [
        ({'gain': 0.0}, r'gain = 0.0 \(m/s\)/N must be a finite number above 0'),
        ({'travel': float('inf')}, 'travel = inf m'),
        ({'press': np.zeros(3)}, 'length of press = 0.0'),
        ({'drive': np.array([0.0, 1.0, 1.0])}, 'press and drive must be at right angles, .* -0.707'),
        ({'contact_force': 120.0}, 'contact_force = 120 N must be below force_limit = 120 N'),
    ],
)
def test_settings_out_of_range_are_refused(values: dict[str, Any], reason: str) -> None:
    with pytest.raises(InvalidInputError, match=reason):
        changed(**values)


class Sensor:
    """Measures a force in every period."""

    def __init__(self) -> None:
        self.watch, self.now = ForceWatch(SETTINGS), 0.0

    def checks(self, force: float | None, count: int = 1, *, controlled: bool) -> list[str]:
        found = []
        for _ in range(count):
            self.now += DT
            if force is not None:
                self.watch.measured(np.array([0.0, 0.0, force]))
            found.append(self.watch.problem(self.now, controlled=controlled))
        return found


def test_a_force_beyond_its_limit_is_a_problem_at_any_time() -> None:
    for controlled in (True, False):
        sensor = Sensor()
        sensor.checks(0.0, controlled=controlled)
        assert sensor.checks(-120.0, controlled=True) == ['']
        (problem,) = sensor.checks(-130.0, controlled=controlled)
        assert problem == 'the force on the tool is 130.0 N; allowed are 120 N'


def test_contact_may_begin_under_force_control_alone() -> None:
    sensor = Sensor()
    assert sensor.checks(4.9, controlled=False) == ['']
    (problem,) = sensor.checks(5.1, controlled=False)
    assert problem.startswith('contact that was not planned: the force on the tool is 5.1 N; ')
    sensor = Sensor()
    sensor.checks(0.0, controlled=True)
    assert sensor.checks(60.0, controlled=True) == ['']
    # Lifted without force control it leaves the contact, and may not come back.
    assert sensor.checks(60.0, 5, controlled=False) == [''] * 5
    assert sensor.checks(0.0, controlled=False) == ['']
    assert sensor.checks(60.0, controlled=False) != ['']


def test_a_silent_sensor_is_a_problem_under_force_control() -> None:
    sensor = Sensor()
    assert sensor.checks(None, controlled=False) == ['']
    assert sensor.checks(None, controlled=True) == ['no force was measured yet']
    sensor.checks(10.0, controlled=True)
    found = sensor.checks(None, 60, controlled=True)
    periods = round(SETTINGS.timeout / DT)
    assert found[: periods - 1] == [''] * (periods - 1)
    assert found[periods + 1 :] == ['no force was measured for 0.2 s'] * (59 - periods)
    assert sensor.checks(10.0, controlled=True) == ['']


def test_a_force_that_is_no_number_is_refused() -> None:
    with pytest.raises(InvalidInputError, match=r'force\[2\] is nan'):
        ForceWatch(SETTINGS).measured(np.array([0.0, 0.0, np.nan]))
