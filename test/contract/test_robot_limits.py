"""Every robot: names, limits, home posture, structural data."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from pathlib import Path

import numpy as np
import pytest

from robots_core import (
    BaseRobotModel,
    StructuralData,
    UrdfRobotModel,
)
from robots_core.errors import InvalidInputError, JointLimitError
from robots_core.orientation import ORIENTATION_CONVENTIONS

ARRAYS = (
    'lower',
    'upper',
    'velocity',
    'acceleration',
    'jerk',
    'effort',
    'gear_ratio',
    'rotor_inertia',
)


def test_is_named_like_its_entry_point(robot_name: str, robot: BaseRobotModel):
    assert robot.name == robot_name or robot_name.startswith('urdf:')


def test_has_one_entry_per_axis(robot: BaseRobotModel):
    axes = robot.axes_data
    assert robot.num_axes == axes.num_axes == len(axes.names) == len(set(axes.names)) == len(axes.prismatic)
    for name in ARRAYS:
        assert getattr(axes, name).shape == (robot.num_axes,), name


def test_limits_are_ordered(robot: BaseRobotModel):
    axes = robot.axes_data
    assert (axes.lower < axes.upper).all()
    for name in ('velocity', 'acceleration', 'jerk', 'effort'):
        values = getattr(axes, name)
        assert np.isfinite(values).all(), name
        assert (values > 0.0).all(), name
    assert ((axes.gear_ratio != 0.0) | np.isnan(axes.gear_ratio)).all()
    assert (axes.rotor_inertia >= 0.0).all()


def test_nothing_can_be_written_to(robot: BaseRobotModel):
    arrays = [getattr(robot.axes_data, name) for name in ARRAYS]
    dynamics = robot.rigid_dynamics_model
    arrays += [robot.home, dynamics.masses, dynamics.centers_of_mass, dynamics.inertias]
    for array in arrays:
        with pytest.raises(ValueError, match='read-only'):
            array[...] = 0.0


def test_home_lies_inside_the_limits(robot: BaseRobotModel):
    assert (robot.axes_data.check_position(robot.home) == robot.home).all()


def test_position_beyond_a_limit_is_refused_by_name(robot: BaseRobotModel):
    axes = robot.axes_data
    for index in np.flatnonzero(~axes.continuous):
        q = robot.home.copy()
        q[index] = axes.upper[index] + 0.01
        with pytest.raises(JointLimitError, match=axes.names[index]):
            axes.check_position(q)


def test_structural_data_names_its_source(robot: BaseRobotModel):
    data = robot.structural_data
    assert isinstance(data, StructuralData)
    assert is_dataclass(data)
    assert data.source
    with pytest.raises(AttributeError):
        setattr(data, fields(data)[0].name, 'changed')


def test_orientation_convention_exists(robot: BaseRobotModel):
    assert robot.orientation_convention in ORIENTATION_CONVENTIONS


@pytest.mark.parametrize('bad', [np.nan, np.inf, -np.inf])
def test_values_that_are_not_finite_are_refused(robot: BaseRobotModel, bad: float):
    good = robot.home
    for index in range(robot.num_axes):
        q = robot.home.copy()
        q[index] = bad
        _assert_refused(robot, q, good)


def test_wrong_shapes_are_refused(robot: BaseRobotModel):
    n = robot.num_axes
    for q in (np.zeros(n + 1), np.zeros(n - 1), np.zeros((n, 1)), np.zeros((1, n)), np.array(0.0)):
        _assert_refused(robot, q, robot.home)


def test_numbers_mean_the_same_whatever_array_they_come_in(robot: BaseRobotModel):
    n = robot.num_axes
    q = np.arange(1.0, n + 1.0)
    apart = np.repeat(q, 2)[::2]
    calls = (
        robot.direct_kinematics,
        robot.jacobian,
        lambda q: robot.jacobian_der(q, q),
        lambda q: robot.rigid_dynamics(q, q, q),
        robot.kinematic_model.frame_axes,
        robot.rigid_dynamics_model.mass_matrix,
    )
    kinds = (q.astype(np.int64), q.astype(np.int32), q.astype(np.float32), q.astype('>f8'), apart)
    for call in calls:
        expected = call(q)
        for same in kinds:
            for mine, its in zip(call(same), expected, strict=True):
                np.testing.assert_array_equal(mine, its)


def _assert_refused(robot: BaseRobotModel, bad: np.ndarray, good: np.ndarray) -> None:
    calls = (
        lambda: robot.direct_kinematics(bad),
        lambda: robot.jacobian(bad),
        lambda: robot.jacobian_der(bad, good),
        lambda: robot.jacobian_der(good, bad),
        lambda: robot.rigid_dynamics(bad, good, good),
        lambda: robot.rigid_dynamics(good, bad, good),
        lambda: robot.rigid_dynamics(good, good, bad),
        lambda: robot.kinematic_model.frame_axes(bad),
        lambda: robot.rigid_dynamics_model.torques(bad, good, good),
        lambda: robot.rigid_dynamics_model.torques(good, bad, good),
        lambda: robot.rigid_dynamics_model.torques(good, good, bad),
        lambda: robot.rigid_dynamics_model.mass_matrix(bad),
        lambda: robot.rigid_dynamics_model.bias_torques(bad, good),
        lambda: robot.rigid_dynamics_model.bias_torques(good, bad),
        lambda: robot.axes_data.check_position(bad),
    )
    for call in calls:
        with pytest.raises(InvalidInputError):
            call()


def test_description_parses_again_to_an_equal_robot(
    robot: BaseRobotModel, postures: np.ndarray, tmp_path: Path
):
    file = tmp_path / 'again.urdf'
    file.write_text(robot.description)
    again = UrdfRobotModel(file)
    assert again.axes_data.names == robot.axes_data.names
    for name in ('lower', 'upper', 'velocity', 'effort'):
        np.testing.assert_array_equal(getattr(again.axes_data, name), getattr(robot.axes_data, name))
    for q in postures:
        for mine, its in zip(again.direct_kinematics(q), robot.direct_kinematics(q), strict=True):
            np.testing.assert_array_equal(mine, its)
        np.testing.assert_array_equal(again.rigid_dynamics(q, q, q)[0], robot.rigid_dynamics(q, q, q)[0])
    assert [shape.name for shape in again.visualization.shapes] == [
        shape.name for shape in robot.visualization.shapes
    ]
    assert len(again.collision_model.shapes) == len(robot.collision_model.shapes)
