"""cell: starts the whole suite for one robot, shows what it does, records it and ends it cleanly."""

import argparse
import json
import math
import os
import signal
import sys
import time
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from uuid import uuid4

from rich.console import Console
from rich.markup import escape

from robots_controller.cell_arguments import (
    EXIT_FAILED,
    EXIT_INTERRUPTED,
    EXIT_OK,
    add_cell_arguments,
    exit_code,
    take_from_program,
)
from robots_controller.editor.debug_token import new_token
from robots_controller.interpreter.lua_program import LuaProgram
from robots_controller.io.cell_io import read_cell_io
from robots_controller.live_cell.cell_events import (
    Event,
    MotionEnded,
    MotionPlanned,
    NodeHealth,
    ProgramStatus,
)
from robots_controller.live_cell.cell_graph import DEFAULT_ROBOT, NodeDescription, cell_graph
from robots_controller.live_cell.cell_listener import CellListener, listen
from robots_controller.live_cell.cell_view import CellView
from robots_controller.live_cell.left_outputs import LeftOutputs
from robots_controller.live_cell.node_processes import NodeProcesses
from robots_controller.live_cell.node_restarts import NodeRestarts
from robots_controller.live_cell.restart_policy import RestartPolicy
from robots_controller.nodes.bags.bag_recorder import BagRecorder
from robots_controller.recording.motion_record import MOTION_TOPICS
from robots_controller.runtime_folder import alone
from robots_core.blocks.following.following_methods import METHODS
from robots_core.errors import RobotsError
from robots_core.robot_choice import load_robot_model
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.ros.middleware import choose_transports
from robots_core.watchdog import WATCHDOG

START_TIMEOUT = 600.0  # s, for all nodes to be ready on a slow machine
WAIT_REPORT = 10.0  # s between reports of what is waited for
SERVICE_TIMEOUT = 60.0  # s
LOOK_TIME = 0.3  # s, for nodes of another cell to be found before the own ones are started
SETTLING_TIME = 2.0  # s after all are ready, in which another cell would have been noticed
REST_TIMEOUT = 5.0  # s, for the robot to stop on its path
POLL = 0.05  # s between looks at processes and events

FILES = ('program', 'io', 'io_map', 'scene', 'references')  # options
GRAPH_OPTIONS = (
    *FILES,
    *('robot', 'drive', 'rate', 'goal_tolerance', 'watchdog', 'payload', 'guided'),
    *('port', 'debug_port', 'lockstep'),
)

# What a report needs; the recorder is subscribed to these before the program starts.
REPORTED_TOPICS = (*MOTION_TOPICS, 'command_state', 'digital_outputs', 'joint_reference', 'joint_states')


def main() -> None:
    """Run from the command line."""
    os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    choose_transports()
    # Started in the background, a process ignores SIGINT; ended by a supervisor, it gets SIGTERM.
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.default_int_handler)
    sys.exit(exit_code(lambda console: run_cell(parse_options(sys.argv[1:]), console)))


def parse_options(arguments: Sequence[str]) -> argparse.Namespace:
    """Options from a command line.

    Raises:
        RobotsError: a program that does not exist.
    """
    parser = argparse.ArgumentParser(prog='cell', description=__doc__)
    parser.add_argument(
        '--program', default='', help='Lua robot program to run; its header names robot, scene and io'
    )
    parser.add_argument('--namespace', default='/', help='ROS namespace of all nodes')
    add_cell_arguments(parser)
    parser.add_argument('--record', type=Path, metavar='FOLDER', help='record a bag below this folder')
    parser.add_argument('--once', action='store_true', help='end when the program has ended')
    parser.add_argument('--view', action='store_true', help='with --once: stay, so that the page stays open')
    parser.add_argument('--port', type=int, default=8080, help='first port to try for the browser page')
    parser.add_argument(
        '--guided', default='', choices=METHODS, help='follow reference_pose by this inverse kinematics'
    )
    parser.add_argument(
        '--references', default='', metavar='BAG', help='recording of what guides or jogs the robot'
    )
    parser.add_argument(
        '--watchdog',
        type=float,
        default=WATCHDOG,
        metavar='SECONDS',
        help='how long a node may give no sign of life before the robot is stopped; 0: any time',
    )
    parser.add_argument('--debug-port', type=int, default=0, help='port for editors; 0 for none')
    parser.add_argument(
        '--no-restart',
        action='store_true',
        help='end when a node dies; by default it is started again, and nothing moves by that',
    )
    parser.add_argument(
        '--lockstep',
        action='store_true',
        help='simulated time that advances when all nodes have done what was due, as fast as they can',
    )
    parser.add_argument('--describe', action='store_true', help='print the nodes as JSON, and start none')
    options = parser.parse_args(arguments)
    if options.once and not options.program:
        raise RobotsError('--once needs a --program to run')
    take_from_program(options)
    options.robot = options.robot or DEFAULT_ROBOT
    options.namespace = '/' + options.namespace.strip('/')
    options.guided = options.guided or (METHODS[0] if options.references else '')
    for name in FILES:
        path = getattr(options, name)
        setattr(options, name, str(Path(path).resolve()) if path else '')
    return options


def run_cell(options: argparse.Namespace, console: Console) -> int:
    """Run a cell until its program has ended (`once`), a node dies that is not started again, or Ctrl-C.

    Returns:
        Exit code: 0 if all went well; 1 if the program failed, a target was missed, a limit was broken
        or a node died; 130 after Ctrl-C.

    Raises:
        RobotsError: an unknown robot, a program that is not Lua, or the suite is not installed.
    """
    # A wrong name and a program that is not Lua are said before anything starts.
    robot = load_robot_model(options.robot)
    if options.program:
        LuaProgram(robot.num_axes).open(options.program)
    # The launch file starts the described nodes in other processes, whose log shows a token of their own.
    token = new_token() if options.debug_port and not options.describe else ''
    graph = cell_graph(
        autostart=options.describe and bool(options.program),  # there is no cell that would start it
        launch=uuid4().hex if options.describe and options.program else '',
        debug_token=token,
        **{name: getattr(options, name) for name in GRAPH_OPTIONS},
    )
    if options.describe:
        print(json.dumps([node.as_dict() for node in graph], indent=2))
        return EXIT_OK
    place = f'cell {os.environ.get("ROS_DOMAIN_ID", "0")} {options.namespace}'
    with ExitStack() as stack:
        try:
            stack.enter_context(alone(place))
        except RobotsError as error:
            console.print(_occupied('cell', options, f' ({error})'))
            return EXIT_FAILED
        return _run_alone(options, console, graph, robot, token)


def _occupied(found: str, options: argparse.Namespace, detail: str = '') -> str:
    return (
        f'[bold red]there is another {found} in namespace {options.namespace}[/]{escape(detail)}: '
        f'another cell is running; stop it, or give this one a --namespace or a ROS_DOMAIN_ID'
    )


def _run_alone(
    options: argparse.Namespace,
    console: Console,
    graph: Sequence[NodeDescription],
    robot: BaseRobotModel,
    token: str,
) -> int:
    folder = _run_folder(options.record or Path('out'), options)
    processes = NodeProcesses(graph, namespace=options.namespace, log_folder=folder / 'log')
    job = f' runs [bold]{Path(options.program).name}[/]' if options.program else ''
    console.print(f'[bold]{options.robot}[/]{job}')
    if options.note:
        console.print(f'[yellow]{options.note}[/]')
    if token:
        console.print(
            f'editors debug at port {options.debug_port} with token [bold]{token}[/]', highlight=False
        )
    bag = folder / 'bag' if options.record else None
    with listen(options.namespace, bag, lockstep=options.lockstep) as listener:
        recorder = listener.recorder
        view = CellView(console, processes.names, robot.axes_data.prismatic)
        outputs = LeftOutputs(listener.monitor, read_cell_io(options.io, options.io_map).fail_safe)
        # A lock-step run ends with a participant that is lost.
        restarting = not (options.once or options.no_restart or options.lockstep)
        policy = RestartPolicy(options.watchdog) if restarting else None
        restarts = NodeRestarts(processes, listener.monitor, outputs, console, policy)
        cell = _Cell(options, processes, listener, view, restarts)
        try:
            if not options.lockstep and (found := cell.others()):
                console.print(_occupied(found, options))
                return EXIT_FAILED
            if options.lockstep:
                listener.coordinate(processes.names)
            processes.start()
            code = cell.run()
            cell.bring_to_rest()
            if recorder is not None:
                code = _close_recording(recorder, options, console, cell.program_ended) or code
            if options.once and options.view and cell.program_ended:
                console.print('the page stays open; Ctrl-C ends it')
                cell.watch()
        except KeyboardInterrupt:
            console.print('\nstopping ...')
            code = EXIT_INTERRUPTED
            cell.bring_to_rest()
            if recorder is not None and not recorder.closed:
                _close_recording(recorder, options, console, program_ended=False)
        finally:
            view.close()
            processes.stop()
    return code


def _close_recording(
    recorder: BagRecorder,
    options: argparse.Namespace,
    console: Console,
    program_ended: bool,  # noqa: FBT001
) -> int:
    """Close the bag and report on it; returns an exit code."""
    recorder.close()
    console.print(f'bag: {recorder.path}')
    if recorder.problem:
        return EXIT_FAILED
    if not program_ended:
        return EXIT_OK
    # Loads SciPy and the reading of meshes, which the cell itself does not need.
    from robots_controller.report.run_report import run_report  # noqa: PLC0415
    from robots_controller.report.terminal import show_verdict  # noqa: PLC0415

    report = run_report(recorder.path, robot=options.robot, namespace=options.namespace)
    show_verdict(report, console)
    return EXIT_OK if report.ok else EXIT_FAILED


class _Cell:
    """A running cell: waits for its nodes, runs the program, watches the processes."""

    def __init__(
        self,
        options: argparse.Namespace,
        processes: NodeProcesses,
        listener: CellListener,
        view: CellView,
        restarts: NodeRestarts,
    ) -> None:
        self._options, self._restarts = options, restarts
        self._processes = processes
        self._listener = listener
        self._monitor, self._recorder = listener.monitor, listener.recorder
        self._console = view.console
        self._waiting = set(processes.names)
        self._failed = False
        self._motion: str | None = None
        self._ended = False
        self._settled = math.inf
        self._recording_ended = False
        self._starting = True
        self._reported = time.monotonic()
        self._foreign = ''
        """A node of this cell's that lives in another process too."""
        self.program_ended = False
        self._view = view

    def others(self) -> str:
        """A node of this cell's names that is there before any is started; '' for none."""
        deadline = time.monotonic() + LOOK_TIME
        while time.monotonic() < deadline:
            if found := self._monitor.nodes() & set(self._processes.names):
                return min(found)
            time.sleep(POLL)
        return ''

    def run(self) -> int:
        """Until the program has ended, a node dies, or forever."""
        if not self._until(self._ready, START_TIMEOUT):
            if not self._ended:
                self._console.print(f'[bold red]not ready after {START_TIMEOUT:g} s:[/] {self._late}')
            return EXIT_FAILED
        self._settled, self._starting = time.monotonic() + SETTLING_TIME, False
        if self._options.program and not (self._call('open') and self._call('run')):
            return EXIT_FAILED
        self._listener.release()
        while self._healthy():
            self._show_events()
            # What was sent before a program fails goes on to its end, and its outputs with it.
            if self.program_ended and self._options.once and self._motion is None:
                return EXIT_FAILED if self._failed else EXIT_OK
        return EXIT_FAILED

    def watch(self) -> None:
        """Until a node dies, or forever."""
        while self._healthy():
            self._show_events()

    def bring_to_rest(self) -> None:
        """Stop a running motion on its path, before the nodes end."""
        if self._motion is None or not self._processes.runs('controller_node'):
            return
        self._monitor.call('controller_node/stop')
        deadline = time.monotonic() + REST_TIMEOUT
        while self._motion is not None and time.monotonic() < deadline:
            self._show_events()

    def _ready(self) -> bool:
        # Health changes with time, which stands still at the first instant of a lock-step run.
        ready = self._listener.held if self._options.lockstep else not self._waiting
        if ready and (self._recorder is None or self._recorder.records(REPORTED_TOPICS)):
            return True
        if time.monotonic() - self._reported >= WAIT_REPORT:
            self._reported = time.monotonic()
            self._console.print(f'waiting for {self._late}')
        return False

    @property
    def _late(self) -> str:
        return ', '.join(sorted(self._waiting)) or 'the recorder'

    def _until(self, condition: object, timeout: float) -> bool:
        deadline = time.monotonic() + timeout
        assert callable(condition)
        while not condition():
            if not self._healthy() or time.monotonic() > deadline:
                return False
            self._show_events()
        return True

    def _healthy(self) -> bool:
        """All nodes live, and this cell is alone in its place; otherwise says why not, once."""
        if self._ended:
            return False
        for node in self._processes.take_dead():
            self._console.print(f'[bold red]{node.name} {node.reason}[/]\n{escape(node.last_lines)}')
            if not self._restarts.died(node) or self._starting:
                self._ended = True
        for name in self._restarts.start_due():
            self._view.expect(name)
        if self._listener.problem:
            self._console.print(f'[bold red]{escape(self._listener.problem)}[/]')
            self._ended = True
        if self._recorder is not None and self._recorder.problem and not self._recording_ended:
            self._recording_ended = True
            self._console.print(f'[bold red]recording: {escape(self._recorder.problem)}[/]')
        # The established cell keeps the namespace; the newcomer exits.
        if self._foreign and time.monotonic() < self._settled:
            self._console.print(_occupied(self._foreign, self._options))
            self._ended = True
        return not self._ended

    def _call(self, service: str) -> bool:
        future = self._listener.call(f'lua_program_node/{service}')
        if not self._until(future.done, SERVICE_TIMEOUT):
            self._console.print(f'[bold red]lua_program_node does not answer ~/{service}[/]')
            return False
        response = future.result()
        if not response.success:
            self._console.print(f'[bold red]{response.message}[/]')
        return bool(response.success)

    def _show_events(self) -> None:
        """Show what came in since the last call."""
        for event in self._monitor.take():
            if isinstance(event, NodeHealth) and not self._processes.owns(event.node, event.pid):
                if event.node in self._processes.names:
                    self._foreign = event.node
                continue
            self._note(event)
            self._view.show(event)
        time.sleep(POLL)

    def _note(self, event: Event) -> None:
        match event:
            case NodeHealth(node=node) if event.ok or event.works:
                self._waiting.discard(node)
            case MotionPlanned(id_):
                self._motion = id_
            case MotionEnded(id_) if id_ == self._motion:
                self._motion = None
            case ProgramStatus(state):
                self._restarts.program_reported(event)
                self.program_ended = state in ('FINISHED', 'FAILED', 'STOPPED')
                self._failed = state in ('FAILED', 'STOPPED')


def _run_folder(root: Path, options: argparse.Namespace) -> Path:
    program = Path(options.program).stem or 'cell'
    robot = Path(options.robot.removeprefix('urdf:')).stem
    stamp = time.strftime('%Y%m%d-%H%M%S')
    folder = root / f'{program}_{robot}_{stamp}'
    number = 1
    while folder.exists():
        number += 1
        folder = root / f'{program}_{robot}_{stamp}_{number}'
    folder.mkdir(parents=True)
    return folder
