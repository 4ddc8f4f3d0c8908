"""A run of a cell: its nodes, its recording, and the verdict on its program."""

import argparse
import os
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

from rich.console import Console

from robots_controller.live_cell.cell_graph import NodeDescription
from robots_controller.live_cell.cell_listener import listen
from robots_controller.live_cell.cell_view import CellView
from robots_controller.live_cell.processes.node_processes import NodeProcesses
from robots_controller.live_cell.running_cell import RunningCell, occupied
from robots_controller.runtime_folder import alone
from robots_core.errors import RobotsError
from robots_core.exit_codes import ExitCode
from robots_core.robot_model.base_robot_model import BaseRobotModel


def run_cell_alone(
    options: argparse.Namespace,
    console: Console,
    graph: Sequence[NodeDescription],
    robot: BaseRobotModel,
) -> int:
    """Run a cell, unless there is another one in its namespace; returns an exit code, see `run_cell`."""
    place = f'cell {os.environ.get("ROS_DOMAIN_ID") or "0"} {options.namespace}'
    with ExitStack() as stack:
        try:
            stack.enter_context(alone(place))
        except RobotsError as error:
            console.print(occupied('cell', options.namespace, f' ({error})'))
            return ExitCode.FAILED
        _show_start(options, console)
        return _run(options, console, graph, robot)


def _show_start(options: argparse.Namespace, console: Console) -> None:
    job = f' runs [bold]{Path(options.program).name}[/]' if options.program else ''
    console.print(f'[bold]{options.robot}[/]{job}')
    if options.note:
        console.print(f'[yellow]{options.note}[/]')
    if missing := without_page(options):
        console.print(f'[yellow]{missing}[/]', soft_wrap=True)
    if options.debug_token:
        console.print(
            f'editors debug at port {options.debug_port} with token [bold]{options.debug_token}[/]',
            highlight=False,
        )


def without_page(options: argparse.Namespace) -> str:
    """Why --view starts no operator's page, and what to do; '' where it starts one."""
    if not options.view or options.pendant:
        return ''
    if options.lockstep:
        return "no operator's page: in lock-step nobody operates; leave out --lockstep"
    return "no operator's page: NiceGUI is not installed; pip install -r requirements-pendant.txt"


def _run(
    options: argparse.Namespace, console: Console, graph: Sequence[NodeDescription], robot: BaseRobotModel
) -> int:
    folder = _run_folder(options.record or Path('out'), options)
    processes = NodeProcesses(graph, namespace=options.namespace, log_folder=folder / 'log')
    with _bag(options, folder) as bag, listen(options.namespace, bag, lockstep=options.lockstep) as listener:
        view = CellView(console, processes.names, robot.axes_data.prismatic)
        cell = RunningCell(options, processes, listener, view)
        try:
            if not options.lockstep and (found := cell.others()):
                console.print(occupied(found, options.namespace))
                return ExitCode.FAILED
            if options.lockstep:
                listener.coordinate(node.executable for node in graph if 'lockstep' in node.parameters)
            processes.start()
            code = cell.run()
            cell.bring_to_rest()
            code = cell.close_recording(judged=cell.program_ended) or code
            if options.once and options.view and cell.program_ended:
                console.print('the pages stay open; Ctrl-C ends them')
                cell.watch()
        except KeyboardInterrupt:
            console.print('\nstopping ...')
            code = ExitCode.INTERRUPTED
            cell.bring_to_rest()
            cell.close_recording(judged=False)
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
