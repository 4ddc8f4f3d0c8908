"""replay_bag as its user starts it, against real subscribers."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from rclpy.qos import QoSProfile
from std_msgs.msg import Float64, String

from robots_controller.nodes.bags.replay_bag import replay_bag
from robots_controller.testing import BAG_TYPES, write_bag
from robots_core.errors import RobotsError
from robots_core.ros.qos import STATE

T = BAG_TYPES.types


def number(value: float) -> Any:
    return T['std_msgs/msg/Float64'](value)


def text(value: str) -> Any:
    return T['std_msgs/msg/String'](value)


EVERY = QoSProfile(depth=1000)
COUNT, PERIOD = 40, 0.02  # s


class Listener:
    """What arrives, with the time of sending in s."""

    def __init__(self, runner: Any, level: str = '/level') -> None:
        self.level: list[tuple[float, float]] = []
        self.mode: list[tuple[float, str]] = []
        node = runner.create_node('listener')
        node.create_subscription(
            Float64,
            level,
            lambda m, info: self.level.append((1e-9 * info['source_timestamp'], m.data)),
            EVERY,
        )
        node.create_subscription(
            String,
            '/mode',
            lambda m, info: self.mode.append((1e-9 * info['source_timestamp'], m.data)),
            STATE,
        )


def replay(*options: object) -> subprocess.Popen[str]:
    command = [sys.executable, '-P', '-m', 'robots_controller.nodes.bags.replay_bag', *map(str, options)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


@pytest.fixture
def bag(tmp_path: Path) -> Path:
    rows = [(0.0, '/mode', text('idle')), (0.1, '/mode', text('auto'))]
    rows += [(1.0 + PERIOD * k, '/level', number(float(k))) for k in range(COUNT)]
    return write_bag(tmp_path / 'bag', rows, latched=['/mode'])


@pytest.mark.parametrize('rate', [1.0, 2.0])
def test_messages_come_in_their_order_and_time_and_the_state_first(ros_nodes: Any, bag: Path, rate: float):
    heard = Listener(ros_nodes, '/press/level')
    process = replay(bag, '--rate', rate, '--remap', '/level:=/press/level', '--wait', 60)
    output, errors = process.communicate(timeout=120.0)
    assert process.returncode == 0, errors
    assert output == f'{COUNT} messages in {(COUNT - 1) * PERIOD / rate:.1f} s\n'
    ros_nodes.wait_for(lambda: len(heard.level) == COUNT, what='all messages')
    assert [value for _, value in heard.level] == [float(k) for k in range(COUNT)]
    assert [mode for _, mode in heard.mode] == ['auto']
    assert heard.mode[0][0] < heard.level[0][0]
    # Due from the beginning, when the state was sent: never early; how late depends on the machine.
    for k, (sent, _) in enumerate(heard.level):
        assert sent - heard.mode[0][0] >= PERIOD * k / rate


def test_an_interrupt_ends_it(ros_nodes: Any, tmp_path: Path):
    heard = Listener(ros_nodes)
    path = write_bag(tmp_path / 'long', [(10.0 * k, '/level', number(0.0)) for k in range(100)])
    process = replay(path, '--wait', 60)
    ros_nodes.wait_for(lambda: heard.level, what='the first message')
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=120.0)
    assert process.returncode == 130
    assert 'Traceback' not in errors


@pytest.mark.parametrize(
    ('options', 'message'),
    [
        (['--topics', '/no'], "has no topic '/no'"),
        (['--rate', '0'], 'rate = 0.0 must be'),
        (['--remap', '/level'], "'/level' is no remap; remaps are like"),
    ],
)
def test_what_does_not_fit_is_told(bag: Path, options: list[str], message: str):
    with pytest.raises(RobotsError, match=message):
        replay_bag([str(bag), *options])


def test_a_mistake_is_told_in_one_line(ros_domain: int, tmp_path: Path):
    del ros_domain
    process = replay(tmp_path / 'no')
    _, errors = process.communicate(timeout=120.0)
    assert process.returncode == 2
    assert errors.startswith('error: ')
    assert 'does not exist; a bag is a folder' in errors
    assert errors.count('\n') == 1


def test_topics_that_nobody_hears_are_told(ros_domain: int, bag: Path):
    del ros_domain
    process = replay(bag, '--wait', 0.1, '--rate', 100)
    output, _ = process.communicate(timeout=120.0)
    assert process.returncode == 0
    assert output.startswith('nobody listens to /mode, /level\n')
