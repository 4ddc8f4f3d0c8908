"""A robot behind a driver follows references late but smoothly, and stops by itself when they end."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from robots_core import load_robot_model
from robots_core.blocks.drives.driver_drives import DriverDrives, stopping_trajectory
from robots_core.blocks.drives.supervised_drives import DriveState, SupervisedDrives
from robots_planning import LinearJoint
from trajectory_controller_double import TrajectoryControllerDouble

ROBOT = load_robot_model('ur5e')
AXES = ROBOT.axes_data
PERIOD, LEAD = 0.004, 0.02
fractions = st.lists(st.integers(-100, 100), min_size=6, max_size=6).map(lambda row: 0.01 * np.array(row))


@given(
    place=fractions,
    speed=st.one_of(fractions, fractions.map(lambda row: 1e-9 * row)),
    lead=st.floats(0.001, 0.5),
)
def test_a_trajectory_ends_at_rest_within_the_limits(
    place: np.ndarray, speed: np.ndarray, lead: float
) -> None:
    low, high = AXES.one_turn
    q_dot = speed * AXES.velocity
    room = 0.5 * (np.abs(q_dot) / AXES.acceleration).max() * np.abs(q_dot)
    q = np.clip(0.5 * (low + high) + 0.5 * place * (high - low), low + room, high - room)
    points = stopping_trajectory(q, q_dot, AXES, lead)
    start, end = points[0], points[-1]
    assert start[0] == lead
    assert (np.diff([time for time, _, _ in points]) >= 1e-6).all()
    np.testing.assert_array_equal(start[1], q)
    assert not end[2].any()
    controller = TrajectoryControllerDouble(AXES.names, q)
    assert controller.put(1.0, AXES.names, points) == ''
    times = np.linspace(1.0 + lead, 1.0 + end[0], 20)[:-1]
    states = np.array([controller.step(time) for time in times])
    if len(points) == 2:
        braking = np.abs(np.diff(states[:, 1], axis=0) / np.diff(times)[:, None])
        # Rounding of differences of velocities over short times.
        assert (braking <= AXES.acceleration * (1.0 + 1e-9) + 1e-12 / np.diff(times)[:, None]).all()
    np.testing.assert_allclose(controller.step(10.0)[0], end[1])


@settings(max_examples=30)
@given(
    target=fractions,
    delays=st.lists(st.integers(0, 4), min_size=20, max_size=20),
    ends=st.one_of(st.none(), st.floats(0.1, 0.9)),
)
def test_a_robot_follows_references_that_come_irregularly(
    target: np.ndarray, delays: list[int], ends: float | None
) -> None:
    motion = LinearJoint(ROBOT).generate(ROBOT.home, ROBOT.home + 0.3 * target)
    drives = DriverDrives(ROBOT.home)
    supervised = SupervisedDrives(drives, AXES, period=PERIOD)
    controller = TrajectoryControllerDouble(AXES.names, ROBOT.home)
    last = int(np.ceil(motion.duration / PERIOD))
    until = last if ends is None else round(ends * last)
    behind = []
    for k in range(last + 150):
        now = 1.0 + k * PERIOD
        drives.position = controller.step(now)[0]
        sample = motion.sample(min(k, last) * PERIOD)
        if k > until and ends is not None:
            supervised.step(now, None)
        else:
            supervised.step(now, sample[0], sample[1], now)
        if drives.command is not None:
            points = stopping_trajectory(*drives.command, AXES, LEAD)
            received = now + 1e-3 * delays[k % len(delays)]
            assert controller.put(received, AXES.names, points) == ''
        if k <= until:
            behind.append(np.abs(controller.step(now + PERIOD)[0] - sample[0]))
    # As far as the fastest axis comes within the lead, twice that while it accelerates.
    assert (np.max(behind, axis=0) <= 2.0 * LEAD * np.abs(motion.velocity).max(axis=0) + 1e-9).all()
    assert not controller.step(100.0)[1].any()
    if ends is None:
        np.testing.assert_allclose(controller.step(100.0)[0], motion.position[-1], atol=1e-9)
    else:
        assert supervised.state is DriveState.BRAKED
