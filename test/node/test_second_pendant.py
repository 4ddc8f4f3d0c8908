"""A second pendant_node of the same name ends; one that is started after a killed one stays."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

import pytest
from std_msgs.msg import UInt64

from robots_core.exit_codes import ExitCode
from robots_core.ros.qos import SENSOR

PENDANT = 'import sys; from robots_controller.nodes.pendant_node import main; sys.exit(main())'
# What is killed needs no page.
WITHOUT_PAGE = """
import sys
from robots_core.ros.running.run import run
from robots_core.ros.timed_node import TimedNode

class Alone(TimedNode):
    alone = True

    def __init__(self):
        super().__init__('pendant_node')

sys.exit(run(Alone))
"""
DEADLINE = 240.0  # s, for a machine that is slow and busy
ENOUGH = 50  # signs of life, in which the forged ones have been heard


class Pendants:
    """Pendants in processes of their own, and the signs of life of their name."""

    def __init__(self, nodes: Any, ending: ExitStack) -> None:
        self._nodes, self._ending = nodes, ending
        self.beats: list[int] = []
        node = nodes.create_node('listener')
        node.create_subscription(
            UInt64, 'pendant_node/heartbeat', lambda beat: self.beats.append(beat.data), SENSOR
        )

    def start(self, program: str = PENDANT) -> subprocess.Popen[str]:
        arguments = ['--ros-args', '-p', 'port:=0'] if program == PENDANT else []
        words = [sys.executable, '-P', '-c', program, *arguments]
        process = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)
        self._ending.callback(process.communicate)
        self._ending.callback(process.kill)
        return process

    def wait_for_another(self, process: subprocess.Popen[str]) -> int:
        """The number of a pendant that has just been started."""
        before = {*self.beats}
        self._nodes.wait_for(lambda: {*self.beats} - before or process.poll() is not None, what='life')
        assert process.poll() is None
        return ({*self.beats} - before).pop()


@pytest.fixture
def pendants(ros_nodes: Any) -> Iterator[Pendants]:
    with ExitStack() as ending:
        yield Pendants(ros_nodes, ending)


def test_a_second_pendant_ends_and_a_restarted_one_stays(ros_nodes: Any, pendants: Pendants) -> None:
    first = pendants.start(WITHOUT_PAGE)
    pendants.wait_for_another(first)
    second = pendants.start()
    assert second.wait(DEADLINE) == ExitCode.BAD_INPUT
    assert second.stderr is not None
    assert '/pendant_node runs already' in second.stderr.read()
    assert first.poll() is None

    first.kill()
    first.wait(DEADLINE)
    third = pendants.start()
    number = pendants.wait_for_another(third)

    forger = ros_nodes.create_node('forger')
    forged = forger.create_publisher(UInt64, 'pendant_node/heartbeat', 10)
    forger.create_timer(0.01, lambda: forged.publish(UInt64(data=1)))
    ros_nodes.wait_for(lambda: pendants.beats.count(1) >= ENOUGH, what='forged signs of life')
    since = len(pendants.beats)
    ros_nodes.wait_for(lambda: pendants.beats[since:].count(number) >= ENOUGH, what='signs of life')
    assert third.poll() is None
