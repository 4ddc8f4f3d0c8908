"""BaseMotion: free fall in base axes."""

import numpy as np
import pytest

from robots_core.blocks.multibody.base_motion import BaseMotion
from robots_core.errors import InvalidInputError

GRAVITY = np.array([0.0, 0.0, -9.81])


@pytest.mark.parametrize(
    ('base', 'fall'),
    [
        (BaseMotion(), [0.0, 0.0, -9.81]),
        (BaseMotion.ceiling(), [0.0, 0.0, 9.81]),
        # z of the base along the world's x, x of the base along the world's -z: down is its x.
        (BaseMotion.wall(), [9.81, 0.0, 0.0]),
        # In free fall nothing falls any more, seen from the base.
        (BaseMotion(acceleration=GRAVITY), [0.0, 0.0, 0.0]),
        (BaseMotion(acceleration=[1.0, 0.0, 0.0]), [-1.0, 0.0, -9.81]),
    ],
)
def test_fall_is_seen_from_the_base(base: BaseMotion, fall: list[float]):
    np.testing.assert_allclose(base.free_fall(GRAVITY), fall, atol=1e-15 * 9.81 * 10)


def test_a_base_turns_with_a_speed_or_an_acceleration():
    assert not BaseMotion.wall().turns
    assert BaseMotion(angular_velocity=[0.0, 0.0, 1.0]).turns
    assert BaseMotion(angular_acceleration=[0.0, 0.0, 1.0]).turns


def test_bad_values_are_named():
    with pytest.raises(InvalidInputError, match='not a rotation matrix'):
        BaseMotion(2.0 * np.eye(3))
    for name in ('acceleration', 'angular_velocity', 'angular_acceleration'):
        with pytest.raises(InvalidInputError, match=name):
            BaseMotion(**{name: [0.0, np.nan, 0.0]})
