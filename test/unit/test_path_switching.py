"""PathSwitching: outputs switch by the controller's progress, and between its reports by extrapolation."""

from __future__ import annotations

import math
from dataclasses import replace
from unittest.mock import Mock

import numpy as np
import pytest

from robots_controller.cell import program_host
from robots_controller.cell.path_switching import PathSwitching
from robots_controller.program.motions.motion_command import MotionCommand, OutputChange, PathSwitch
from robots_core import Pose
from robots_core.validation import Array
from robots_planning.motion_kinds import LINE
from robots_planning.trajectory import Trajectory

LENGTH, DURATION = 2.0, 4.0  # m and s of each motion


def direct_kinematics(q: Array) -> tuple[Array, Array]:
    """A robot of one axis, along x."""
    return np.array([q[0], 0.0, 0.0]), np.eye(3)


def command(end: float, *distances: float) -> MotionCommand:
    """A motion that switches output 1, 2, ... at these distances from its start."""
    switches = tuple(
        PathSwitch('distance_after_start', distance, 'digital', index, 1.0)
        for index, distance in enumerate(distances, 1)
    )
    return MotionCommand(
        LINE, 7, 'ptpCartesianSpace', pose=Pose(np.array([end, 0.0, 0.0]), np.eye(3)), switches=switches
    )


def line(start: float, end: float) -> Trajectory:
    """At constant speed."""
    time = np.linspace(0.0, DURATION, 5)
    q = np.linspace(start, end, 5)[:, np.newaxis]
    return Trajectory(time, q, np.full_like(q, (end - start) / DURATION), np.zeros_like(q))


class Bench:
    def __init__(self) -> None:
        self.switched: list[OutputChange] = []
        self.switching = PathSwitching(direct_kinematics, self.switched.append)

    @property
    def indices(self) -> list[int]:
        return [change.index for change in self.switched]

    def plan(self, id_: str, *distances: float, start: float = 0.0) -> None:
        self.switching.sent(id_, command(start + LENGTH, *distances))
        self.switching.planned(id_, {id_: DURATION}, lambda: line(start, start + LENGTH))


@pytest.fixture
def bench() -> Bench:
    return Bench()


def test_outputs_switch_once_in_the_period_in_which_their_place_is_reached(bench: Bench) -> None:
    bench.plan('1', 0.5, 1.0)
    for progress, count in ((0.0, 0), (0.249, 0), (0.251, 1), (0.3, 1), (0.499, 1), (0.501, 2), (0.999, 2)):
        bench.switching.progress(DURATION * progress, progress)
        assert len(bench.switched) == count
    assert bench.switched[0] == OutputChange('digital', 1, 1.0, 7)
    bench.switching.finish('1', ok=True)
    assert bench.indices == [1, 2]


def test_what_is_left_switches_at_the_end(bench: Bench) -> None:
    bench.plan('1', 0.5, 2.0)
    bench.switching.finish('1', ok=True)
    assert bench.indices == [1, 2]


def test_a_motion_that_fails_switches_nothing_and_neither_do_those_after_it(bench: Bench) -> None:
    bench.plan('1', 0.5)
    bench.plan('2', 0.5, start=LENGTH)
    bench.switching.finish('1', ok=False)
    bench.switching.progress(1.0, 0.9)
    bench.switching.finish('2', ok=True)
    assert not bench.switched


def test_a_motion_that_is_refused_leaves_those_before_it_their_outputs(bench: Bench) -> None:
    bench.plan('1', 0.5)
    bench.switching.sent('2', command(LENGTH, 0.5))
    bench.switching.sent('3', command(LENGTH, 0.5))
    bench.switching.finish('2', ok=False)
    bench.switching.finish('3', ok=False)
    bench.switching.progress(1.0, 0.9)
    bench.switching.finish('1', ok=True)
    assert bench.indices == [1]


def test_progress_is_that_of_the_oldest_motion(bench: Bench) -> None:
    bench.plan('1', 1.9)
    bench.plan('2', 0.1, start=LENGTH)
    bench.switching.progress(1.0, 0.5)
    assert not bench.switched
    bench.switching.finish('1', ok=True)
    assert bench.indices == [1]
    bench.switching.progress(4.5, 0.5)
    assert bench.indices == [1, 1]


def test_a_chain_switches_by_its_own_plan(bench: Bench) -> None:
    bench.switching.sent('1', command(1.0, 0.5))
    bench.switching.sent('2', command(LENGTH, 0.5))  # 1.5 m from the start
    bench.switching.planned('2', {'1': 0.5 * DURATION, '2': DURATION}, lambda: line(0.0, LENGTH))
    bench.switching.progress(1.0, 0.3)
    assert bench.indices == [1]
    bench.switching.progress(2.0, 0.7)
    assert bench.indices == [1]
    bench.switching.progress(3.0, 0.8)
    assert bench.indices == [1, 1]


def test_places_of_motions_that_are_carried_on_are_those_of_the_later_plan(bench: Bench) -> None:
    half = 0.5 * DURATION
    for id_ in '123':
        # The same switches in each, all of them equal.
        bench.switching.sent(id_, command(LENGTH, 0.0, 0.5))
    first = {'1': half, '2': DURATION}
    assert bench.switching.waits_for('1')
    bench.switching.planned('1', first, lambda: line(0.0, LENGTH))
    assert not bench.switching.waits_for('1')
    assert bench.switching.waits_for('2')
    bench.switching.progress(1.0, 0.3)
    assert bench.indices == [1, 2]
    bench.switching.planned('3', {'2': half, '3': DURATION}, lambda: line(0.5 * LENGTH, 1.5 * LENGTH))
    bench.switching.progress(2.0, 0.499)
    bench.switching.finish('1', ok=True)
    assert bench.indices == [1, 2]
    bench.switching.progress(2.1, 0.01)
    assert bench.indices == [1, 2, 1]
    bench.switching.progress(3.1, 0.3)
    assert bench.indices == [1, 2, 1, 2]
    bench.switching.finish('2', ok=True)
    assert bench.indices == [1, 2, 1, 2]
    bench.switching.finish('3', ok=True)
    assert bench.indices == [1, 2] * 3


def test_a_switch_between_two_reports_comes_at_its_time(bench: Bench) -> None:
    bench.plan('1', 1.0)
    switching = bench.switching
    switching.progress(10.0, 0.48)
    assert switching.next_time == math.inf
    switching.progress(10.04, 0.49)
    assert switching.next_time == pytest.approx(10.08)
    switching.step(10.07)
    assert not bench.switched
    switching.step(10.08)
    assert bench.indices == [1]
    assert switching.next_time == math.inf
    switching.progress(10.08, 0.5)
    assert bench.indices == [1]


def test_plans_are_looked_at_only_where_outputs_are_switched(bench: Bench) -> None:
    def plan() -> Trajectory:
        raise AssertionError

    bench.switching.sent('1', command(LENGTH))
    bench.switching.planned('1', {'1': DURATION}, plan)
    bench.switching.planned('of another', {'of another': DURATION}, plan)
    bench.switching.progress(1.0, 0.5)
    bench.switching.finish('1', ok=True)
    assert not bench.switched


@pytest.mark.parametrize(('blend', 'distances', 'loads'), [(0.0, (), 0), (0.1, (), 1), (0.0, (0.5,), 1)])
def test_what_a_plan_with_switches_needs_is_loaded_before_the_motion_is_sent(
    monkeypatch: pytest.MonkeyPatch, blend: float, distances: tuple[float, ...], loads: int
) -> None:
    calls: list[str] = []
    monkeypatch.setattr(program_host, 'warm_up', lambda _: calls.append('load'))
    host = Mock(_files={}, program=Mock(stopping=False), motions=Mock(send=lambda _: calls.append('send')))
    program_host.ProgramHost.command(host, replace(command(LENGTH, *distances), blend=blend))
    assert calls == [*['load'] * loads, 'send']


def test_without_a_valid_plan_outputs_switch_at_the_end(bench: Bench) -> None:
    bench.switching.sent('1', command(LENGTH, 0.5))
    bench.switching.finish('1', ok=True)
    assert bench.indices == [1]
