"""How well the controller keeps time, next to a bare rclpy timer, and how soon a motion call moves the robot.

Run by `make benchmark-controller`. Timer and controller take turns, so that a busy machine hits both.
"""

from __future__ import annotations

import argparse
import contextlib
import itertools
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rich.console import Console
from rich.progress import track
from rich.table import Table
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

from robots_controller.live_cell.cell_graph import NodeDescription
from robots_core import load_robot_model
from robots_core.periodic.realtime import IDLE_LATENCY_DEVICE
from robots_core.ros.qos import SENSOR
from robots_core.ros.running.middleware import choose_transports

HERE = Path(__file__).parent
MOVES = 20
FEEDBACK_RATE = 100.0  # Hz, as slow as drives come
TIMER, CONTROLLER, ASLEEP = 'timer', 'ours', 'asleep'
TARGETS = {'period p99, us': 0.5, 'CPU each, us': 0.3}  # of the timer's


@dataclass(frozen=True)
class Timing:
    """One run: deviations of the period (us), and what the publishing process took of the CPU.

    Both its share and its time per reference (us): who cannot keep the rate on a busy machine has less to do.
    And whether a thread of it is scheduled first in, first out.
    """

    deviation: np.ndarray
    cpu_share: float
    cpu_time: float
    realtime: bool


class Receiver(Node):
    """Collects when each `joint_reference` was sent, by the middleware's own stamp.

    Each side is read once, by this, as drives read it; a standing robot's `joint_states` come from here too.
    """

    def __init__(self, names: tuple[str, ...], home: np.ndarray) -> None:
        super().__init__('receiver')
        self.stamps: list[int] = []
        reading = QoSProfile(depth=1000, reliability=SENSOR.reliability)
        self.create_subscription(JointTrajectory, 'joint_reference', self._on_message, reading)
        feedback = self.create_publisher(JointState, 'joint_states', QoSProfile(depth=1))
        state = JointState(name=list(names), position=home.tolist())
        self.create_timer(1.0 / FEEDBACK_RATE, lambda: feedback.publish(state))

    def _on_message(self, message: JointTrajectory, info: dict[str, int]) -> None:
        del message
        self.stamps.append(info['source_timestamp'])


def cpu_seconds(pid: int) -> float:
    fields = Path(f'/proc/{pid}/stat').read_text().rsplit(')', 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf('SC_CLK_TCK')


def realtime(pid: int) -> bool:
    threads = (int(task.name) for task in Path(f'/proc/{pid}/task').iterdir())
    return any(os.sched_getscheduler(thread) == os.SCHED_FIFO for thread in threads)


@contextlib.contextmanager
def process(*command: str) -> Iterator[int]:
    child = subprocess.Popen(
        command, start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        yield child.pid
    finally:
        child.send_signal(signal.SIGINT)
        child.wait(10.0)


def measure(receiver: Receiver, pid: int, rate: float, seconds: float) -> Timing:
    receiver.stamps.clear()
    deadline = time.monotonic() + 30.0
    while len(receiver.stamps) < rate:  # one second of warm-up
        if time.monotonic() > deadline:
            raise SystemExit('no joint_reference arrives')
        time.sleep(0.01)
    receiver.stamps.clear()
    cpu, start = cpu_seconds(pid), time.monotonic()
    time.sleep(seconds)
    used, elapsed = cpu_seconds(pid) - cpu, time.monotonic() - start
    stamps = np.array(receiver.stamps)
    deviation = np.abs(np.diff(stamps) / 1e3 - 1e6 / rate)
    return Timing(deviation, used / elapsed, 1e6 * used / stamps.size, realtime(pid))


def node_command(node: NodeDescription) -> list[str]:
    command = [str(node.executable_path()), '--ros-args']
    for name, value in node.parameters.items():
        command += ['-p', f'{name}:={value}']
    return command


def run_timings(robot: str, rate: float, seconds: float, rounds: int) -> dict[str, list[Timing]]:
    """Runs of each side: the timer, and the controller as it is and with processors that may sleep."""
    model = load_robot_model(robot)
    names = model.axes_data.names
    parameters = {'robot_model': robot, 'rate': rate, 'resting_rate': rate}  # the robot stands all the time
    timer = [sys.executable, str(HERE / 'bare_timer.py'), str(rate), ','.join(names)]
    commands = {TIMER: timer}
    for side, options in {CONTROLLER: {}, ASLEEP: {'idle_latency': -1.0}}.items():
        node = NodeDescription('robots_controller', 'controller_node', parameters | options)
        commands[side] = node_command(node)
    choose_transports()  # for all processes alike
    rclpy.init()
    receiver, executor = Receiver(names, model.home), SingleThreadedExecutor()
    executor.add_node(receiver)
    thread = threading.Thread(target=executor.spin, daemon=True)
    thread.start()
    runs: dict[str, list[Timing]] = {side: [] for side in commands}
    for _ in track(range(rounds), description='measuring', transient=True):
        for side, command in commands.items():
            with process(*command) as pid:
                runs[side].append(measure(receiver, pid, rate, seconds))
    executor.shutdown()
    thread.join()
    receiver.destroy_node()
    rclpy.shutdown()
    return runs


def run_delays(robot: str) -> np.ndarray:
    """Time from a Lua motion call (the stamp of its command) to the first changed reference, ms."""
    home = np.degrees(load_robot_model(robot).home)
    with tempfile.TemporaryDirectory() as folder:
        lines = []
        for move in range(MOVES):
            q = home.copy()
            q[0] += 2.0 * (-1) ** move
            lines.append(f'ptpJointSpaceAngles({", ".join(map(repr, q.tolist()))})')
        program = Path(folder, 'delay.lua')
        program.write_text('\n'.join(lines) + '\n')
        cell = NodeDescription('robots_controller', 'cell').executable_path()
        command = [str(cell), '--robot', robot, '--program', str(program), '--record', folder, '--once']
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        return delays_of(next(Path(folder).glob('*/bag')))


def delays_of(bag: Path) -> np.ndarray:
    typestore = get_typestore(Stores.ROS2_JAZZY)
    commands, references = [], []
    with Reader(bag) as reader:
        for connection, _, data in reader.messages():
            topic = connection.topic.rsplit('/', 1)[-1]
            if topic not in ('ptpjoint_joint', 'joint_reference'):
                continue
            message = typestore.deserialize_cdr(data, connection.msgtype)
            stamp = message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec
            if topic == 'ptpjoint_joint':
                commands.append(stamp)
            else:
                references.append((stamp, message.points[0].positions.tolist()))
    changes = np.array([new[0] for old, new in itertools.pairwise(references) if old[1] != new[1]])
    firsts = [changes[np.searchsorted(changes, command)] for command in commands]
    return 1e3 * (np.array(firsts) - np.array(commands))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--robot', default='kuka_kr210_r2700')
    parser.add_argument('--rate', type=float, default=1000.0, help='Hz')
    parser.add_argument('--seconds', type=float, default=6.0, help='per run')
    parser.add_argument('--rounds', type=int, default=5)
    options = parser.parse_args()
    runs = run_timings(options.robot, options.rate, options.seconds, options.rounds)
    console = Console()
    length = f'{options.rounds} x {options.seconds:g} s'
    table = Table(
        title=f'joint_reference at {options.rate:g} Hz, {length}, medians',
        caption='period: deviation from it; CPU: of the process, also for each reference\n'
        'asleep: with -p idle_latency:=-1.0, idle processors sleep, which takes less power',
    )
    table.add_column('', no_wrap=True)
    for column in (TIMER, CONTROLLER, 'ratio', ASLEEP, 'ratio', 'target'):
        table.add_column(column, justify='right')

    def row(name: str, value: Callable[[Timing], float]) -> None:
        timer, controller, asleep = (float(np.median([value(run) for run in runs[side]])) for side in runs)
        cells = [f'{timer:.3g}']
        for ours in (controller, asleep):
            cells += [f'{ours:.3g}', f'{ours / timer:.2f}']
        table.add_row(name, *cells, f'{TARGETS[name]:g}' if name in TARGETS else '')

    for quantile in (50.0, 99.0, 99.9):
        name = f'period p{quantile:g}, us'
        row(name, lambda run, quantile=quantile: float(np.percentile(run.deviation, quantile)))
    row('CPU share, %', lambda run: 100.0 * run.cpu_share)
    row('CPU each, us', lambda run: run.cpu_time)
    console.print(table)
    granted = all(run.realtime for run in runs[CONTROLLER])
    console.print(f'FIFO scheduling of the controller: {"granted" if granted else "not permitted here"}')
    awake = os.access(IDLE_LATENCY_DEVICE, os.W_OK)
    console.print(f'idle_latency: {"granted" if awake else "not permitted here"}')
    delays = run_delays(options.robot)
    console.print(
        f'Lua motion call to first changed reference at 250 Hz, {delays.size} moves: '
        f'median {np.median(delays):.1f} ms, worst {delays.max():.1f} ms'
    )


if __name__ == '__main__':
    main()
