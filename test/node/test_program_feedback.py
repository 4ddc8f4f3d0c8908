"""What a program reads of `joint_states`: where the robot is now, or an error."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import JointState

from robots_core.ros.qos import STATE

from .lua_bench import LuaBench


def test_program_reads_the_measured_position(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path)
    names = bench.node.robot.axes_data.names
    publisher = bench.peer.create_publisher(JointState, 'joint_states', STATE)
    bench.wait(publisher.get_subscription_count, 'a subscriber')
    bench.peer.create_timer(
        0.01, lambda: publisher.publish(JointState(name=list(names), position=np.radians([10.0] + [0.0] * 5)))
    )
    bench.start('for i, q in ipairs(getJointAngles()) do setAnalogOutput(i, q) end')
    bench.wait_for_state('FINISHED')
    bench.wait(lambda: bench.analog and bench.analog[-1][0] == pytest.approx(10.0), 'the output')


def test_a_position_that_nothing_publishes_is_an_error(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path)
    bench.start('getJointAngles()')
    assert 'no joint_states received: is drive_node running?' in bench.wait_for_state('FAILED')['error']


def test_a_program_does_not_take_what_ended_drives_have_measured_for_the_present(
    ros_nodes: Any, tmp_path: Path
):
    bench = LuaBench(ros_nodes, tmp_path)
    names, feedback = list(bench.node.robot.axes_data.names), bench.node._feedback
    publisher = bench.peer.create_publisher(JointState, 'joint_states', STATE)
    old, new = (JointState(name=names, position=np.radians([angle] + [0.0] * 5)) for angle in (10.0, 20.0))
    bench.wait(lambda: publisher.publish(old) or feedback.present(), 'the last feedback')
    bench.wait(lambda: feedback.present() is None, 'its age')
    np.testing.assert_allclose(feedback.newest().position[0], np.radians(10.0))
    bench.start('getJointAngles()')
    assert 'no joint_states received: is drive_node running?' in bench.wait_for_state('FAILED')['error']
    bench.peer.create_timer(0.01, lambda: publisher.publish(new))
    bench.start('for i, q in ipairs(getJointAngles()) do setAnalogOutput(i, q) end')
    bench.wait_for_state('FINISHED')
    bench.wait(lambda: bench.analog and bench.analog[-1][0] == pytest.approx(20.0), 'the output')


def test_several_threads_read_what_the_robot_measures(ros_nodes: Any, tmp_path: Path):
    """A program and `~/teach` do: each sees it in its order."""
    bench = LuaBench(ros_nodes, tmp_path)
    names, feedback = list(bench.node.robot.axes_data.names), bench.node._feedback
    publisher = bench.peer.create_publisher(JointState, 'joint_states', STATE)
    counter = count()
    bench.peer.create_timer(
        0.001, lambda: publisher.publish(JointState(name=names, position=[1e-3 * next(counter)] * len(names)))
    )
    bench.wait(feedback.newest, 'the first feedback')

    def read() -> list[float]:
        seen = [0.0]
        while seen[-1] < 0.5:
            seen.append(feedback.newest().position[0])
        return seen

    with ThreadPoolExecutor() as threads:
        found = [threads.submit(read) for _ in range(3)]
        bench.wait(lambda: all(one.done() for one in found), 'all of it')
    assert all((np.diff(one.result()) >= 0.0).all() for one in found)
