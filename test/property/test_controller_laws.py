"""Laws of the controller: on the path, inside the limits, never refused, whatever the operator does."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ruckig import InputParameter, Ruckig
from ruckig import Trajectory as RuckigTrajectory

from robots_controller.control.controller import Controller, ControllerSettings, ControllerState
from robots_controller.control.followed_motion import FollowedMotion
from robots_core.blocks.drives.drive_train import IdealDrive
from robots_core.blocks.drives.supervised_drives import REFUSED, SupervisedDrives
from robots_core.robot_model.axes_data import AxesData
from robots_planning.trajectory import Trajectory

AXES = AxesData(
    names=('A1', 'A2', 'A3'),
    lower=np.array([-3.0, -2.0, -1.5]),
    upper=np.array([3.0, 2.0, 1.5]),
    velocity=np.array([2.0, 1.0, 3.0]),
    acceleration=np.array([2.0, 1.2, 7.0]),
    jerk=np.array([20.0, 12.0, 70.0]),
    effort=np.ones(3),
)
START = np.array([0.1, -0.2, 0.3])
# The guard's own tolerance: rounding of second differences.
WITHIN = 1.0 + 2e-6


def ruckig_move(start: np.ndarray, target: np.ndarray) -> Trajectory:
    """A motion that uses the limits to the full, with its jerk switches among the points."""
    away = target - start
    problem = InputParameter(1)
    problem.current_position, problem.target_position = [0.0], [1.0]
    # Planners leave this margin for what the quintics between the points make of the profile's corners.
    problem.max_velocity = [0.999 * float((AXES.velocity / np.maximum(np.abs(away), 1e-9)).min())]
    problem.max_acceleration = [0.999 * float((AXES.acceleration / np.maximum(np.abs(away), 1e-9)).min())]
    problem.max_jerk = [float((AXES.jerk / np.maximum(np.abs(away), 1e-9)).min())]
    motion = RuckigTrajectory(1)
    Ruckig(1).calculate(problem, motion)
    switches = np.cumsum([0.0, *motion.profiles[0][0].t])
    times = [0.0]
    for t in np.unique(np.append(np.arange(0.02, motion.duration, 0.02), switches)):
        # Second derivatives of a polynomial over h carry rounding of about 1e-15 / h^2.
        if times[-1] + 1e-4 < t < motion.duration - 1e-4:
            times.append(float(t))
    grid = np.array([*times, motion.duration])
    s, s_dot, s_ddot = np.array([motion.at_time(t)[:3] for t in grid])[:, :, 0].T
    return Trajectory(grid, start + np.outer(s, away), np.outer(s_dot, away), np.outer(s_ddot, away))


class Rig:
    """A controller with drives that follow at once and refuse nothing, stepped by hand."""

    def __init__(self, **settings: float) -> None:
        self.controller = Controller(AXES, ControllerSettings(**settings))
        self.dt = self.controller.settings.period
        self.now = 0.0
        self.feedback: np.ndarray | None = START.copy()
        self.references: list[np.ndarray] = []
        self.drives = SupervisedDrives(IdealDrive(START, period=self.dt), AXES, period=self.dt)
        self.step()

    def step(self) -> np.ndarray:
        self.now += self.dt
        reference = self.controller.step(self.now, self.feedback)
        assert reference is not None
        if self.feedback is not None:
            self.feedback = reference[0].copy()
        self.references.append(reference.copy())
        self.drives.power(on=self.controller.stops.state.drives_on)
        self.drives.step(self.now, reference[0], reference[1])
        assert not self.drives.problem.startswith(REFUSED), self.drives.problem
        return reference

    def run(self, *, limit: float = 60.0) -> None:
        """Step until the motion has ended."""
        end = self.now + limit
        while not self.controller.outcomes:
            self.step()
            assert self.now < end, 'the motion does not end'

    def check_limits(self) -> None:
        position = np.array([r[0] for r in self.references])
        velocity = np.diff(position, axis=0) / self.dt
        acceleration = np.diff(velocity, axis=0) / self.dt
        sent = np.array([r[1] for r in self.references])
        off = np.abs(velocity - (sent[1:] + sent[:-1]) / 2.0)
        # Speeds change evenly within a period, but where only second differences hold the change back.
        assert np.max(off / (AXES.acceleration * self.dt)) <= 0.06
        assert np.max(np.abs(velocity) / AXES.velocity) <= WITHIN
        assert np.max(np.abs(acceleration) / AXES.acceleration) <= WITHIN

    def distance_to_line(self, target: np.ndarray) -> float:
        """Largest distance of the references to the straight joint-space line."""
        direction = (target - START) / np.linalg.norm(target - START)
        away = np.array([r[0] for r in self.references]) - START
        return float(np.linalg.norm(away - np.outer(away @ direction, direction), axis=1).max())


targets = st.tuples(
    *(st.floats(0.95 * low, 0.95 * high) for low, high in zip(AXES.lower, AXES.upper, strict=True))
)
periods = st.sampled_from([0.002, 0.004, 0.01])


@settings(max_examples=25)
@given(
    target=targets,
    period=periods,
    smoothing=st.sampled_from([0.0, 0.02]),
    overrides=st.lists(st.tuples(st.integers(1, 150), st.floats(0.0, 1.0)), max_size=6),
)
def test_any_override_keeps_limits_and_path_and_reaches_the_target(
    target: tuple[float, ...], period: float, smoothing: float, overrides: list[tuple[int, float]]
) -> None:
    goal = np.array(target)
    if np.linalg.norm(goal - START) < 1e-3:
        return
    rig = Rig(period=period, smoothing_time=smoothing)
    rig.controller.follow(FollowedMotion(ruckig_move(START, goal), 'a'), rig.now)
    for steps, override in overrides:
        rig.controller.speed.set_override(override)
        for _ in range(steps):
            rig.step()
    rig.controller.speed.set_override(1.0)
    rig.run()
    outcome = rig.controller.outcomes[0]
    assert outcome.ok, outcome.message
    rig.check_limits()
    assert rig.distance_to_line(goal) < 1e-9  # the smoothing stays on a straight line: rounding only
    np.testing.assert_allclose(rig.references[-1][0], goal, atol=1e-12)
    assert np.all(rig.references[-1][1:] == 0.0)


@settings(max_examples=25)
@given(target=targets, after=st.integers(1, 400), how=st.sampled_from(['pause', 'cancel', 'lost feedback']))
def test_whatever_stops_it_stops_on_the_path(target: tuple[float, ...], after: int, how: str) -> None:
    goal = np.array(target)
    if np.linalg.norm(goal - START) < 1e-3:
        return
    rig = Rig(period=0.004)
    rig.controller.follow(FollowedMotion(ruckig_move(START, goal), 'a'), rig.now)
    for _ in range(after):
        rig.step()
        if rig.controller.outcomes:
            return
    if how == 'pause':
        rig.controller.speed.paused = True
        for _ in range(1000):
            rig.step()
    elif how == 'cancel':
        rig.controller.cancel('enough')
        rig.run()
        assert rig.controller.outcomes[0].message == 'enough'
    else:
        rig.feedback = None
        rig.run()
        assert 'no feedback' in rig.controller.outcomes[0].message
    rig.check_limits()
    assert rig.distance_to_line(goal) < 1e-9
    assert np.all(np.array(rig.references[-1][1:]) == 0.0)
    if how == 'pause' and not rig.controller.outcomes:
        rig.controller.speed.paused = False
        rig.run()
        assert rig.controller.outcomes[0].ok
        rig.check_limits()


@pytest.mark.parametrize('after', [60, 100], ids=['while it accelerates', 'at full speed'])
def test_velocities_keep_the_limits_of_acceleration_when_a_change_of_speed_begins(after: int) -> None:
    rig = Rig(period=0.004)
    rig.controller.follow(FollowedMotion(ruckig_move(START, np.array([2.5, 1.5, -1.2])), 'a'), rig.now)
    for _ in range(after):
        rig.step()
    began = len(rig.references)
    for paused in (True, False):
        rig.controller.speed.paused = paused
        for _ in range(100):
            rig.step()
    velocity = np.array([reference[1] for reference in rig.references[began - 1 :]])
    change = np.abs(np.diff(velocity, axis=0)) / (AXES.acceleration * rig.dt)
    # The path itself accelerates meanwhile, which the mean of the period leaves out: 0.2 %.
    assert np.max(change) <= 1.003


def test_a_reference_that_breaks_a_limit_never_leaves_and_the_robot_brakes() -> None:
    goal = np.array([2.0, 0.5, 0.0])
    honest = ruckig_move(START, goal)
    too_fast = Trajectory(
        honest.time / 1.5, honest.position, honest.velocity * 1.5, honest.acceleration * 1.5**2
    )
    rig = Rig(period=0.004, smoothing_time=0.0)
    rig.controller.follow(FollowedMotion(too_fast, 'fast'), rig.now)
    rig.run()
    outcome = rig.controller.outcomes[0]
    assert not outcome.ok
    assert 'acceleration of A' in outcome.message
    rig.check_limits()
    assert rig.controller.state is ControllerState.STOPPED
