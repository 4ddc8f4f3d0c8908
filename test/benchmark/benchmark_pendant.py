"""The operator's page in Chromium: until it can be used, from a press to a motion, what viewers cost.

Run by `make benchmark-pendant`. The page and rclpy send the same twist in turns, and the controller is timed
with and without viewers in turns, so that a busy machine hits both. The browser draws no 3D view.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import re
import subprocess
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np
import rclpy
from browser_page import open_page, press, take_control
from geometry_msgs.msg import TwistStamped
from playwright.sync_api import Browser, CDPSession, Page
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile
from trajectory_msgs.msg import JointTrajectory

from installed_browsers import browser
from node_pids import node_pids
from printed_tables import machine, show
from robots_controller.live_cell.cell_graph import NodeDescription
from robots_controller.pendant.page.jog_panel import FIRST_SPEED
from robots_controller.report.tables import ReportTable, Row
from robots_core.ros.qos import STREAM, polled_qos
from robots_core.validation import Array
from ros_domains import reserved_domain
from soak.figures import MEANINGFUL, MemoryFigures, memory_figures

USABLE: Final = 3.0  # s: a goal
PRESSED: Final = 60.0  # ms: a goal
VIEWERS: Final = 10
START_TIME: Final = 240.0  # s
SIGN_PERIOD: Final = 0.04  # s, as the page's
STANDING: Final = 0.5  # s between two presses, in which the robot stands
BENDING: Final = 6.0  # s
KEYS: Final = ('base 2 +', 'base 2 -')
SPEED: Final = FIRST_SPEED / 100.0 * 0.25  # m/s, of the page's and of planning_node's defaults
POLL: Final = 0.005  # s
ADDRESS: Final = re.compile(rb'http://127\.0\.0\.1:\d+')
MEGABYTE: Final = 1024.0 * 1024.0
USED: Final = """() => window.socket?.connected && window.did_handshake
    && document.querySelector('.jog-panel .rows [data-press]')"""
NOTE_PRESS: Final = """() => document.addEventListener('pointerdown', (event) => {
    window.pressed = performance.timeOrigin + event.timeStamp; }, true)"""


class Watcher(Node):
    """References with the times when they were due and sent, and the peer's twist."""

    def __init__(self) -> None:
        super().__init__('pendant_benchmark')
        self.moving: list[float] = []  # when references of a moving robot were sent, s
        self.late: list[float] = []  # s
        reading = QoSProfile(depth=1000, reliability=polled_qos('joint_reference').reliability)
        self.create_subscription(JointTrajectory, 'joint_reference', self._on_reference, reading)
        self._twists = self.create_publisher(TwistStamped, 'teach_twist', STREAM)

    def _on_reference(self, message: JointTrajectory, info: dict[str, int]) -> None:
        sent, stamp = 1e-9 * info['source_timestamp'], message.header.stamp
        self.late.append(sent - stamp.sec - 1e-9 * stamp.nanosec)
        if any(message.points[0].velocities):
            self.moving.append(sent)

    def twist(self, speed: float) -> None:
        """Jog the tool along z of the base, m/s."""
        message = TwistStamped()
        message.header.stamp = self.get_clock().now().to_msg()
        message.header.frame_id = 'base'
        message.twist.linear.z = speed
        self._twists.publish(message)


@contextlib.contextmanager
def watcher() -> Iterator[Watcher]:
    rclpy.init()
    node, executor = Watcher(), SingleThreadedExecutor()
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin, daemon=True)
    thread.start()
    try:
        yield node
    finally:
        executor.shutdown()
        thread.join()
        node.destroy_node()
        rclpy.shutdown()


@contextlib.contextmanager
def cell(robot: str) -> Iterator[tuple[subprocess.Popen[bytes], str, float]]:
    """A cell with the page: its process, the address, and when that was printed, s of `time.monotonic`."""
    words = [str(NodeDescription('robots_controller', 'cell').executable_path()), '--robot', robot]
    with tempfile.TemporaryDirectory() as folder:
        child = subprocess.Popen(
            [*words, '--view', '--operating-mode', 'T1', '--port', '0'],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            stdin=subprocess.DEVNULL,
            cwd=folder,
            env=os.environ | {'PYTHONUNBUFFERED': '1'},
        )
        try:
            assert child.stdout is not None
            for line in child.stdout:
                if b'pendant_node' in line and (found := ADDRESS.search(line)):
                    break
            else:
                raise SystemExit('the cell has ended; its page needs requirements-pendant.txt')
            printed = time.monotonic()
            threading.Thread(target=child.stdout.read, daemon=True).start()  # or it would wait
            yield child, found[0].decode(), printed
        finally:
            child.terminate()
            child.wait(START_TIME)


def wait(page: Page, condition: Callable[[], Any], what: str) -> None:
    deadline = time.monotonic() + START_TIME
    while not condition():
        if time.monotonic() > deadline:
            raise SystemExit(f'{what} does not come')
        page.wait_for_timeout(1e3 * POLL)


def until_usable(running: Browser, url: str, since: float) -> tuple[Page, float]:
    """A page, and the time until it can be used, s."""
    page = running.new_context(locale='en-US').new_page()
    page.set_default_timeout(1e3 * START_TIME)
    page.goto(url, wait_until='commit')
    page.wait_for_function(USED)
    return page, time.monotonic() - since


def first_after(node: Watcher, page: Page, start: Callable[[], float], end: Callable[[], None]) -> float:
    """Time from the start of a jog to the first reference of a moving robot, ms."""
    page.wait_for_timeout(1e3 * STANDING)
    node.moving.clear()
    began = start()
    wait(page, lambda: node.moving, 'a motion')
    end()
    return 1e3 * (node.moving[0] - began)


def press_delay(node: Watcher, page: Page, key: str) -> float:
    """By the button of the page, from the browser's time of the event."""

    def start() -> float:
        press(page, f'[data-press="{key}"]')
        return 1e-3 * float(page.evaluate('() => window.pressed'))

    return first_after(node, page, start, page.mouse.up)


def twist_delay(node: Watcher, page: Page, speed: float) -> float:
    """By rclpy, from the first message."""
    stop = threading.Event()

    def send() -> None:
        while not stop.is_set():
            node.twist(speed)
            stop.wait(SIGN_PERIOD)

    sending = threading.Thread(target=send, daemon=True)

    def start() -> float:
        began = time.time()
        sending.start()
        return began

    def end() -> None:
        stop.set()
        sending.join()

    return first_after(node, page, start, end)


def bend(node: Watcher, page: Page) -> None:
    """Jog a wrist axis away from where the wrist may be singular."""
    press(page, '[data-press="axes 4 +"]')
    wait(page, lambda: node.moving, 'a jog of an axis')
    page.wait_for_timeout(1e3 * BENDING)
    page.mouse.up()


def delays(node: Watcher, page: Page, count: int) -> tuple[Array, Array]:
    """Of the page and of rclpy, ms, in turns."""
    take_control(page)
    bend(node, page)
    page.locator('.jog-panel').get_by_role('button', name='Base', exact=True).click()
    page.locator(f'[data-press="{KEYS[0]}"]').wait_for()
    page.evaluate(NOTE_PRESS)
    found: tuple[list[float], list[float]] = [], []
    for number in range(count):
        way = number % 2
        found[0].append(press_delay(node, page, KEYS[way]))
        found[1].append(twist_delay(node, page, SPEED * (1 - 2 * way)))
    return np.array(found[0]), np.array(found[1])


def lateness(node: Watcher, running: Browser, url: str, seconds: float, rounds: int) -> tuple[Array, Array]:
    """Of references, s: without viewers, and with `VIEWERS`."""
    found: tuple[list[float], list[float]] = [], []
    for _ in range(rounds):
        for side, viewers in enumerate((0, VIEWERS)):
            pages = [open_page(running, url) for _ in range(viewers)]
            node.late.clear()
            time.sleep(seconds)
            found[side].extend(node.late)
            for page in pages:
                page.context.close()
    return np.array(found[0]), np.array(found[1])


def browser_memory() -> float:
    """MB of all processes of the browser that this process has started, shared with no file."""
    parents: dict[int, int] = {}
    names: dict[int, str] = {}
    for stat in Path('/proc').glob('[0-9]*/stat'):
        with contextlib.suppress(OSError):
            name, rest = stat.read_text().partition('(')[2].rsplit(')', 1)
            pid = int(stat.parent.name)
            parents[pid], names[pid] = int(rest.split()[1]), name
    total = 0.0
    for pid, name in names.items():
        above = pid
        while above not in (os.getpid(), 0):
            above = parents.get(above, 0)
        if above and 'chrom' in name:
            with contextlib.suppress(OSError):
                total += memory(pid)
    return total


def memory(pid: int) -> float:
    """MB of a process that it shares with no file."""
    found = re.search(r'^RssAnon:\s*(\d+) kB', Path(f'/proc/{pid}/status').read_text(), re.MULTILINE)
    return 0.0 if found is None else 1024.0 * int(found[1]) / MEGABYTE


def page_memory(session: CDPSession) -> float:
    """MB that the scripts of a page hold; what nothing refers to is collected before."""
    session.send('HeapProfiler.collectGarbage')
    metrics = session.send('Performance.getMetrics')['metrics']
    return next(one['value'] for one in metrics if one['name'] == 'JSHeapUsedSize') / MEGABYTE


def growth(child: subprocess.Popen[bytes], page: Page, duration: float) -> tuple[MemoryFigures, ...]:
    """Memory of browser, page and node while one page is open."""
    session = page.context.new_cdp_session(page)
    session.send('Performance.enable')
    began, samples = time.monotonic(), []
    period = max(1.0, duration / 360.0)
    while (now := time.monotonic() - began) < duration:
        node = node_pids(child.pid)['pendant_node']
        held = {'scripts of the page': page_memory(session)}
        samples.append((now, held | {'browser': browser_memory(), 'pendant_node': memory(node)}))
        page.wait_for_timeout(1e3 * period)
    return memory_figures(samples)


def row(what: str, ours: str, peer: str = '', goal: str = '', *, bad: bool = False) -> Row:
    return Row((what, ours, peer, goal), bad=bad)


def main() -> None:
    """Measure, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        'duration', type=float, nargs='?', default=3600.0, help='in which memory is measured, s'
    )
    parser.add_argument('--robot', default='kuka_kr210_r2700')
    parser.add_argument('--count', type=int, default=30, help='presses of a button')
    parser.add_argument('--seconds', type=float, default=20.0, help='in which the controller is measured')
    parser.add_argument('--rounds', type=int, default=3, help='with viewers and without')
    parser.add_argument('--markdown', action='store_true', help='print Markdown')
    options = parser.parse_args()
    with contextlib.ExitStack() as ending:
        os.environ.update(ending.enter_context(reserved_domain()))
        running = ending.enter_context(browser('--disable-gpu'))
        child, url, printed = ending.enter_context(cell(options.robot))
        page, first = until_usable(running, url, printed)
        again, second = until_usable(running, url, time.monotonic())
        again.context.close()
        node = ending.enter_context(watcher())
        wait(page, lambda: len(node.late) > 100 and 'connected' in page.inner_text('.bar'), 'the cell')
        pressed, sent = delays(node, page, options.count)
        page.context.close()
        alone, watched = lateness(node, running, url, options.seconds, options.rounds)
        page = open_page(running, url)
        grown = growth(child, page, options.duration)
        page.context.close()
    ours, peer = float(np.median(pressed)), float(np.median(sent))
    without, within = (1e3 * float(np.percentile(late, 99.0)) for late in (alone, watched))
    rows = [
        row(
            'address printed until the page can be used',
            f'{first:.1f} s',
            '',
            f'{USABLE:g} s',
            bad=first > USABLE,
        ),
        row('another page until it can be used', f'{second:.1f} s', '', f'{USABLE:g} s', bad=second > USABLE),
        row(
            f'press of a button until joint_reference changes, median of {options.count}',
            f'{ours:.0f} ms',
            f'{peer:.0f} ms (rclpy)',
            f'{PRESSED:g} ms',
            bad=ours > PRESSED,
        ),
        row(
            f"controller's lateness, p99, with {VIEWERS} viewers",
            f'{within:.2f} ms',
            f'{without:.2f} ms (without)',
        ),
        *(
            row(
                f'memory of {one.name} in {options.duration:.0f} s',
                f'{one.megabytes[-1]:.0f} MB, {one.slope:+.1f} MB/h'
                if options.duration >= MEANINGFUL
                else f'{one.megabytes[-1]:.0f} MB, too short for a slope',
            )
            for one in grown
        ),
    ]
    columns = (('what', 'text'), ('ours', 'number'), ('peer', 'number'), ('goal', 'number'))
    show(ReportTable(f"The operator's page, {machine()}", columns, rows), markdown=options.markdown)


if __name__ == '__main__':
    main()
