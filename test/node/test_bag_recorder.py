"""The recorder of a cell, killed while it records."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import yaml
from nav_msgs.msg import Goals, Odometry
from rclpy.qos import QoSProfile
from rosbags.rosbag2 import Reader
from std_msgs.msg import Float64, String

from robots_controller.nodes.bags.bag_recorder import BagRecorder
from robots_controller.recording.bag_file import read_bag
from robots_core.errors import RobotsError
from robots_core.ros.lockstep.phases import NANOSECONDS
from robots_core.ros.qos import STATE
from robots_core.ros.timed_node import TimedNode
from written_bags import no_file_larger_than

RECORDER = """
import sys
from pathlib import Path
import rclpy
from rclpy.executors import SingleThreadedExecutor
from robots_controller.nodes.bags.bag_recorder import BagRecorder
rclpy.init()
executor = SingleThreadedExecutor()
executor.add_node(BagRecorder(Path(sys.argv[1]), namespace='/'))
executor.spin()
"""


def saved(path: Path, topic: str = '') -> int:
    """How many messages the bag says to have, in all or of a topic; 0 before there is one."""
    try:
        metadata = yaml.safe_load((path / 'metadata.yaml').read_text())
    except FileNotFoundError:
        return 0
    information = metadata['rosbag2_bagfile_information']
    topics = {
        item['topic_metadata']['name']: item['message_count']
        for item in information['topics_with_message_count']
    }
    return int(topics.get(topic, 0) if topic else information['message_count'])


def readable(path: Path) -> int:
    """Number of messages by an independent reader."""
    with Reader(path) as reader:
        return sum(1 for _ in reader.messages())


@pytest.mark.parametrize('count', [1, 3])
def test_a_killed_recorder_leaves_a_whole_bag(ros_nodes: Any, tmp_path: Path, count: int):
    path = tmp_path / 'bag'
    node = ros_nodes.create_node('source')
    mode = node.create_publisher(String, 'mode', STATE)
    level = node.create_publisher(Float64, 'level', QoSProfile(depth=100))
    mode.publish(String(data='auto'))
    numbers = iter(range(1_000_000))
    node.create_timer(0.01, lambda: level.publish(Float64(data=float(next(numbers)))))
    process = subprocess.Popen([sys.executable, '-P', '-c', RECORDER, str(path)])
    try:
        seen = 0
        ros_nodes.wait_for(lambda: saved(path, '/mode'), what='a bag with the latched topic')
        for _ in range(count):  # a bag that was written over `count` times
            before = seen
            ros_nodes.wait_for(lambda before=before: saved(path) > before, what='a longer bag')
            seen = saved(path)
    finally:
        process.send_signal(signal.SIGKILL)
        process.wait(240.0)
    assert readable(path) == saved(path) >= seen
    bag = read_bag(path)
    assert bag.problem == ''
    found = bag.deserialized(['/mode', '/level'])
    assert [message.data for _, message in found['/mode']] == ['auto']
    values = [message.data for _, message in found['/level']]
    assert values == [values[0] + k for k in range(len(values))]


def test_a_kill_in_the_middle_of_a_write_costs_what_came_since_the_one_before(ros_nodes: Any, tmp_path: Path):
    """As a kill between two blocks of the disk leaves it: new bytes at first, old ones behind."""
    path = tmp_path / 'bag'
    node = ros_nodes.create_node('source')
    level = node.create_publisher(Float64, 'level', QoSProfile(depth=100))
    node.create_timer(0.01, lambda: level.publish(Float64(data=1.0)))
    process = subprocess.Popen([sys.executable, '-P', '-c', RECORDER, str(path)])
    try:
        ros_nodes.wait_for(lambda: saved(path), what='a bag')
        file = path / 'bag.mcap'
        count = saved(path)
        older = file.read_bytes()
        ros_nodes.wait_for(lambda: saved(path) > count, what='a longer bag')
    finally:
        process.send_signal(signal.SIGKILL)
        process.wait(240.0)
    newer = file.read_bytes()
    for cut in range(0, len(newer), 997):
        file.write_bytes(newer[:cut] + older[cut:])
        try:
            bag = read_bag(path)
        except RobotsError as error:
            pytest.fail(f'cut at {cut}: {error}')
        assert len(bag.messages) >= count, cut


def test_nothing_is_lost_while_the_writer_is_held_up(ros_nodes: Any, tmp_path: Path):
    """As 4.5 s at 1 kHz in which the machine is busy with something else."""
    count = 4500
    level = ros_nodes.create_node('source').create_publisher(Float64, 'level', QoSProfile(depth=count))
    recorder = ros_nodes.add(BagRecorder(tmp_path / 'bag', namespace='/', context=ros_nodes.context))
    ros_nodes.wait_for(lambda: recorder.records(['level']), what='the recorder')
    with recorder._writing:
        for number in range(count):
            level.publish(Float64(data=float(number)))
    last = float(count - 1)

    def written() -> list[float]:
        found = read_bag(tmp_path / 'bag').deserialized(['/level'])['/level']
        return [message.data for _, message in found]

    ros_nodes.wait_for(lambda: saved(tmp_path / 'bag', '/level') and written()[-1] == last, what='all of it')
    recorder.close()
    assert written() == [float(number) for number in range(count)]


class Counting(TimedNode):
    """Publishes numbers, the first of them at the first instant of a run."""

    def __init__(self, **options: Any) -> None:
        super().__init__('counting', **options)
        publisher = self.create_publisher(Float64, 'number', QoSProfile(depth=1))
        self.create_publisher(Goals, 'goals', QoSProfile(depth=1))  # of a type that bags cannot have
        self.start_loop(lambda now: publisher.publish(Float64(data=now)), period=0.001, name='counting')


def test_a_lockstep_run_begins_with_its_recorder_and_all_of_it_is_recorded(ros_nodes: Any, tmp_path: Path):
    ros_nodes.add(Counting(**ros_nodes.options(lockstep=True)))
    path = tmp_path / 'bag'
    recorder = BagRecorder(path, namespace='/', lockstep=True, context=ros_nodes.context)
    # Nothing calls the recorder's callbacks yet, so that it finds no topics.
    held = threading.Event()
    run = ros_nodes.coordinate('counting', recorder=recorder, on_held=held.set)
    ros_nodes.wait_for(lambda: run.missing == [], what='the participant')
    assert recorder.recorded(['/number']) is None
    assert recorder.missing({'/number': 3}) == '0 of 3 messages on /number have come'
    assert not run.started
    ros_nodes.add(recorder)
    ros_nodes.wait_for(lambda: run.instants > 0, what='the start')
    with recorder._writing:  # as on a busy machine
        ros_nodes.wait_for(run._recorder_is_behind, what='a late recorder')
    ros_nodes.wait_for(lambda: run.instants > 1000, what='some time')
    ros_nodes.call(run.hold)
    ros_nodes.wait_for(held.is_set, what='the end of the instant')
    ros_nodes.wait_for(lambda: not recorder.missing(run.sent), what='all messages')
    recorder.close()
    found = read_bag(path).deserialized(['/number'])['/number']
    # Messages of one instant are some nanoseconds apart.
    due = [1.0 + 0.001 * number for number in range(len(found))]
    assert [message.data for _, message in found] == pytest.approx(due)
    assert [stamp / NANOSECONDS for stamp, _ in found] == pytest.approx(due, abs=1e-6)
    assert run.sent['/number'] == run.sent['/clock'] == len(found) >= 1000
    assert '/goals' not in run.sent


@pytest.mark.parametrize('broken', [None, SimpleNamespace(Odometry=str)])
def test_topics_of_types_that_cannot_be_imported_are_left_out(
    ros_nodes: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, broken: object
):
    node = ros_nodes.create_node('source')
    node.create_publisher(Odometry, 'foreign', QoSProfile(depth=1))
    level = node.create_publisher(Float64, 'level', QoSProfile(depth=1))
    node.create_timer(0.01, lambda: level.publish(Float64(data=1.0)))
    monkeypatch.setitem(sys.modules, 'nav_msgs.msg', broken)
    recorder = ros_nodes.add(BagRecorder(tmp_path / 'bag', namespace='/', context=ros_nodes.context))
    ros_nodes.wait_for(lambda: recorder.recorded(['/foreign', '/level']) == {'/level'}, what='the topics')
    ros_nodes.wait_for(lambda: recorder.missing({'/level': 1}) == '', what='a message')
    recorder.close()
    assert set(read_bag(tmp_path / 'bag').topics) >= {'/level'}
    assert '/foreign' not in read_bag(tmp_path / 'bag').topics


def test_a_full_disk_is_reported_at_once_and_the_bag_ends_whole(ros_nodes: Any, tmp_path: Path):
    text = ros_nodes.create_node('source').create_publisher(String, 'text', QoSProfile(depth=1000))
    recorder = ros_nodes.add(BagRecorder(tmp_path / 'bag', namespace='/', context=ros_nodes.context))
    ros_nodes.wait_for(lambda: recorder.records(['text']), what='the recorder')
    with no_file_larger_than(3_000_000):
        for _ in range(100):
            text.publish(String(data='x' * 50_000))
        ros_nodes.wait_for(lambda: recorder.problem, what='the problem')
    assert 'bag cannot take more: File too large' in recorder.problem
    recorder.close()
    assert readable(tmp_path / 'bag') == saved(tmp_path / 'bag') > 10
