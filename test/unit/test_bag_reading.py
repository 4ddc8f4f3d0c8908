"""References of a bag as a trajectory: lost messages and late ones."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from robots_controller.recording.bag_reading import late_references, reference_trajectory
from robots_core.errors import RobotsError

PERIOD = 0.004
START = 1_000_000_000  # ns


def reference(due: float, position: float, velocity: float) -> Any:
    sec, nanosec = divmod(START + round(1e9 * due), 1_000_000_000)
    point = SimpleNamespace(
        positions=np.array([position, 0.5]),
        velocities=np.array([velocity, 0.0]),
        accelerations=np.zeros(2),
        time_from_start=SimpleNamespace(sec=0, nanosec=round(1e9 * PERIOD)),
    )
    stamp = SimpleNamespace(sec=sec, nanosec=nanosec)
    return SimpleNamespace(header=SimpleNamespace(stamp=stamp), points=[point])


def moving(ticks: list[int], due: list[int], speed: float = 0.7) -> list[Any]:
    """References of a robot at constant speed: where it is by tick, and when each was due."""
    return [reference(PERIOD * at, speed * PERIOD * tick, speed) for tick, at in zip(ticks, due, strict=True)]


def test_a_lost_message_leaves_a_gap() -> None:
    messages = moving([0, 1, 2, 5, 6], [0, 1, 2, 5, 6])
    trajectory = reference_trajectory(messages)
    np.testing.assert_allclose(trajectory.time, PERIOD * np.array([0, 1, 2, 5, 6]), atol=1e-12)
    assert not late_references(messages).any()
    # The robot moves at its speed across the gap.
    velocity = trajectory.sample(np.linspace(0.0, trajectory.duration, 100))[1][:, 0]
    np.testing.assert_allclose(velocity, 0.7, rtol=1e-6)


def test_a_controller_that_was_held_up_goes_on_from_where_it_was() -> None:
    messages = moving([0, 1, 2, 3, 4], [0, 1, 2, 18, 19])
    trajectory = reference_trajectory(messages)
    np.testing.assert_allclose(trajectory.time, PERIOD * np.arange(5), atol=1e-12)
    np.testing.assert_allclose(late_references(messages), [0.0, 0.0, 0.0, 15 * PERIOD, 0.0], atol=1e-12)
    assert np.abs(trajectory.sample(np.linspace(0.0, trajectory.duration, 100))[2]).max() < 1e-6


def test_a_robot_that_stands_is_never_late() -> None:
    messages = moving([0, 0, 0], [0, 1, 40], speed=0.0)
    assert not late_references(messages).any()
    assert reference_trajectory(messages).duration == pytest.approx(40 * PERIOD)


def test_jitter_of_the_stamps_does_not_matter() -> None:
    messages = [reference(PERIOD * k + (-1) ** k * 0.3 * PERIOD, 0.01 * k, 2.5) for k in range(6)]
    np.testing.assert_allclose(reference_trajectory(messages).time, PERIOD * np.arange(6), atol=1e-12)


def test_one_reference_is_no_trajectory() -> None:
    with pytest.raises(RobotsError, match='1 references make no trajectory'):
        reference_trajectory(moving([0], [0]))
