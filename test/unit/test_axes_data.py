"""AxesData: complete, consistent, or refused by the name of the axis."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from robots_core import AxesData
from robots_core.errors import InvalidInputError, JointLimitError

GOOD: dict[str, Any] = {
    'names': ('turn', 'slide', 'spin'),
    'lower': [-1.0, 0.0, -np.inf],
    'upper': [2.0, 0.5, np.inf],
    'velocity': [1.0, 2.0, 3.0],
    'acceleration': [1.0, 2.0, 3.0],
    'jerk': [1.0, 2.0, 3.0],
    'effort': [1.0, 2.0, 3.0],
    'prismatic': (False, True, False),
}


def _axes(**changes: Any) -> AxesData:
    return AxesData(**{**GOOD, **changes})


def test_what_is_not_published_has_a_default():
    axes = _axes()
    assert np.isnan(axes.gear_ratio).all()
    np.testing.assert_array_equal(axes.rotor_inertia, 0.0)
    assert AxesData(**{**GOOD, 'prismatic': ()}).prismatic == (False, False, False)


def test_friction_and_rotors_are_there_or_zero():
    axes = _axes(
        gear_ratio=[-100.0, np.nan, 50.0], rotor_inertia=[1e-3, 0.0, 2e-3], coulomb_friction=[1, 2, 3]
    )
    np.testing.assert_allclose(axes.reflected_inertia, [10.0, 0.0, 5.0])
    np.testing.assert_array_equal(axes.coulomb_friction, [1.0, 2.0, 3.0])
    np.testing.assert_array_equal(axes.viscous_friction, 0.0)
    for quantity in ('rotor_inertia', 'coulomb_friction', 'viscous_friction'):
        for bad in (-1.0, np.nan, np.inf):
            with pytest.raises(InvalidInputError, match=f'axis slide: {quantity}'):
                _axes(**{quantity: [0.0, bad, 0.0]})


def test_units_and_kinds_of_axes():
    axes = _axes()
    assert [axes.unit(index) for index in range(axes.num_axes)] == ['rad', 'm', 'rad']
    np.testing.assert_array_equal(axes.continuous, [False, False, True])


@pytest.mark.parametrize(
    ('changes', 'message'),
    [
        ({'names': ()}, 'at least one axis'),
        ({'velocity': [1.0, 2.0]}, r'AxesData.velocity must have shape \(3,\), got \(2,\)'),
        ({'gear_ratio': [100.0]}, r'AxesData.gear_ratio must have shape'),
        ({'lower': [2.0, 0.0, -np.inf]}, 'axis turn: lower limit 2 must be below upper limit 2'),
        ({'upper': [np.nan, 0.5, np.inf]}, 'axis turn'),
        ({'upper': [2.0, np.inf, np.inf]}, r'axis slide: limits \[0, inf\]'),
        ({'velocity': [1.0, 0.0, 3.0]}, 'axis slide: velocity limit 0'),
        ({'acceleration': [1.0, -1.0, 3.0]}, 'axis slide: acceleration limit -1'),
        ({'jerk': [1.0, 2.0, np.nan]}, 'axis spin: jerk limit nan'),
        ({'effort': [np.inf, 2.0, 3.0]}, 'axis turn: effort limit inf'),
    ],
)
def test_inconsistent_data_is_refused(changes: dict[str, Any], message: str):
    with pytest.raises(InvalidInputError, match=message):
        _axes(**changes)


def test_limits_belong_to_the_range():
    axes = _axes()
    for q in ([-1.0, 0.0, -1e6], [2.0, 0.5, 1e6]):
        np.testing.assert_array_equal(axes.check_position(q), q)


def test_position_outside_names_axis_value_and_limits():
    with pytest.raises(JointLimitError, match=r'slide = 0.6 m is outside its limits \[0, 0.5\] m') as caught:
        _axes().check_position([0.0, 0.6, 0.0])
    assert caught.value.details == {'joint': 'slide', 'value': 0.6, 'lower': 0.0, 'upper': 0.5, 'unit': 'm'}


@pytest.mark.parametrize('bad', [[0.0, 0.1], [0.0, 0.1, np.nan], [0.0, 0.1, np.inf]])
def test_position_that_is_none_is_refused(bad: list[float]):
    with pytest.raises(InvalidInputError):
        _axes().check_position(bad)
