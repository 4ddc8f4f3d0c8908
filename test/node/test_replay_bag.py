"""replay_bag as its user starts it, against real subscribers."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Float64, String

from bench import Bench
from robots_controller.commands.command_table import REPLAY_BAG
from robots_controller.nodes.bags.bag_player import BagPlayer
from robots_controller.nodes.bags.replay_bag import replay_bag
from robots_controller.recording.bag_file import read_bag
from robots_controller.recording.bag_replay import replay_plan
from robots_core.errors import RobotsError
from robots_core.ros.lockstep.phases import START
from robots_core.ros.qos import COMMAND, STATE
from robots_core.ros.timed_node import TimedNode
from written_bags import BAG_TYPES, write_bag, write_plant_bag

T = BAG_TYPES.types


def number(value: float) -> Any:
    return T['std_msgs/msg/Float64'](value)


def text(value: str) -> Any:
    return T['std_msgs/msg/String'](value)


COUNT, PERIOD = 40, 0.02  # s
END_DEADLINE = 240.0  # s


class Listener(Bench):
    """Subscribed to what is replayed; each value with the time of sending in s."""

    def __init__(self, runner: Any, level: str = '/level') -> None:
        super().__init__(runner, 'listener')
        self.level = self.collect_sent(level, Float64)
        self.mode = self.collect_sent('/mode', String, STATE)


def replay(*options: object) -> subprocess.Popen[str]:
    module = 'robots_controller.commands.robots'
    command = [sys.executable, '-P', '-m', module, 'replay_bag', *map(str, options)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


@pytest.fixture
def bag(tmp_path: Path) -> Path:
    rows = [(0.0, '/mode', text('idle')), (0.1, '/mode', text('auto'))]
    rows += [(1.0 + PERIOD * k, '/level', number(float(k))) for k in range(COUNT)]
    return write_bag(tmp_path / 'bag', rows, latched=['/mode'])


@pytest.mark.parametrize('rate', [1.0, 2.0])
def test_messages_come_in_their_order_and_time_and_the_state_first(ros_nodes: Any, bag: Path, rate: float):
    listener = Listener(ros_nodes, '/press/level')
    process = replay(bag, '--rate', rate, '--remap', '/level:=/press/level', '--wait', 60)
    output, errors = process.communicate(timeout=END_DEADLINE)
    assert process.returncode == 0, errors
    assert output == f'{COUNT} messages in {(COUNT - 1) * PERIOD / rate:.1f} s\n'
    listener.wait(lambda: len(listener.level) == COUNT, 'all messages')
    assert [value for _, value in listener.level] == [float(k) for k in range(COUNT)]
    assert [mode for _, mode in listener.mode] == ['auto']
    assert listener.mode[0][0] < listener.level[0][0]
    # Due from the beginning, when the state was sent: never early; how late depends on the machine.
    for k, (sent, _) in enumerate(listener.level):
        assert sent - listener.mode[0][0] >= PERIOD * k / rate


def test_an_interrupt_ends_it(ros_nodes: Any, tmp_path: Path):
    listener = Listener(ros_nodes)
    path = write_bag(tmp_path / 'long', [(1000.0 * k, '/level', number(0.0)) for k in range(2)])
    process = replay(path, '--wait', 60)
    listener.wait(lambda: listener.level, 'the first message')
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=END_DEADLINE)
    assert process.returncode == 130
    assert 'Traceback' not in errors


def test_it_follows_the_clock(ros_nodes: Any, bag: Path):
    listener = Listener(ros_nodes)
    plan = replay_plan(read_bag(bag))
    player = ros_nodes.add(BagPlayer(plan, wait=240.0, **ros_nodes.options(use_sim_time=True)))
    clock = listener.publisher('/clock', Clock)
    for k in range(5):
        message = Clock()
        message.clock.sec, message.clock.nanosec = divmod(START + round(1e9 * PERIOD * k), START)

        def published(count: int = k + 1, message: Clock = message) -> bool:
            clock.publish(message)  # /clock is best effort
            return len(listener.level) >= count

        listener.wait(published, f'message {k}')
        assert player.published == k + 1


def test_in_lockstep_each_message_comes_at_its_simulated_time(ros_nodes: Any, bag: Path):
    lockstep = ros_nodes.options(lockstep=True)
    listener = TimedNode('listener', **lockstep)
    came: list[tuple[int, float]] = []
    modes: list[str] = []
    listener.create_subscription(
        Float64, '/level', lambda m: came.append((listener.participant.time, m.data)), COMMAND
    )
    listener.create_subscription(String, '/mode', lambda m: modes.append(m.data), STATE)
    player = BagPlayer(replay_plan(read_bag(bag)), wait=0.0, **lockstep)
    for one in (listener, player):
        ros_nodes.add(one)
    ros_nodes.coordinate('listener', 'bag_player')
    ros_nodes.wait_for(lambda: len(came) == COUNT, what='all messages')
    assert came == [(START + round(1e9 * PERIOD * k), float(k)) for k in range(COUNT)]
    assert set(modes) == {'auto'}
    assert player.complete


@pytest.mark.parametrize(
    ('options', 'message'),
    [
        (['--topics', '/no'], "has no topic '/no'"),
        (['--rate', '0'], "--rate: '0' is not valid"),
        (['--remap', '/level'], "'/level' is no remap; remaps are like"),
    ],
)
def test_options_that_do_not_fit_the_bag_are_refused(bag: Path, options: list[str], message: str):
    with pytest.raises(RobotsError, match=message):
        replay_bag(REPLAY_BAG.parser().parse_all([str(bag), *options]), Console())


def test_a_missing_bag_is_reported_in_one_line(ros_domain: int, tmp_path: Path):
    del ros_domain
    process = replay(tmp_path / 'no')
    _, errors = process.communicate(timeout=END_DEADLINE)
    assert process.returncode == 2
    assert errors.startswith('error: ')
    assert 'does not exist; a bag is a folder' in errors
    assert errors.count('\n') == 1


def test_topics_without_a_subscriber_are_named(ros_domain: int, bag: Path):
    del ros_domain
    process = replay(bag, '--wait', 0.1, '--rate', 100)
    output, _ = process.communicate(timeout=END_DEADLINE)
    assert process.returncode == 0
    assert output.startswith('no subscribers to /mode, /level\n')


def test_topics_of_types_that_are_not_installed_are_named(ros_domain: int, tmp_path: Path):
    del ros_domain
    bag = write_plant_bag(tmp_path / 'bag', [1.0])
    process = replay(bag, '--wait', 0.1)
    output, errors = process.communicate(timeout=END_DEADLINE)
    assert process.returncode == 0
    assert 'no subscribers to /trigger' in output
    assert "/level is not published: plant_msgs/msg/Level: the package 'plant_msgs' cannot" in errors
    with pytest.raises(RobotsError, match='has no topic of a message type that is installed'):
        replay_bag(
            REPLAY_BAG.parser().parse_all([str(write_plant_bag(tmp_path / 'level', [1.0], trigger=False))]),
            Console(),
        )
