"""Every executable of the built workspace, started the way `ros2 run` finds it."""

from __future__ import annotations

import itertools
import os
import re
import select
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

import pytest
from ament_index_python.packages import get_package_prefix
from diagnostic_msgs.msg import DiagnosticArray

from robots_controller.live_cell.cell_graph import NodeDescription
from robots_controller.live_cell.processes import fork_server
from robots_controller.live_cell.processes.node_processes import NodeProcess
from robots_core.ros.peers.heartbeat import HeartbeatWatch
from robots_core.ros.timed_node import TimedNode

PACKAGES = ('robots_core', 'robots_planning', 'robots_controller')
EXECUTABLES = sorted(
    {
        (point.value.split('.')[0], point.name)
        for point in entry_points(group='console_scripts')
        if point.value.startswith(PACKAGES)
    }
)
NODES = [(package, name) for package, name in EXECUTABLES if name.endswith('_node')]
ONE_NODE_EACH = [next(node for node in NODES if node[0] == package) for package in PACKAGES]
PROGRAMS = [name for _, name in EXECUTABLES if not name.endswith('_node')]

DEADLINE = 240.0  # s, on a slow and busy machine
SIGNAL_PERIOD = 0.05  # s, between two signals to nodes that end
# Printed by a process in which Fast DDS hangs, see `bounded_end`; its node may have logged lines before.
HUNG_AT_ITS_END = re.compile(r'^Timeout \(.* in _end$', re.MULTILINE | re.DOTALL)


def path_of(package: str, executable: str) -> Path:
    return Path(get_package_prefix(package), 'lib', package, executable)


def forked(executable: str, package: str, folder: Path) -> NodeProcess:
    """The node in a process as `cell` forks it; loaded once for all of them."""
    parameters: dict[str, Any] = {'robot_model': 'bello_bot'}
    if executable in ('visualizer_node', 'pendant_node'):
        parameters['port'] = 0
    node = NodeDescription(package, executable, parameters)
    return NodeProcess(executable, [node], namespace='/', log=folder / f'{executable}.log')


@pytest.mark.parametrize(('package', 'executable'), EXECUTABLES)
def test_is_in_the_ament_index(package: str, executable: str) -> None:
    prefix = Path(get_package_prefix(package))
    assert path_of(package, executable).is_file()
    assert (prefix / 'share' / package / 'package.xml').is_file()
    assert (prefix / 'share' / 'ament_index' / 'resource_index' / 'packages' / package).is_file()


@pytest.mark.parametrize(('package', 'executable'), ONE_NODE_EACH)
def test_node_names_a_robot_that_does_not_exist(ros_domain: int, package: str, executable: str) -> None:
    del ros_domain
    command = [str(path_of(package, executable)), '--ros-args', '-p', 'robot_model:=no_such_robot']
    result = subprocess.run(command, capture_output=True, text=True, timeout=DEADLINE, check=False)
    assert result.returncode == 2
    assert "unknown robot 'no_such_robot'; robots are: bello_bot" in result.stderr
    assert 'Traceback' not in result.stderr


@pytest.fixture
def signal_handlers() -> Iterator[None]:
    """Those of this process stay as they are."""
    handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
    yield
    for number, handler in handlers.items():
        signal.signal(number, handler)


@pytest.mark.usefixtures('signal_handlers')
@pytest.mark.parametrize('executable', PROGRAMS)
def test_program_explains_itself(
    executable: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, 'argv', [executable, '--help'])
    (point,) = entry_points(group='console_scripts', name=executable)
    with pytest.raises(SystemExit, match=r'^0$'):
        point.load()()
    assert capsys.readouterr().out.startswith(f'usage: {executable} ')


def test_nodes_report_health_and_life_and_end_however_often_they_are_interrupted(
    ros_nodes: Any, tmp_path: Path
) -> None:
    names: set[str] = set()
    changes: list[tuple[str, bool]] = []
    node = ros_nodes.add(TimedNode('watcher', context=ros_nodes.context))
    node.create_subscription(
        DiagnosticArray, '/diagnostics', lambda m: names.update(s.name for s in m.status), 100
    )
    executables = [executable for _, executable in NODES]
    watch = HeartbeatWatch(node, executables, 3.0, lambda name, reason: changes.append((name, bool(reason))))
    fork_server.start()
    processes = {executable: forked(executable, package, tmp_path) for package, executable in NODES}
    try:
        ros_nodes.wait_for(
            lambda: names.issuperset(f'/{executable}' for executable in processes),
            what='health of all nodes',
        )
        ros_nodes.wait_for(lambda: not watch.unseen, what='heartbeats of all nodes')
        for number, lost in ((signal.SIGSTOP, True), (signal.SIGCONT, False)):
            processes['planning_node'].send_signal(number)
            ros_nodes.wait_for(
                lambda lost=lost: ('planning_node', lost) in changes,
                what=f'a frozen process, lost: {lost}',
            )
        # As `ros2 launch` does on Ctrl-C: once from the terminal, once from launch, which then insists.
        deadline = time.monotonic() + DEADLINE
        for number in itertools.cycle((signal.SIGINT, signal.SIGINT, signal.SIGTERM)):
            running = [process for process in processes.values() if process.running]
            if not running or time.monotonic() > deadline:
                break
            for process in running:
                process.send_signal(number)
            running[0].wait(SIGNAL_PERIOD)
    finally:
        for process in processes.values():
            process.send_signal(signal.SIGKILL)
    hung = []
    for executable, process in processes.items():
        output = (tmp_path / f'{executable}.log').read_text()
        if process.reason == 'ended with exit code 1' and HUNG_AT_ITS_END.search(output):
            hung.append(executable)
            continue
        assert process.reason == 'ended with exit code 0', f'{executable}: {output}'
        assert 'Traceback' not in output, executable
    assert len(hung) <= 1, hung


def test_an_interrupt_ends_a_node_that_is_still_being_made(ros_domain: int) -> None:
    del ros_domain
    lines = (
        'import sys, threading',
        'from robots_core.ros.running.run import run',
        'def make_node():',
        '    print("making", flush=True)',
        '    threading.Event().wait()  # a large model is loaded',
        'sys.exit(run(make_node))',
    )
    process = subprocess.Popen(
        [sys.executable, '-c', '\n'.join(lines)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    try:
        assert process.stdout is not None
        assert process.stdout.readline() == 'making\n'
        process.send_signal(signal.SIGINT)
        output, _ = process.communicate(timeout=DEADLINE)
    finally:
        process.kill()
    assert process.returncode == 0, output
    assert output == ''


@pytest.mark.parametrize('what', ['node', 'listener of a cell'])
def test_what_hangs_at_its_end_is_ended(ros_domain: int, what: str) -> None:
    del ros_domain
    hanging = (
        'import ctypes, sys',
        'from robots_core import process_end',
        'from robots_core.ros.running import run',
        'from robots_core.ros.timed_node import TimedNode',
        'process_end.END_DEADLINE = 0.1',
        'class Hanging(TimedNode):',
        '    def destroy_node(self):',
        '        ctypes.PyDLL(None).pause()  # as Fast DDS can: no other thread runs Python meanwhile',
    )
    lines = {
        'node': (
            'def make_node():',
            '    node = Hanging("hanging")',
            '    node.context.try_shutdown()',
            '    return node',
            'sys.exit(run.run(make_node))',
        ),
        'listener of a cell': (
            'from robots_controller.live_cell import cell_listener',
            'cell_listener.CellMonitor = lambda **_: Hanging("hanging")',
            'with cell_listener.listen("/", None):',
            '    pass',
        ),
    }
    process = subprocess.run(
        [sys.executable, '-c', '\n'.join((*hanging, *lines[what]))],
        check=False,
        capture_output=True,
        text=True,
        timeout=DEADLINE,
    )
    assert process.returncode == 1
    assert process.stderr.startswith('Timeout (0:00:00.1')
    assert 'in destroy_node' in process.stderr


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize('package', PACKAGES)
def test_an_interrupt_ends_a_node_that_is_still_being_loaded(
    tmp_path: Path, package: str, number: signal.Signals
) -> None:
    lines = (
        f'import {package}.nodes',
        'import threading',
        'try:',
        '    print("loading", flush=True)',
        '    threading.Event().wait()  # a large module is imported',
        'except BaseException:  # as libraries guard what they can do without',
        '    print("went on")',
    )
    script = tmp_path / 'large_node'
    script.write_text('\n'.join(lines))
    process = subprocess.Popen(
        [sys.executable, str(script)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    try:
        assert process.stdout is not None
        assert process.stdout.readline() == 'loading\n'
        process.send_signal(number)
        output, _ = process.communicate(timeout=DEADLINE)
    finally:
        process.kill()
    assert process.returncode == 0, output
    assert output == ''


def test_what_is_no_node_minds_its_interrupts_itself(tmp_path: Path) -> None:
    script = tmp_path / 'cell'
    # Python's handler is not there in what a shell started in the background, which ignores interrupts.
    script.write_text(
        'import signal\n'
        'signal.signal(signal.SIGINT, signal.default_int_handler)\n'
        'import robots_controller.nodes\n'
        'assert signal.getsignal(signal.SIGINT) is signal.default_int_handler\n'
    )
    subprocess.run([sys.executable, str(script)], check=True)


def test_the_fork_server_ends_with_its_cell_while_it_still_loads() -> None:
    server = (
        'import os, threading',
        'import robots_controller.live_cell.processes.parent_end',
        'print(os.getpid(), flush=True)',
        'threading.Event().wait()  # much is imported',
    )
    cell = f'import subprocess, sys; subprocess.run([sys.executable, "-c", {chr(10).join(server)!r}])'
    process = subprocess.Popen([sys.executable, '-c', cell], stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        loading = os.pidfd_open(int(process.stdout.readline()))
    finally:
        process.kill()
    assert select.select([loading], [], [], DEADLINE)[0]
    os.close(loading)
    process.wait()
