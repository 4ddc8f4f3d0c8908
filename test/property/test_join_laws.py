"""Laws of a target that changes while the robot moves: planner and controller joined, any instant."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robots_controller.control.controller import Controller, ControllerSettings, ControllerState
from robots_controller.control.followed_motion import FollowedMotion
from robots_core import load_robot_model
from robots_planning import LinearJoint, LinearJointAxes
from robots_planning.trajectory_generators.joint_space import JointSpaceGenerator

ROBOT = load_robot_model('kuka_kr210_r2700')
AXES = ROBOT.axes_data
PERIOD = 0.004  # s
LEAD = 0.15  # s between the decision and the join, as planning_node takes
LONGEST = 20_000  # references until the robot must stand
PLANNERS: tuple[type[JointSpaceGenerator], ...] = (LinearJoint, LinearJointAxes)

moves = st.lists(st.floats(-0.8, 0.8), min_size=6, max_size=6)


def near_home(move: list[float]) -> np.ndarray:
    return np.clip(ROBOT.home + move, AXES.lower, AXES.upper)


@pytest.mark.parametrize('planner', PLANNERS)
@settings(max_examples=20)  # thousands of steps of the controller each
@given(
    targets=st.tuples(moves, moves, moves),
    when=st.tuples(st.floats(0.0, 1.0), st.floats(0.0, 1.0)),
    override=st.sampled_from([1.0, 0.6, 0.1]),
)
def test_references_stay_inside_limits_through_every_join(
    planner: type[JointSpaceGenerator],
    targets: tuple[list[float], ...],
    when: tuple[float, float],
    override: float,
) -> None:
    start, *goals = [ROBOT.home, *map(near_home, targets)]
    controller = Controller(AXES, ControllerSettings(period=PERIOD))
    controller.step(0.0, start)
    controller.speed.set_override(override)
    generator = planner(ROBOT)
    trajectory = generator.generate(start, goals[0])
    controller.follow(FollowedMotion(trajectory, '0'), 0.0)
    now, references, joined = 0.0, [], 0

    def steps(count: int) -> None:
        nonlocal now
        for _ in range(count):
            now += PERIOD
            assert controller.reference is not None
            reference = controller.step(now, controller.reference[0])
            assert reference is not None
            references.append(reference)

    for number, (share, goal) in enumerate(zip(when, goals[1:], strict=True), 1):
        steps(int(share * trajectory.duration / PERIOD))
        # The path time of the running motion never runs ahead of the clock.
        join_time = controller.progress * trajectory.duration + LEAD
        if controller.state is ControllerState.HOLDING or join_time >= trajectory.duration:
            break
        q, q_dot, q_ddot = trajectory.sample(join_time)
        following = generator.generate_moving((q, q_dot, q_ddot), goal)
        controller.follow(FollowedMotion(following, str(number)), now, join_time=join_time)
        trajectory, joined = following, number
        # Until it has taken the place of the one before, progress counts on that one.
        steps(int(np.ceil(LEAD / (override * PERIOD))) + 100)
    while controller.state is not ControllerState.HOLDING:
        assert len(references) < LONGEST
        steps(1)

    rows = np.array(references)
    q, q_dot, q_ddot = rows[:, 0], rows[:, 1], rows[:, 2]
    # Limits that planners keep to 1e-3, as verification finds them by differences at the controller's period.
    within = 1.0 + 1e-3
    assert (q >= AXES.lower - 1e-9).all()
    assert (q <= AXES.upper + 1e-9).all()
    assert (np.abs(q_dot) <= AXES.velocity * within).all()
    assert (np.abs(q_ddot) <= AXES.acceleration * within).all()
    assert (np.abs(np.diff(q, axis=0)) / PERIOD <= AXES.velocity * within).all()
    assert (np.abs(np.diff(q, 2, axis=0)) / PERIOD**2 <= AXES.acceleration * within).all()
    np.testing.assert_allclose(q[-1], goals[joined], atol=1e-9)
    assert [outcome.ok for outcome in controller.outcomes] == [False] * joined + [True]
