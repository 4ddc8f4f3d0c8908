"""What the nodes of a cell take of a core while the robot stands, next to bare rclpy nodes.

Run by `make benchmark-cell-at-rest`; OPTIONS=--markdown prints the table of docs/explanation/benchmarks.md.
A bare node publishes the messages of the node beside it at the same rates, by timers of rclpy, and subscribes
to the same topics with callbacks that do nothing. Both groups run for the same time, one after the other.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy

from node_pids import node_pids
from robots_core.ros.message_class import message_class
from robots_core.ros.running.middleware import choose_transports

CELL = Path('install/robots_controller/lib/robots_controller/cell')
BARE = Path(__file__).with_name('bare_nodes.py')
START_TIMEOUT = 120.0  # s
SETTLING = 5.0  # s, after which nothing starts any more
COUNTING = 5.0  # s
NOT_OURS = {'/rosout', '/parameter_events'}
TICKS = os.sysconf('SC_CLK_TCK')
READY = 'the cell is ready'


@dataclass
class Counted:
    """Messages of one topic."""

    count: int = 0
    sample: bytes = b''

    def take(self, message: bytes) -> None:
        """Count one."""
        self.count, self.sample = self.count + 1, message


@dataclass
class Use:
    """What processes take of a core, %, and their memory, MB (proportional set size)."""

    cpu: dict[str, float] = field(default_factory=dict)
    memory: dict[str, float] = field(default_factory=dict)


def graph(nodes: set[str]) -> dict[str, dict[str, list[dict[str, Any]]]]:
    """Publishers with their rates, and subscriptions, of each node."""
    node = Node('observer')
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    deadline = time.monotonic() + COUNTING
    while time.monotonic() < deadline:
        executor.spin_once(timeout_sec=0.1)
    found: dict[str, dict[str, list[dict[str, Any]]]] = {
        name: {'publishers': [], 'subscriptions': []} for name in sorted(nodes)
    }
    topics = {name: types[0] for name, types in node.get_topic_names_and_types() if name not in NOT_OURS}
    counted = {topic: Counted() for topic in topics}
    for topic, type_name in topics.items():
        qos = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)
        node.create_subscription(message_class(type_name), topic, counted[topic].take, qos, raw=True)
    start = time.monotonic()
    while time.monotonic() - start < COUNTING:
        executor.spin_once(timeout_sec=0.1)
    elapsed = time.monotonic() - start
    for topic, type_name in topics.items():
        publishers = node.get_publishers_info_by_topic(topic)
        for kind, infos in (
            ('publishers', publishers),
            ('subscriptions', node.get_subscriptions_info_by_topic(topic)),
        ):
            for info in infos:
                if info.node_name not in nodes:
                    continue
                found[info.node_name][kind].append(
                    {
                        'topic': topic,
                        'type': type_name,
                        'reliability': info.qos_profile.reliability.name,
                        'durability': info.qos_profile.durability.name,
                        'rate': counted[topic].count / elapsed / len(publishers) if publishers else 0.0,
                        'sample': counted[topic].sample.hex(),
                    }
                )
    node.destroy_node()
    executor.shutdown()
    return found


def processor_time(pid: int) -> float:
    """s."""
    fields = Path(f'/proc/{pid}/stat').read_text().rsplit(')', 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def memory(pid: int) -> float:
    """MB."""
    found = re.search(r'^Pss:\s+(\d+)', Path(f'/proc/{pid}/smaps_rollup').read_text(), re.MULTILINE)
    return int(found[1]) / 1024 if found else 0.0


def used(pids: Mapping[str, int], seconds: float) -> Use:
    """During the next seconds."""
    before, start = {name: processor_time(pid) for name, pid in pids.items()}, time.monotonic()
    time.sleep(seconds)
    elapsed = time.monotonic() - start
    return Use(
        {name: 100.0 * (processor_time(pid) - before[name]) / elapsed for name, pid in pids.items()},
        {name: memory(pid) for name, pid in pids.items()},
    )


def helpers(cell: int, nodes: Mapping[str, int]) -> dict[str, int]:
    """Processes that a cell has started besides its nodes: the server that forks them, and its tracker."""
    found = {}
    for stat in Path('/proc').glob('[0-9]*/stat'):
        try:
            parent = int(stat.read_text().rsplit(')', 1)[1].split()[1])
        except (FileNotFoundError, ProcessLookupError):
            continue
        pid = int(stat.parent.name)
        if parent == cell and pid not in nodes.values():
            found[f'helper {len(found) + 1}'] = pid
    return found


def measured_cell(
    options: list[str], seconds: float
) -> tuple[float, Use, dict[str, dict[str, list[dict[str, Any]]]]]:
    """Time until the cell is ready (s), what it takes at rest, and its graph."""
    start = time.monotonic()
    with tempfile.NamedTemporaryFile('w') as printed:
        cell = subprocess.Popen([CELL, '--headless', *options], stdout=printed)
        try:
            while READY not in Path(printed.name).read_text():
                if cell.poll() is not None or time.monotonic() - start > START_TIMEOUT:
                    raise SystemExit(f'the cell is not ready:\n{Path(printed.name).read_text()}')
                time.sleep(0.02)
            ready = time.monotonic() - start
            time.sleep(SETTLING)
            pids = node_pids(cell.pid)
            use = used({'cell': cell.pid, **pids, **helpers(cell.pid, pids)}, seconds)
            rclpy.init()
            description = graph(set(pids) | {'cell_monitor'})
            rclpy.shutdown()
        finally:
            cell.send_signal(signal.SIGINT)
            cell.wait()
    description['cell'] = description.pop('cell_monitor')
    return ready, use, description


def measured_bare(description: dict[str, Any], seconds: float) -> Use:
    """What the bare nodes take."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / 'graph.json'
        file.write_text(json.dumps(description))
        processes = {name: subprocess.Popen([sys.executable, '-P', BARE, file, name]) for name in description}
        try:
            time.sleep(2 * SETTLING)
            return used({name: process.pid for name, process in processes.items()}, seconds)
        finally:
            for process in processes.values():
                process.send_signal(signal.SIGINT)
            for process in processes.values():
                process.wait()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--seconds', type=float, default=30.0, help='for which each group is measured')
    parser.add_argument('--markdown', action='store_true', help='print the table for the documentation')
    options, cell_options = parser.parse_known_args()
    choose_transports()
    ready, ours, description = measured_cell(cell_options, options.seconds)
    bare = measured_bare(description, options.seconds)
    line = '| {} | {} | {} | {} |' if options.markdown else '{:26} {:>10} {:>12} {:>10}'
    print(line.format('node', 'processor', 'bare rclpy', 'memory'))
    if options.markdown:
        print(line.format(*['---'] * 4))
    for name in sorted(ours.cpu, key=lambda one: -ours.cpu[one]):
        cells = f'{ours.cpu[name]:.1f} %', f'{bare.cpu.get(name, 0.0):.1f} %', f'{ours.memory[name]:.0f} MB'
        print(line.format(name, *cells))
    total = f'{sum(ours.cpu.values()):.1f} %', f'{sum(bare.cpu.values()):.1f} %'
    print(line.format('all', *total, f'{sum(ours.memory.values()):.0f} MB'))
    print(f'\nready in {ready:.1f} s')


if __name__ == '__main__':
    main()
