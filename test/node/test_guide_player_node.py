"""guide_player_node: the topic `guide` in, recorded messages with stamps of today out."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from bench import Bench
from robots_controller.nodes.guide_player_node import GuidePlayerNode
from robots_controller.simulation.record.ros_messages import BUILD
from robots_core import load_robot_model
from robots_core.blocks.following.guide import Guide
from robots_core.ros.messages import nanoseconds
from robots_core.ros.qos import COMMAND, STATE
from written_bags import BAG_START, write_bag

NAME = 'bello_bot'
JOINTS = list(load_robot_model(NAME).axes_data.names)
PERIOD, COUNT = 20_000_000, 5  # ns


def jogs(folder: Path) -> Path:
    """A recording of a person who jogs all axes."""
    rows = []
    for k in range(COUNT):
        velocity = np.full(len(JOINTS), 0.01 * k)
        message = BUILD.joint_state(BAG_START + PERIOD * k, JOINTS, q_dot=velocity)
        rows.append((1e-9 * PERIOD * k, '/teach_joints', message))
    return write_bag(folder / 'jogs', rows)


def test_a_recording_is_played_when_the_robot_is_handed_over(ros_nodes: Any, tmp_path: Path) -> None:
    bench = Bench(ros_nodes)
    played = bench.collect('teach_joints', JointState, COMMAND)
    node = bench.start_node(GuidePlayerNode, robot_model=NAME, references=str(jogs(tmp_path)))
    bench.wait(lambda: bench.peer.count_publishers('teach_joints'), 'the player')
    bench.publish('guide', String(data=Guide.NONE), STATE)
    bench.publish('guide', String(data=Guide.SENSOR), STATE)
    bench.until_health(DiagnosticStatus.WARN, 'holds no reference_pose or reference_twist')
    assert not played
    before = node.get_clock().now().nanoseconds
    bench.publish('guide', String(data=Guide.PERSON), STATE)
    bench.wait(lambda: len(played) == COUNT, 'all messages')
    assert [message.velocity[0] for message in played] == [0.01 * k for k in range(COUNT)]
    stamps = np.array([nanoseconds(message.header.stamp) for message in played])
    assert stamps[0] >= before
    np.testing.assert_array_equal(np.diff(stamps), PERIOD)
