"""Recorded motion commands, replayed into the real planner in lock-step: the same plans, as recorded."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robots_controller.nodes.bags.bag_player import BagPlayer
from robots_controller.nodes.bags.bag_recorder import BagRecorder
from robots_controller.recording.bag_file import Bag, read_bag
from robots_controller.recording.bag_replay import replay_plan
from robots_controller.simulation.record.ros_messages import BUILD
from robots_controller.testing import assert_bag_matches
from robots_core import Pose, load_robot_model
from robots_core.ros.lockstep.phases import START
from robots_planning.motion_kinds import KIND_OF_TOPIC
from robots_planning.nodes.planning_node import PlanningNode
from written_bags import write_bag

SECOND = 1_000_000_000  # ns
ROBOT = load_robot_model('ur10e')
BEGIN = np.array([0.2, -1.2, 1.6, -1.9, -1.4, 0.3])
COMMANDS = tuple(f'/{topic}' for topic in KIND_OF_TOPIC)
# The same code plans the same on every machine except for rounding, which inverse kinematics along a path
# does not magnify; times of points are whole nanoseconds. Stamps are ids here and no times.
TOLERANCES = """
align: /ptpjoint_joint
default: {time: 1.0e-6, absolute: 1.0e-9, relative: 1.0e-9}
ignore: ['*']
topics:
  joint_trajectory: {fields: {header.stamp: ignore}}
  motion_result: {}
"""


def pose_stamped(stamp: int, pose: Pose) -> Any:
    return BUILD.pose_stamped(SECOND * stamp, pose)


def path(stamp: int, poses: list[Pose]) -> Any:
    return BUILD.path(SECOND * stamp, poses)


def joints(stamp: int, q: np.ndarray) -> Any:
    return BUILD.joint_state(SECOND * stamp, ROBOT.axes_data.names, q)


def reference() -> Any:
    still = np.zeros(6)
    return BUILD.joint_trajectory(0, ROBOT.axes_data.names, [(0, BEGIN, still, still)])


def commands() -> Iterator[tuple[float, str, Any]]:
    """The reference of a robot that stands, and one motion after the other, each from the end before."""
    for k in range(100):
        yield 0.02 * k, '/joint_reference', reference()
    away = BEGIN + np.array([0.4, 0.1, -0.2, 0.1, 0.1, 0.2])
    pose = Pose(*ROBOT.direct_kinematics(away))

    def moved(*step: float, turn: float = 0.0) -> Pose:
        return Pose(pose.r + np.array(step), Pose.from_angles([0.0] * 3, [turn, 0.0, 0.0]).T @ pose.T)

    yield 0.5, '/ptpjoint_joint', joints(11, away)
    yield 0.6, '/ptpcartesian', pose_stamped(12, moved(0.0, 0.1, -0.15, turn=0.3))
    yield 0.7, '/circcartesian', path(13, [moved(0.05, 0.0, -0.15), moved(0.1, 0.1, -0.15)])
    yield 0.8, '/ptpcartesian', pose_stamped(14, moved(9.0, 0.0, 0.0))
    yield (
        0.9,
        '/splinecartesian',
        path(15, [moved(0.0, 0.2, -0.1), moved(0.0, 0.0, 0.0), moved(0.1, 0.1, 0.1)]),
    )
    yield 1.0, '/ptpjoint_cartesian', pose_stamped(16, moved(-0.1, -0.1, 0.0))
    yield 1.1, '/ptpjoint_joint', joints(17, BEGIN)


def replayed(ros_nodes: Any, bag: Path, recorded: Path, **parameters: object) -> Path:
    """Replay the commands of a bag into a new planner in lock-step; returns the bag of all messages."""
    plan = replay_plan(read_bag(bag), topics=[*COMMANDS, '/joint_reference'])
    recorder = ros_nodes.add(BagRecorder(recorded, namespace='/', lockstep=True, context=ros_nodes.context))
    player = ros_nodes.add(BagPlayer(plan, wait=0.0, **ros_nodes.options(lockstep=True)))
    parameters |= {'robot_model': ROBOT.name, 'lockstep': True}
    planner = ros_nodes.add(PlanningNode(**ros_nodes.options(**parameters)))
    run = ros_nodes.coordinate('bag_player', 'planning_node', recorder=recorder)
    ros_nodes.wait_for(lambda: run.time > START + round(1e9 * plan.duration), what='the end')
    ros_nodes.call(run.end)
    ros_nodes.wait_for(lambda: not recorder.missing(run.sent), what='the whole bag')
    recorder.close()
    for node in (recorder, player, planner):
        ros_nodes.destroy(node)
    return recorder.path


def ids(bag: Bag) -> list[int]:
    messages = bag.deserialized(['/joint_trajectory'])['/joint_trajectory']
    return [message.header.stamp.sec for _, message in messages]


def test_replayed_commands_give_the_recorded_plans(ros_nodes: Any, tmp_path: Path) -> None:
    (tmp_path / 'tolerances.yaml').write_text(TOLERANCES)
    first = replayed(ros_nodes, write_bag(tmp_path / 'commands', commands()), tmp_path / 'recorded')
    assert ids(read_bag(first)) == [11, 12, 13, 15, 16, 17]
    again = replayed(ros_nodes, first, tmp_path / 'again')
    comparison = assert_bag_matches(again, first, tmp_path / 'tolerances.yaml')
    assert {result.topic for result in comparison.topics} == {'/joint_trajectory', '/motion_result'}
    assert ids(read_bag(again)) == ids(read_bag(first))

    # A planner whose limits are 1 percent lower plans something else, which is found.
    other = replayed(ros_nodes, first, tmp_path / 'other', acceleration_fraction=0.99)
    with pytest.raises(AssertionError, match=r'/joint_trajectory at .*points'):
        assert_bag_matches(other, first, tmp_path / 'tolerances.yaml')
