"""FollowJointTrajectory: goals of others, and the answers to them, with the action's error codes."""

from __future__ import annotations

import numpy as np
import pytest
from builtin_interfaces.msg import Duration
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robots_core.errors import RobotsError
from robots_planning.commands.goal_outcome import Outcome
from robots_planning.nodes.follow_joint_trajectory import waypoints_trajectory

# As the action of control_msgs numbers them.
INVALID_GOAL, INVALID_JOINTS = -1, -2
NAMES = ['A1', 'A2']
START = np.array([0.1, 0.2])


def goal(names: list[str], *rows: list[float], begin: int = 1) -> JointTrajectory:
    """Positions a second apart, the first after `begin` seconds."""
    points = [
        JointTrajectoryPoint(positions=row, time_from_start=Duration(sec=begin + number))
        for number, row in enumerate(rows)
    ]
    return JointTrajectory(joint_names=names, points=points)


def refusal(message: JointTrajectory) -> Outcome:
    with pytest.raises(RobotsError) as caught:
        waypoints_trajectory(message, NAMES, START)
    return Outcome.refused(caught.value)


def test_joints_are_matched_by_name() -> None:
    trajectory = waypoints_trajectory(goal(['A2', 'A1'], [0.4, 0.3]), NAMES, START)
    np.testing.assert_allclose(trajectory.position[[0, -1]], [START, [0.3, 0.4]])
    assert trajectory.duration == pytest.approx(1.0)


@pytest.mark.parametrize('names', [['A1', 'B2'], ['A1'], [], ['A1', 'A1']])
def test_wrong_joints_are_invalid_joints(names: list[str]) -> None:
    outcome = refusal(goal(names, [0.0] * len(names)))
    assert outcome.code == INVALID_JOINTS
    assert 'joint' in outcome.message


@pytest.mark.parametrize(
    'message',
    [
        goal(NAMES),
        goal(NAMES, [0.3]),
        goal(NAMES, [0.3, 0.4], begin=0),
        goal(NAMES, [0.3, 0.4], [0.2], begin=1),
    ],
)
def test_everything_else_that_is_refused_is_an_invalid_goal(message: JointTrajectory) -> None:
    outcome = refusal(message)
    assert outcome.code == INVALID_GOAL
    assert outcome.message


def test_velocities_alone_are_integrated_from_rest() -> None:
    points = [
        JointTrajectoryPoint(velocities=velocities, time_from_start=Duration(sec=1 + number))
        for number, velocities in enumerate([[0.2, 0.0], [0.2, 0.0], [0.0, 0.0]])
    ]
    trajectory = waypoints_trajectory(JointTrajectory(joint_names=NAMES, points=points), NAMES, START)
    np.testing.assert_allclose(trajectory.position[-1], START + np.array([0.4, 0.0]), atol=1e-12)
    np.testing.assert_allclose(trajectory.velocity[-1], [0.0, 0.0], atol=1e-12)
