"""PathSwitches: places on a path as progress of its planned time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots_controller.program.motions.motion_command import Anchor, MotionCommand, PathSwitch
from robots_controller.program.motions.path_switches import PathSwitches, switches_on_path
from robots_core import Pose
from robots_core.validation import Array
from robots_planning.motion_kinds import LINE
from robots_planning.trajectory import Trajectory

EXACT = 1e-5  # s: how exact times of places are


def direct_kinematics(q: Array) -> tuple[Array, Array]:
    """A robot that moves along x and y."""
    return np.array([q[0], q[1], 0.0]), np.eye(3)


def through(*points: Sequence[float], speed: float = 0.5) -> Trajectory:
    """At constant speed from point to point; it turns there at once, which only a test can."""
    q = np.array(points)
    steps = np.diff(q, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    rows: list[tuple[float, Array, Array]] = []
    now = 0.0
    for place, step, length in zip(q[:-1], steps, lengths, strict=True):
        velocity = speed * step / length
        rows += [
            (now, place, velocity),
            (now + length / speed - 1e-9, place + step - 1e-9 * velocity, velocity),
        ]
        now += length / speed
    time, position, rates = (np.array(column) for column in zip(*rows, strict=True))
    return Trajectory(time, position, rates, np.zeros_like(rates))


# 2 m along x in 4 s at constant speed.
LINE_PATH = through([0.0, 0.0], [2.0, 0.0])


def switch(anchor: Anchor, at: float, index: int = 1) -> PathSwitch:
    return PathSwitch(anchor, at, 'digital', index, 1.0)


def command(*switches: PathSwitch, tool: Sequence[float] = ()) -> MotionCommand:
    settings = {'tool': (*tool, 0.0, 0.0, 0.0, 1.0)} if tool else {}
    return MotionCommand(
        LINE, 7, 'ptpCartesianSpace', pose=Pose.identity(), settings=settings, switches=switches
    )


def places(trajectory: Trajectory, *chain: tuple[float, MotionCommand]) -> PathSwitches:
    return switches_on_path(chain, trajectory, direct_kinematics)


def progress(one: PathSwitch, trajectory: Trajectory = LINE_PATH) -> float:
    at = places(trajectory, (trajectory.duration, command(one))).next_progress
    assert at is not None
    return at


@pytest.mark.parametrize(
    ('anchor', 'at', 'expected'),
    [
        ('distance_before_end', 0.5, 0.75),
        ('distance_before_end', 0.0, 1.0),
        ('distance_before_end', 9.0, 0.0),
        ('distance_after_start', 0.5, 0.25),
        ('distance_after_start', 9.0, 1.0),
        ('time_before_end', 1.0, 0.75),
        ('time_after_start', 1.0, 0.25),
        ('time_after_start', 9.0, 1.0),
    ],
)
def test_places_on_a_line(anchor: Anchor, at: float, expected: float):
    assert progress(switch(anchor, at)) == pytest.approx(expected, abs=EXACT / 4.0)


@given(st.floats(0.01, 1.99))
def test_distances_from_both_ends_meet(distance: float):
    # Accelerated, so that time and way are not proportional: x = t^2 / 8.
    time = np.linspace(0.0, 4.0, 3)
    rows = [np.column_stack([row, np.zeros(3)]) for row in (time**2 / 8.0, time / 4.0, np.full(3, 0.25))]
    accelerated = Trajectory(time, *rows)
    start = progress(switch('distance_after_start', distance), accelerated)
    before_end = progress(switch('distance_before_end', 2.0 - distance), accelerated)
    assert start == pytest.approx(before_end, abs=EXACT / 4.0)
    assert start == pytest.approx(np.sqrt(8.0 * distance) / 4.0, abs=EXACT / 4.0)


def test_distances_are_those_along_a_curve():
    # A circle of 20 mm in 40 s, once per second: its steps are long against its radius.
    time = np.linspace(0.0, 40.0, 8001)
    angle, rate, radius = 2.0 * np.pi * time, 2.0 * np.pi, 0.02
    q = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    q_dot = radius * rate * np.column_stack([-np.sin(angle), np.cos(angle)])
    circle = Trajectory(time, q, q_dot, -(rate**2) * q)
    length = 40.0 * rate * radius
    for part in (0.01, 0.3, 0.7):
        # Of the whole length, Richardson's extrapolation leaves less than 1e-5 here.
        assert progress(switch('distance_after_start', part * length), circle) == pytest.approx(
            part, abs=1e-5
        )


def test_tool_that_stands_switches_by_time_alone():
    stands = Trajectory(np.array([0.0, 4.0]), *(np.zeros((2, 2)) for _ in range(3)))
    assert progress(switch('time_after_start', 1.0), stands) == 0.25
    assert progress(switch('distance_before_end', 0.1), stands) == 0.0


def test_switches_come_once_and_in_order():
    first, second = switch('distance_after_start', 0.5, 1), switch('distance_before_end', 0.5, 2)
    switches = places(LINE_PATH, (4.0, command(second, first)))
    assert switches.due(0.2) == []
    assert switches.due(0.3) == [first]
    assert switches.due(1.0) == [second]
    assert switches.due(1.0) == []
    assert switches.next_progress == np.inf


def test_motions_of_a_chain_have_their_own_ends():
    before, after = switch('distance_before_end', 0.25), switch('distance_after_start', 0.25, 2)
    switches = places(LINE_PATH, (2.0, command(before)), (4.0, command(after)))
    assert switches.next_progress == pytest.approx(0.375, abs=EXACT / 4.0)
    assert switches.due(0.5) == [before]
    assert switches.next_progress == pytest.approx(0.625, abs=EXACT / 4.0)


def test_a_place_that_is_passed_twice_is_that_of_its_motion():
    # Out to x = 1 and back: 0.1 m before x = 0.6 on the way out, and on the way back.
    path = through([0.0, 0.0], [1.0, 0.0], [0.0, 0.0])
    out, back = switch('distance_before_end', 0.1, 1), switch('distance_before_end', 0.1, 2)
    still = command()
    chain = [(1.2, command(out)), (2.0, still), (2.8, command(back)), (4.0, still)]
    switches = places(path, *chain)
    assert switches.next_progress == pytest.approx(1.0 / 4.0, abs=EXACT / 4.0)
    assert switches.due(0.5) == [out]
    assert switches.next_progress == pytest.approx(2.6 / 4.0, abs=EXACT / 4.0)


def test_distances_are_those_of_the_motions_own_tool():
    # tool0 stands while it turns: only a tool away from its axis moves.
    def turning(q: Array) -> tuple[Array, Array]:
        pose = Pose.from_angles([0.0, 0.0, 0.0], [q[0], 0.0, 0.0])
        return pose.r, pose.T

    quarter = through([0.0, 0.0], [0.5 * np.pi, 0.0])
    after = switch('distance_after_start', 0.05 * np.pi)
    long = command(after, tool=(0.4, 0.0, 0.0))
    at = switches_on_path([(quarter.duration, long)], quarter, turning).next_progress
    assert at == pytest.approx(0.25, abs=EXACT)


def test_delay_is_that_of_the_speed_so_far():
    switches = places(LINE_PATH, (4.0, command(switch('distance_before_end', 0.5))))
    assert switches.delay(10.0, 0.50) == np.inf
    assert switches.delay(10.4, 0.55) == pytest.approx(0.2 * 8.0, abs=2.0 * EXACT)  # half as fast as planned
    assert switches.delay(10.8, 0.55) == np.inf  # held
    assert switches.delay(12.8, 0.80) == 0.0


def test_progress_that_comes_late_in_a_burst_does_not_hasten_the_switch():
    switches = places(LINE_PATH, (4.0, command(switch('distance_before_end', 0.5))))
    switches.delay(10.0, 0.50)
    # Told a hundredth of the time after the one before: as fast as planned the robot is, and no faster.
    assert switches.delay(10.001, 0.55) == pytest.approx(0.2 * 4.0, abs=EXACT)
