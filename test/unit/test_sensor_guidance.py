"""SensorGuidance: when the stream begins, starts again, brakes and ends."""

from __future__ import annotations

import numpy as np
import pytest

from robots_core import Pose, load_robot_model
from robots_core.blocks.following.pose_reference import moved
from robots_core.blocks.following.realtime_movement import RealtimeMovement
from robots_core.blocks.following.sensor_guidance import SensorGuidance
from robots_core.errors import RobotsError

ROBOT = load_robot_model('kuka_kr210_r2700')
DT = 0.004
START = np.array([0.2, -1.2, 1.4, 0.3, 0.8, -0.4])
POSE = Pose(*ROBOT.direct_kinematics(START))
TWIST = np.array([0.1, -0.05, 0.05, 0.0, 0.0, 0.0])


class Bench:
    """A controller whose reference follows the stream at once, unless it is held."""

    def __init__(self, method: str = 'constrained') -> None:
        self.reference: np.ndarray | None = np.array([START, np.zeros(6)])
        self.held = False
        self.refused: list[str] = []
        self.time = 0.0
        movement = RealtimeMovement(ROBOT, DT, ROBOT.home, method=method)
        self.guidance = SensorGuidance(movement, reference=lambda: self.reference, refused=self.refuse)

    def refuse(self, topic: str, error: RobotsError) -> None:
        self.refused.append(f'{topic}: {error}')

    def run(self, periods: int, pose: Pose | None = None) -> int:
        """Step with a sample in each period, or without; the number of references that were made."""
        made = 0
        for _ in range(periods):
            if pose is not None:
                self.guidance.put(pose, self.time)
            step = self.guidance.step(self.time)
            self.time += DT
            if step is not None:
                made += 1
                if not self.held:
                    self.reference = np.array([step.q, step.q_dot])
        return made


@pytest.fixture
def bench() -> Bench:
    bench = Bench()
    bench.guidance.hand_over(handed_over=True)
    return bench


def test_samples_guide_a_robot_that_is_handed_over_only(bench: Bench):
    bench.guidance.hand_over(handed_over=False)
    assert bench.run(5, POSE) == 0
    bench.guidance.hand_over(handed_over=True)
    assert bench.run(5) == 0  # what came before does not count
    assert bench.run(5, POSE) == 5
    assert bench.guidance.streaming


def test_no_stream_begins_before_the_controller_has_a_reference(bench: Bench):
    bench.reference = None
    assert bench.run(5, POSE) == 0
    bench.reference = np.array([START, 0.1 * np.ones(6)])
    bench.guidance.put(POSE, bench.time)
    first = bench.guidance.step(bench.time)
    assert first is not None
    # From the controller's reference on, with its velocity.
    assert (np.abs(first.q_dot - 0.1) <= ROBOT.axes_data.acceleration * DT * (1.0 + 1e-9)).all()


def test_the_stream_ends_at_rest_and_says_why(bench: Bench):
    bench.run(50, moved(POSE, TWIST, 1.0))
    bench.run(500)
    assert not bench.guidance.streaming
    assert bench.reference is not None
    assert not bench.reference[1].any()
    assert bench.guidance.ended == 'no reference for 0.2 s, the robot stands'
    bench.run(1, POSE)
    assert not bench.guidance.ended


def test_a_robot_that_is_taken_back_brakes_at_once_without_a_complaint(bench: Bench):
    bench.run(50, moved(POSE, TWIST, 1.0))
    bench.guidance.hand_over(handed_over=False)
    assert bench.reference is not None
    before = np.abs(bench.reference[1]).max()
    assert bench.run(1, POSE) == 1
    assert np.abs(bench.reference[1]).max() < before
    assert 0 < bench.run(500, POSE) < 500
    assert not bench.guidance.ended


def test_idle_steps_may_be_left_out(bench: Bench):
    sparse = Bench()
    sparse.guidance.hand_over(handed_over=True)
    left_out = 0
    for period in range(900):
        given = (100 <= period < 400 and period % 7 == 0) or period in (5, 700)
        if given:
            for one in (bench, sparse):
                one.guidance.put(moved(POSE, TWIST, 0.001 * period), one.time)
        bench.run(1)
        if given or not sparse.guidance.idle(sparse.time):
            sparse.run(1)
        else:
            sparse.time += DT
            left_out += 1
        np.testing.assert_array_equal(sparse.reference, bench.reference)
        assert sparse.guidance.streaming == bench.guidance.streaming
    assert left_out > 300


def test_a_controller_that_does_not_follow_is_started_from_again(bench: Bench):
    bench.held = True
    bench.run(400, Pose(POSE.r + np.array([0.0, 0.5, 0.0]), POSE.T))
    assert set(bench.refused) == {'joint_reference: the controller does not follow'}
    step = bench.guidance.step(bench.time)
    assert step is not None
    assert np.abs(step.q - START).max() < 0.3


def test_a_pose_without_a_solution_is_refused():
    bench = Bench('analytical')
    bench.guidance.hand_over(handed_over=True)
    bench.run(3, Pose(np.array([9.0, 0.0, 1.0]), np.eye(3)))
    assert bench.refused
    assert all('reference_pose' in text and 'out of reach' in text for text in bench.refused)
    np.testing.assert_array_equal(bench.reference, [START, np.zeros(6)])
