"""What the nodes of a cell take of a core while the robot stands or moves, next to bare rclpy nodes.

Run by `make benchmark-cell-at-rest`; OPTIONS=--markdown prints the table of docs/explanation/benchmarks.md.
A bare node publishes the messages of the node beside it at the same rates, by timers of rclpy, and subscribes
to the same topics with callbacks that do nothing. Both groups run for the same time, one after the other.
Then the references alone are received: while the robot moves, their gaps and how late they are are shown.

--moving measures while a program moves the robot to and fro. --cells 10 starts ten cells, each in its own ROS
domain, and prints what they take together. Other options are passed to `cell`, such as --composed and
--headless; without the latter the 3D view runs too, which no browser shows.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from trajectory_msgs.msg import JointTrajectory

from node_pids import node_pids
from robots_core import load_robot_model
from robots_core.ros.messages import message_class
from robots_core.ros.qos import SENSOR
from robots_core.ros.running.middleware import choose_transports
from ros_domains import reserved_domain

CELL = Path('install/robots_controller/lib/robots_controller/cell')
BARE = Path(__file__).with_name('bare_nodes.py')
START_TIMEOUT = 120.0  # s
SETTLING = 5.0  # s, after which nothing starts any more
COUNTING = 5.0  # s
NOT_OURS = {'/rosout', '/parameter_events'}
TICKS = os.sysconf('SC_CLK_TCK')
READY = 'the cell is ready'
ROBOT = 'bello_bot'
SWING = 20.0  # deg, of the first axis to both sides
RATE = 250.0  # Hz, of the references
MONITOR = 'cell_monitor'
OBSERVER = 'observer'
Graph = dict[str, dict[str, list[dict[str, Any]]]]


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


@dataclass(frozen=True)
class Kept:
    """How a cell kept the time of its references.

    Attributes:
        gaps: Between them, ms.
        late: From the time that they are for to their sending, ms.
    """

    gaps: np.ndarray
    late: np.ndarray

    @property
    def line(self) -> str:
        """For a person."""
        deviation = np.percentile(np.abs(self.gaps - 1e3 / RATE), 99.0)
        return (
            f'references: deviation of the period {deviation:.2f} ms (99 %), '
            f'longest gap {self.gaps.max():.1f} ms, sent {np.median(self.late):.2f} ms (median), '
            f'{np.percentile(self.late, 99.0):.2f} ms (99 %) late'
        )


def references(seconds: float) -> Kept:
    """Of a cell that runs, by the stamps of the middleware."""
    node, executor = Node(OBSERVER), SingleThreadedExecutor()
    executor.add_node(node)
    sent, late = [], []

    def take(message: JointTrajectory, info: dict[str, int]) -> None:
        stamp = message.header.stamp
        sent.append(info['source_timestamp'])
        late.append(1e-6 * info['source_timestamp'] - 1e3 * stamp.sec - 1e-6 * stamp.nanosec)

    reading = QoSProfile(depth=1000, reliability=SENSOR.reliability)
    node.create_subscription(JointTrajectory, 'joint_reference', take, reading)
    start = time.monotonic()
    while time.monotonic() - start < seconds:
        executor.spin_once(timeout_sec=0.1)
    node.destroy_node()
    executor.shutdown()
    return Kept(1e-6 * np.diff(sent), np.array(late))


def graph() -> Graph:
    """Publishers with their rates, and subscriptions, of each node."""
    node = Node(OBSERVER)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    deadline = time.monotonic() + COUNTING
    while time.monotonic() < deadline:
        executor.spin_once(timeout_sec=0.1)
    nodes = {name for name in node.get_node_names() if not name.startswith('_')} - {OBSERVER}
    found: Graph = {name: {'publishers': [], 'subscriptions': []} for name in sorted(nodes)}
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


@contextlib.contextmanager
def running_cell(
    options: list[str], environment: Mapping[str, str] = MappingProxyType({})
) -> Iterator[tuple[int, float]]:
    """Process id of a cell, and the time until it was ready, s."""
    start = time.monotonic()
    with tempfile.NamedTemporaryFile('w') as printed:
        cell = subprocess.Popen(
            [CELL, *options], stdout=printed, stderr=subprocess.STDOUT, env={**os.environ, **environment}
        )
        try:
            while READY not in Path(printed.name).read_text():
                if cell.poll() is not None or time.monotonic() - start > START_TIMEOUT:
                    raise SystemExit(f'the cell is not ready:\n{Path(printed.name).read_text()}')
                time.sleep(0.02)
            ready = time.monotonic() - start
            time.sleep(SETTLING)
            yield cell.pid, ready
            if cell.poll() is not None:
                raise SystemExit(f'the cell has ended:\n{Path(printed.name).read_text()}')
        finally:
            if cell.poll() is None:
                cell.send_signal(signal.SIGINT)
            cell.wait()


def processes_of(cell: int) -> dict[str, int]:
    """By name."""
    pids = node_pids(cell)
    return {'cell': cell, **pids, **helpers(cell, pids)}


def measured_cell(options: list[str], seconds: float) -> tuple[float, Use, Graph, Kept]:
    """Time until the cell is ready (s), what it takes, its graph, and its references."""
    with running_cell(options) as (cell, ready):
        use = used(processes_of(cell), seconds)
        rclpy.init()
        kept, description = references(seconds), graph()
        rclpy.shutdown()
    description['cell'] = description.pop(MONITOR)
    return ready, use, description, kept


def measured_cells(count: int, options: list[str], seconds: float) -> None:
    """Print what several cells take together."""
    with contextlib.ExitStack() as running:
        started = [
            running.enter_context(running_cell(options, running.enter_context(reserved_domain())))
            for _ in range(count)
        ]
        pids = {
            f'{number} {name}': pid
            for number, (cell, _) in enumerate(started)
            for name, pid in processes_of(cell).items()
        }
        use = used(pids, seconds)
    sizes = [sum(use.memory[name] for name in pids if name.split()[0] == str(n)) for n in range(count)]
    print(
        f'{count} cells, {len(pids)} processes: {sum(sizes):.0f} MB '
        f'({min(sizes):.0f} to {max(sizes):.0f} each), '
        f'{sum(use.cpu.values()):.0f} % of a core; the last was ready after {started[-1][1]:.1f} s'
    )


def swinging_program(folder: str) -> Path:
    """A program that always moves the robot."""
    home = np.degrees(load_robot_model(ROBOT).home)
    swing = np.eye(home.size)[0] * SWING
    moves = [
        f'  ptpJointSpaceAngles({", ".join(map(repr, q.tolist()))})' for q in (home + swing, home - swing)
    ]
    program = Path(folder, 'swing.lua')
    program.write_text('\n'.join(['while true do', *moves, 'end']) + '\n')
    return program


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
            for process in processes.values():  # interrupted, Fast DDS can hang where all leave at once
                process.kill()
                process.wait()


def show(ours: Use, bare: Use, *, markdown: bool) -> None:
    """The table; nodes that share a process have one line, and their peers one each."""
    line = '| {} | {} | {} | {} |' if markdown else '{:26} {:>10} {:>12} {:>10}'
    print(line.format('node', 'processor', 'bare rclpy', 'memory'))
    if markdown:
        print(line.format(*['---'] * 4))
    for name in (*sorted(ours.cpu, key=lambda one: -ours.cpu[one]), *sorted(set(bare.cpu) - set(ours.cpu))):
        cells = (
            f'{ours.cpu[name]:.1f} %' if name in ours.cpu else '',
            f'{bare.cpu[name]:.1f} %' if name in bare.cpu else '',
            f'{ours.memory[name]:.0f} MB' if name in ours.cpu else '',
        )
        print(line.format(name, *cells))
    total = f'{sum(ours.cpu.values()):.1f} %', f'{sum(bare.cpu.values()):.1f} %'
    print(line.format('all', *total, f'{sum(ours.memory.values()):.0f} MB'))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--seconds', type=float, default=30.0, help='for which each group is measured')
    parser.add_argument('--markdown', action='store_true', help='print the table for the documentation')
    parser.add_argument('--moving', action='store_true', help='measure while a program moves the robot')
    parser.add_argument('--cells', type=int, default=1, help='so many at once, for what they take together')
    parser.add_argument('--no-peers', action='store_true', help='without the bare nodes')
    options, cell_options = parser.parse_known_args()
    choose_transports()
    with tempfile.TemporaryDirectory() as folder:
        cell_options += ['--robot', ROBOT]
        if options.moving:
            cell_options += ['--program', str(swinging_program(folder))]
        if options.cells > 1:
            measured_cells(options.cells, cell_options, options.seconds)
            return
        ready, ours, description, kept = measured_cell(cell_options, options.seconds)
    bare = Use() if options.no_peers else measured_bare(description, options.seconds)
    show(ours, bare, markdown=options.markdown)
    print(f'\nready in {ready:.1f} s')
    if options.moving:
        print(kept.line)


if __name__ == '__main__':
    main()
