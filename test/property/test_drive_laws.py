"""Drives refuse no references that keep the limits, whatever messages are lost, and stay near them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robots_core import load_robot_model
from robots_core.blocks.drives.drive_choice import drive_train
from robots_core.blocks.drives.supervised_drives import (
    MAX_EXTRAPOLATED,
    RESERVE,
    DriveState,
    SupervisedDrives,
)
from robots_core.periodic.periodic_schedule import MAX_LATE_PERIODS
from robots_core.validation import Array

ROBOT = load_robot_model('ur5e')
AXES = ROBOT.axes_data
LOW, HIGH = AXES.one_turn
START = 0.5 * (LOW + HIGH)
ROOM = 0.25 * (HIGH - LOW)
EPOCH = 1.7e9  # s: stamps have the resolution of the time of day
fractions = st.lists(st.integers(-100, 100), min_size=6, max_size=6).map(lambda row: 0.01 * np.array(row))


@dataclass(frozen=True)
class Message:
    """A reference on its way."""

    sent: int  # period
    q: Array
    q_dot: Array
    stamp: float


def sent(targets: list[Array], held_up: list[int], period: float) -> Iterator[Message]:
    """References that change their velocities as fast as the limits permit, and come to rest.

    Args:
        targets: Velocities, as parts of their limits, 20 periods each.
        held_up: For each target, so many periods in which the sender is held up in the middle of it.
        period: s.
    """
    q, velocity, k = START, np.zeros(6), 0
    most = period * AXES.acceleration
    for target, pause in zip([*targets, np.zeros(6)], [*held_up, 0], strict=True):
        left = 20
        while left > 0 or (velocity.any() and not target.any()):
            wanted = np.where(np.abs(q - START) > ROOM, np.copysign(target, START - q), target)
            after = velocity + np.clip(wanted * AXES.velocity - velocity, -most, most)
            q = q + period * after
            # In the middle of a change, the velocity at the stamp is that between two means.
            yield Message(
                k, q, after + np.clip(after - velocity, -0.5 * most, 0.5 * most), EPOCH + k * period
            )
            velocity, k, left = after, k + 1, left - 1
            if left == 10 and pause:
                k += MAX_LATE_PERIODS + 1 + pause
    for _ in range(5):
        yield Message(k, q, velocity, EPOCH + k * period)
        k += 1


def drives(period: float) -> SupervisedDrives:
    """Ideal drives, which move exactly as they are given."""
    return SupervisedDrives(
        drive_train('ideal', ROBOT, START, period=period), AXES, period=period, timeout=np.inf
    )


def check_limits(positions: list[Array], period: float, reserve: float = 0.0) -> None:
    """By plain differences."""
    velocity = np.diff([START, START, *positions], axis=0) / period
    assert (np.abs(velocity) <= AXES.velocity * (1.0 + 2e-6)).all()
    most = AXES.acceleration * (1.0 + reserve) * (1.0 + 2e-6)
    assert (np.abs(np.diff(velocity, axis=0)) / period <= most).all()


@settings(max_examples=60, deadline=None)
@given(
    targets=st.lists(fractions, min_size=1, max_size=4),
    held_up=st.lists(st.integers(0, 3), min_size=4, max_size=4),
    lost=st.lists(st.booleans(), min_size=1, max_size=40),
    late=st.lists(st.integers(0, 3), min_size=1, max_size=20),
    period=st.sampled_from([0.001, 0.004, 0.01]),
)
def test_references_inside_the_limits_are_never_refused(
    targets: list[Array], held_up: list[int], lost: list[bool], late: list[int], period: float
) -> None:
    supervised = drives(period)
    supervised.step(0.0, START, np.zeros(6), EPOCH - period)
    arrivals: dict[int, Message] = {}
    messages = list(sent(targets, held_up[: len(targets)], period))
    last = messages[-1].sent
    for k, message in enumerate(messages):
        if not lost[k % len(lost)]:
            arrivals[message.sent + late[k % len(late)]] = message  # the drives take the newest one
    positions = []
    for k in range(last + 400):
        arrived = arrivals.get(k)
        if k > last + max(late):
            arrived = Message(k, messages[-1].q, messages[-1].q_dot, EPOCH + k * period)
        now = period * (k + 1)
        if arrived is None:
            position, _ = supervised.step(now, None)
        else:
            position, _ = supervised.step(now, arrived.q, arrived.q_dot, arrived.stamp)
            assert supervised.problem == ''
        positions.append(position.copy())
    check_limits(positions, period, RESERVE)
    assert supervised.state is DriveState.FOLLOWING
    np.testing.assert_array_equal(positions[-1], messages[-1].q)


@given(
    targets=st.lists(fractions, min_size=1, max_size=4),
    first=st.integers(1, 80),
    lost=st.integers(1, MAX_EXTRAPOLATED),
    period=st.sampled_from([0.001, 0.004, 0.01]),
)
def test_drives_return_to_their_references_soon_after_some_were_lost(
    targets: list[Array], first: int, lost: int, period: float
) -> None:
    """They are off by what a changed reference has gone meanwhile, and by what they take to turn after it."""
    supervised = drives(period)
    supervised.step(0.0, START, np.zeros(6), EPOCH - period)
    most = 1.5 * AXES.acceleration * (period * (lost + 1)) ** 2
    for message in sent(targets, [0] * len(targets), period):
        now, gone = period * (message.sent + 1), 0 <= message.sent - first < lost
        if gone:
            position, _ = supervised.step(now, None)
        else:
            position, _ = supervised.step(now, message.q, message.q_dot, message.stamp)
        assert (np.abs(position - message.q) <= most).all()
        if not gone and message.sent - first >= 13 * lost:
            assert supervised.state is DriveState.FOLLOWING


@given(targets=st.lists(fractions, min_size=1, max_size=3), period=st.sampled_from([0.001, 0.004]))
def test_references_that_come_one_in_each_period_are_followed_as_they_are(
    targets: list[Array], period: float
) -> None:
    supervised = drives(period)
    supervised.step(0.0, START, np.zeros(6), EPOCH - period)
    for message in sent(targets, [0] * len(targets), period):
        now = period * (message.sent + 1)
        position, _ = supervised.step(now, message.q, message.q_dot, message.stamp)
        np.testing.assert_array_equal(position, message.q)
        assert supervised.state is DriveState.FOLLOWING


@given(
    axis=st.integers(0, 5),
    speed=st.floats(0.2, 1.0),
    jump=st.sampled_from(['reversed', 'at rest', 'a step']),
    lost=st.integers(0, 2),
)
def test_a_jump_of_the_velocity_is_refused_and_the_drives_ramp_down(
    axis: int, speed: float, jump: str, lost: int
) -> None:
    period = 0.004
    supervised, q = drives(period), START.copy()
    supervised.step(0.0, q, np.zeros(6), EPOCH - period)
    velocity, positions, k = np.zeros(6), [], 0
    most = period * AXES.acceleration[axis]
    while velocity[axis] < speed * AXES.velocity[axis]:
        after = velocity.copy()
        after[axis] = min(velocity[axis] + most, speed * AXES.velocity[axis])
        q = q + 0.5 * period * (velocity + after)
        velocity = after
        position, _ = supervised.step(period * (k + 1), q, velocity, EPOCH + k * period)
        positions.append(position.copy())
        k += 1
    jumped = {'reversed': -velocity, 'at rest': np.zeros(6), 'a step': velocity}[jump]
    if jump == 'a step':
        # As far as it may go within two periods at full speed.
        q = q + 2.0 * period * np.where(np.arange(6) == axis, AXES.velocity, 0.0)
    for _ in range(lost):
        positions.append(supervised.step(period * (k + 1), None)[0].copy())
        k += 1
    for n in range(1, MAX_EXTRAPOLATED - lost + 2):
        reference = q + (n + lost) * period * jumped
        stamp = EPOCH + k * period
        positions.append(supervised.step(period * (k + 1), reference, jumped, stamp)[0].copy())
        k += 1
        if n == 1 and (jump == 'reversed' or lost == 0):
            assert supervised.problem.startswith(f'reference refused: {AXES.names[axis]} would ')
            assert 'rad/s' in supervised.problem
    if jump == 'reversed':
        assert supervised.state is DriveState.RAMPING
    for _ in range(400):
        positions.append(supervised.step(period * (k + 1), None)[0].copy())
        k += 1
    check_limits(positions, period)
    assert not supervised.drives.velocity.any()


def test_the_refusal_names_axis_value_and_bound() -> None:
    period = 0.004
    supervised = drives(period)
    supervised.step(0.0, START, np.zeros(6), EPOCH)
    step = np.array([0.0, 0.0, 2.0 * period * AXES.velocity[2], 0.0, 0.0, 0.0])
    supervised.step(period, START + step, np.zeros(6), EPOCH + period)
    name, limit = AXES.names[2], AXES.velocity[2]
    assert supervised.problem == (
        f'reference refused: {name} would move at {2.0 * limit:.4g} rad/s, its limit is {limit:.4g} rad/s'
    )
    supervised.step(2.0 * period, START + 0.1 * step, np.zeros(6), EPOCH + period)  # nothing is known
    supervised.step(3.0 * period, START, np.zeros(6), EPOCH + 2.0 * period)
    half = 0.25 * step
    supervised.step(4.0 * period, START + half, np.zeros(6), EPOCH + 3.0 * period)
    assert f'{name} would accelerate at ' in supervised.problem
    assert supervised.problem.endswith(' rad/s^2')


@pytest.mark.parametrize('stamp', [None, 0.0])
def test_references_without_stamps_are_caught_up_with_inside_the_limits(stamp: float | None) -> None:
    period = 0.004
    supervised = drives(period)
    supervised.step(0.0, START, np.zeros(6), stamp)
    positions = []
    for k in range(400):
        q = START + (period * AXES.velocity if k > 5 else 0.0)
        positions.append(supervised.step(period * (k + 1), q, np.zeros(6), stamp)[0].copy())
    check_limits(positions, period, RESERVE)
    np.testing.assert_array_equal(positions[-1], START + period * AXES.velocity)
