"""How soon a restarted process and those that run find each other, next to what ROS sets by itself.

Run by `make benchmark-discovery`.

Some processes, each with the endpoints of a small node, publish when they began. One after the other is
killed and started again, with both settings in turn. For each pair, the time counts from when the new process
has created its last endpoint until it has received a message of the other one, and the other one of it. Pairs
that have not found each other within a minute count as never; all processes are then started again.
"""

from __future__ import annotations

import argparse
import math
import os
import queue
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Final

import numpy as np
import rclpy
from rclpy.node import Node
from std_msgs.msg import UInt64
from std_srvs.srv import Trigger

from robots_core.ros.running.middleware import choose_transports
from ros_domains import reserved_domain

PROCESSES: Final = 8
ENDPOINTS: Final = 20  # publishers, subscriptions and services of a node, each
PERIOD: Final = 0.02  # s between two messages
PATIENCE: Final = 60.0  # s
SETTLE: Final = 3.5  # s after the start; processes announce themselves more often before
OURS: Final = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'SETTINGS': 'ours'}
BARE: Final = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'SETTINGS': 'ROS'}


def be_peer(number: int) -> None:
    """Be one of the processes: print when it was complete, and when each other one was first received."""
    if os.environ['SETTINGS'] == 'ours':
        choose_transports()
    rclpy.init()
    node, began, seen = Node(f'peer_{number}'), time.time_ns(), {}

    def receive(peer: int, message: UInt64) -> None:
        if seen.get(peer) != message.data:
            seen[peer] = message.data
            print(number, began, peer, message.data, time.time_ns(), flush=True)

    for peer in set(range(PROCESSES)) - {number}:
        node.create_subscription(UInt64, f'peer_{peer}/began', lambda m, p=peer: receive(p, m), 1)
    for index in range(ENDPOINTS):
        node.create_publisher(UInt64, f'peer_{number}/topic_{index}', 1)
        node.create_subscription(UInt64, f'peer_{index % PROCESSES}/topic_{index}', lambda _: None, 1)
        node.create_service(Trigger, f'peer_{number}/service_{index}', lambda _, response: response)
    publisher = node.create_publisher(UInt64, f'peer_{number}/began', 1)
    node.create_timer(PERIOD, lambda: publisher.publish(UInt64(data=began)))
    print(number, began, number, began, time.time_ns(), flush=True)
    rclpy.spin(node)


class Peers:
    """Processes with the same settings, in a domain of their own."""

    def __init__(self, environment: dict[str, str]) -> None:
        self._environment = {**os.environ, **environment}
        self._begin()

    def _begin(self) -> None:
        self._lines: queue.Queue[str] = queue.Queue()
        self._began: dict[int, int] = {}
        self._found: dict[tuple[int, int, int, int], int] = {}
        self._processes = [self._start(number) for number in range(PROCESSES)]

    def _start(self, number: int) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            [sys.executable, __file__, '--peer', str(number)],
            env=self._environment,
            stdout=subprocess.PIPE,
            text=True,
        )
        lines = self._lines
        threading.Thread(target=lambda: [lines.put(line) for line in process.stdout or ()]).start()
        return process

    def wait(self) -> bool:
        """Wait until each has received something of each other; returns whether that has come to pass."""
        while len(self._began) < PROCESSES or any(
            (one, self._began[one], other, self._began[other]) not in self._found
            for one in self._began
            for other in self._began
        ):
            try:
                number, began, peer, of, found = map(int, self._lines.get(timeout=PATIENCE).split())
            except queue.Empty:
                return False
            self._found[number, began, peer, of] = found
            if number == peer:
                self._began[number] = began
        return True

    def restart(self, number: int) -> list[float]:
        """Kill one and start it again: how long each pair needed, in both directions, s."""
        self._processes[number].kill()
        self._processes[number].wait()
        del self._began[number]
        self._processes[number] = self._start(number)
        all_found = self.wait()
        new = number, self._began[number]
        pairs = [(new, other) for other in self._began.items() if other != new]
        complete = self._found[*new, *new]
        times = [
            1e-9 * (self._found.get((*one, *other), math.inf) - complete)
            for pair in pairs
            for one, other in (pair, reversed(pair))
        ]
        if not all_found:
            self.end()
            self._begin()
            self.wait()
        return times

    def end(self) -> None:
        for process in self._processes:
            process.kill()
            process.wait()


@contextmanager
def peers(settings: dict[str, str]) -> Iterator[Peers]:
    """Processes that have all found each other."""
    with reserved_domain() as environment:
        found = Peers({'ROS_DOMAIN_ID': environment['ROS_DOMAIN_ID'], **settings})
        try:
            found.wait()
            yield found
        finally:
            found.end()


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument('--count', type=int, default=24, help='restarts with each of the settings')
    parser.add_argument('--peer', type=int, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.peer is not None:
        be_peer(options.peer)
        return
    times: dict[str, list[float]] = {}
    with ExitStack() as stack:
        sides = [(each['SETTINGS'], stack.enter_context(peers(each))) for each in (OURS, BARE)]
        time.sleep(SETTLE)
        for number in range(options.count):
            for name, side in sides:
                times.setdefault(name, []).extend(side.restart(number % PROCESSES))
    for name, found in times.items():
        # Where some have never found each other, nothing lies between two.
        median, p90, worst = (np.quantile(found, part, method='higher') for part in (0.5, 0.9, 1.0))
        print(
            f'{name:>5}: {len(found)} times found, after {median:.3f} s (median), {p90:.3f} s (p90), '
            f'{worst:.3f} s (worst), {np.isinf(found).sum()} not within {PATIENCE:g} s'
        )
    ratio = np.quantile(times['ours'], 0.9) / np.quantile(times['ROS'], 0.9)
    print(f'ours takes {ratio:.2f} times as long as what ROS sets by itself, by the p90')


if __name__ == '__main__':
    main()
