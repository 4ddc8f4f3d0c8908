"""cell: start all nodes of one robot, show and record what they do, and end them cleanly."""

import argparse
import json
import os
import signal
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from importlib.util import find_spec
from pathlib import Path
from uuid import uuid4

from rich.console import Console

from robots_controller.commands.cell_arguments import CELL_OPTIONS, FILES
from robots_controller.commands.cell_setup import show_substitutions, take_from_program
from robots_controller.commands.command_table import CELL
from robots_controller.editor.debug_token import new_token
from robots_controller.interpreter.lua_program import LuaProgram
from robots_controller.live_cell.cell_graph import DEFAULT_ROBOT, NodeDescription, cell_graph
from robots_controller.live_cell.cell_listener import CellListener, listen
from robots_controller.live_cell.cell_view import CellView
from robots_controller.live_cell.node_processes import NodeProcesses
from robots_controller.live_cell.running_cell import RunningCell, occupied
from robots_controller.program_check.first_check import check_first, sizes_of
from robots_controller.runtime_folder import alone
from robots_core.blocks.following.following_methods import METHODS
from robots_core.errors import InstallationError, OptionError, RobotsError
from robots_core.exit_codes import ExitCode
from robots_core.robot_choice import load_robot_model
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.ros.middleware import choose_transports

GRAPH_OPTIONS = (
    *CELL_OPTIONS,
    'program',
    'driver',
    'watchdog',
    'port',
    'debug_port',
    'pendant',
    'opcua',
    'opcua_access',
    'host',
    'password_file',
    'record',
    'lockstep',
    'composed',
    'headless',
)


def start(options: argparse.Namespace, console: Console) -> int:
    """Run a cell as the command line says; see `run_cell`."""
    os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    choose_transports()
    # Started in the background, a process ignores SIGINT; ended by a supervisor, it gets SIGTERM.
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.default_int_handler)
    return run_cell(complete_options(options), console)


def parse_options(arguments: Sequence[str]) -> argparse.Namespace:
    """Options from a command line, and from its program.

    Raises:
        RobotsError: an option that is not valid, or a program that does not exist.
    """
    return complete_options(CELL.parse(arguments))


def complete_options(options: argparse.Namespace) -> argparse.Namespace:
    """Take from the program what the command line does not say.

    Raises:
        RobotsError: a program that does not exist.
    """
    if options.once and not options.program:
        raise OptionError('--once needs a --program to run')
    take_from_program(options)
    options.robot = options.robot or DEFAULT_ROBOT
    others = options.references or options.contact or options.orbit or options.cabin
    options.guided = options.guided or (METHODS[0] if others else '')
    # Nobody operates a cell whose time does not wait.
    options.pendant = options.view and not options.lockstep and find_spec('nicegui') is not None
    if options.view and options.headless:
        raise OptionError('--view and --headless exclude each other')
    if (options.host or options.password_file) and not options.view:
        raise OptionError("--host and --password-file need --view, which serves the operator's page")
    if options.opcua and options.lockstep:
        raise OptionError('--opcua and --lockstep exclude each other: clients would see a time of its own')
    if options.opcua_access and not options.opcua:
        raise OptionError('--opcua-access needs --opcua, the port of the server')
    if options.opcua and find_spec('asyncua') is None:
        raise InstallationError('--opcua needs the package asyncua: make plant-requirements')
    for name in ('program', 'driver', 'opcua_access', 'password_file', *FILES):
        path = getattr(options, name)
        setattr(options, name, str(Path(path).resolve()) if path else '')
    return options


def without_page(options: argparse.Namespace) -> str:
    """Why --view starts no operator's page, and what to do; '' where it starts one."""
    if not options.view or options.pendant:
        return ''
    if options.lockstep:
        return "no operator's page: in lock-step nobody operates; leave out --lockstep"
    return "no operator's page: NiceGUI is not installed; pip install -r requirements-pendant.txt"


def run_cell(options: argparse.Namespace, console: Console) -> int:
    """Run a cell until its program has ended (`once`), a node dies that is not started again, or Ctrl-C.

    Returns:
        Exit code: 0 if all went well; 1 if the program failed, a target was missed, a limit was broken
        or a node died; 130 after Ctrl-C.

    Raises:
        RobotsError: an unknown robot, a program that is not Lua, or the suite is not installed.
    """
    # A wrong name and a program that is not Lua are reported before anything starts.
    robot = load_robot_model(options.robot)
    if not options.describe:
        show_substitutions(robot, console)
    if options.program:
        LuaProgram(robot.num_axes).open(options.program)
        if options.check:
            sizes = sizes_of(robot.num_axes, options.io, options.io_map, options.frames)
            check_first(options.program, sizes)
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
        return ExitCode.OK
    place = f'cell {os.environ.get("ROS_DOMAIN_ID") or "0"} {options.namespace}'
    with ExitStack() as stack:
        try:
            stack.enter_context(alone(place))
        except RobotsError as error:
            console.print(occupied('cell', options.namespace, f' ({error})'))
            return ExitCode.FAILED
        return _run_alone(options, console, graph, robot, token)


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
    if missing := without_page(options):
        console.print(f'[yellow]{missing}[/]', soft_wrap=True)
    if token:
        console.print(
            f'editors debug at port {options.debug_port} with token [bold]{token}[/]', highlight=False
        )
    with _bag(options, folder) as bag, listen(options.namespace, bag, lockstep=options.lockstep) as listener:
        view = CellView(console, processes.names, robot.axes_data.prismatic)
        cell = RunningCell(options, processes, listener, view)
        try:
            if not options.lockstep and (found := cell.others()):
                console.print(occupied(found, options.namespace))
                return ExitCode.FAILED
            if options.lockstep:
                listener.coordinate(processes.names)
            processes.start()
            code = cell.run()
            cell.bring_to_rest()
            code = _close_recording(listener, options, console, cell.program_ended) or code
            if options.once and options.view and cell.program_ended:
                console.print('the pages stay open; Ctrl-C ends them')
                cell.watch()
        except KeyboardInterrupt:
            console.print('\nstopping ...')
            code = ExitCode.INTERRUPTED
            cell.bring_to_rest()
            _close_recording(listener, options, console, program_ended=False)
        finally:
            view.close()
            processes.stop()
    return code


@contextmanager
def _bag(options: argparse.Namespace, folder: Path) -> Iterator[Path | None]:
    """Where the bag goes; the verdict on a program needs one for a while."""
    if options.record or not options.once:
        yield folder / 'bag' if options.record else None
        return
    with tempfile.TemporaryDirectory(prefix='cell_') as temporary:
        yield Path(temporary) / 'bag'


def _close_recording(
    listener: CellListener,
    options: argparse.Namespace,
    console: Console,
    program_ended: bool,  # noqa: FBT001
) -> int:
    """Close the bag, if there is one that is open, and report on it; returns an exit code."""
    recorder = listener.recorder
    if recorder is None or recorder.closed:
        return ExitCode.OK
    listener.close_recording()
    if options.record:
        console.print(f'bag: {recorder.path}')
    if recorder.problem:
        return ExitCode.FAILED
    if not program_ended:
        return ExitCode.OK
    # Loads SciPy and the reading of meshes, which the cell itself does not need.
    from robots_controller.commands.json_output import print_json  # noqa: PLC0415
    from robots_controller.report.report_json import report_data  # noqa: PLC0415
    from robots_controller.report.run_report import run_report  # noqa: PLC0415
    from robots_controller.report.terminal import show_verdict  # noqa: PLC0415

    report = run_report(recorder.path, robot=options.robot, namespace=options.namespace)
    if options.json:
        print_json(report_data(report))
    else:
        show_verdict(report, console)
    return ExitCode.OK if report.ok else ExitCode.FAILED


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
