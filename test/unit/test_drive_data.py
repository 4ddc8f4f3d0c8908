"""DriveData: figures at the motor become figures at the joint."""

from dataclasses import replace

import numpy as np
import pytest

from robots_core import available_robot_models, load_robot_model
from robots_core.errors import InvalidInputError
from robots_core.robot_model.drive_data import DriveData


@pytest.mark.parametrize('name', available_robot_models())
def test_drives_without_figures_follow_from_the_limits(name: str):
    axes = load_robot_model(name).axes_data
    data = DriveData.from_limits(axes)
    np.testing.assert_array_equal(data.torque_limit, axes.effort)
    # On the inertia that effort accelerates at the limit, the speed control has 20 Hz.
    np.testing.assert_allclose(data.velocity_gain * axes.acceleration / axes.effort, 2.0 * np.pi * 20.0)
    assert np.isinf(data.stiffness).all()
    assert data.array.shape == (13, axes.num_axes)


def test_motors_turn_through_their_gears():
    axes = load_robot_model('manutec_r3').axes_data
    data = DriveData.from_motors(
        axes,
        torque_constant=2.0,
        position_gain=5.0,
        speed_gain=0.5,
        integral_time=0.05,
        current_limit=9.0,
        stiffness=10.0,
        damping=0.1,
        current_frequency=1000.0,
        current_damping=0.5,
        resistance=250.0,
    )
    ratio = np.array([105.0, 210.0, 60.0, 99.0, 79.2, 99.0])
    np.testing.assert_allclose(data.velocity_gain, ratio**2 * 2.0 * 0.5)  # N m/A times A s/rad
    np.testing.assert_allclose(data.torque_limit, ratio * 18.0)
    np.testing.assert_allclose(data.inertia, ratio**2 * axes.rotor_inertia)
    np.testing.assert_allclose(data.stiffness, ratio**2 * 10.0)
    np.testing.assert_allclose(data.damping, ratio**2 * 0.1)
    # An inductance of 250 / (2 0.5 1000) = 0.25 H.
    np.testing.assert_allclose(data.back_emf, (2.0 * ratio) ** 2 / 0.25)


def test_bad_figures_are_named():
    axes = load_robot_model('manutec_r3').axes_data
    data = DriveData.from_limits(axes)
    with pytest.raises(InvalidInputError, match=r'stiction 0\.5 of a drive must be finite, 1 or above'):
        replace(data, stiction=np.full(6, 0.5))
    with pytest.raises(InvalidInputError, match='integral_time 0 of a drive must be above 0'):
        replace(data, integral_time=np.zeros(6))
    with pytest.raises(InvalidInputError, match=r'stiffness must have shape \(6,\)'):
        replace(data, stiffness=np.ones(3))
    with pytest.raises(InvalidInputError, match='inertia nan'):
        replace(data, inertia=np.full(6, np.nan))
    gearless = replace(axes, gear_ratio=np.full(6, np.nan))
    with pytest.raises(InvalidInputError, match='has no gear ratio'):
        DriveData.from_motors(
            gearless,
            torque_constant=1.0,
            position_gain=1.0,
            speed_gain=1.0,
            integral_time=1.0,
            current_limit=1.0,
        )
