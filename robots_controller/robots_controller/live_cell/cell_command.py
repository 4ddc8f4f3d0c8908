"""cell: start all nodes of one robot, show and record what they do, and end them cleanly."""

import argparse
import json
import os
import signal
from dataclasses import asdict
from importlib.util import find_spec
from pathlib import Path

from rich.console import Console

from robots_controller.commands.cell_arguments import FILES
from robots_controller.commands.cell_setup import show_substitutions, take_from_program
from robots_controller.editor.debug_adapter_server import new_token
from robots_controller.interpreter.lua_source import check_syntax, read_source
from robots_controller.live_cell.cell_graph import DEFAULT_ROBOT, cell_graph
from robots_controller.program_check.program_check import check_first, sizes_of
from robots_core.blocks.following.following_methods import METHODS
from robots_core.errors import InstallationError, OptionError
from robots_core.exit_codes import ExitCode
from robots_core.robot_choice import load_robot_model
from robots_core.ros.running.middleware import choose_transports


def start(options: argparse.Namespace, console: Console) -> int:
    """Run a cell as the command line says; see `run_cell`."""
    os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    choose_transports()
    # Started in the background, a process ignores SIGINT; ended by a supervisor, it gets SIGTERM.
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.default_int_handler)
    return run_cell(complete_options(options), console)


def complete_options(options: argparse.Namespace) -> argparse.Namespace:
    """Take from the program what the command line does not say, and add what follows from the options.

    Raises:
        RobotsError: options that exclude each other, or a program that does not exist.
    """
    if options.once and not options.program:
        raise OptionError('--once needs a --program to run')
    take_from_program(options)
    options.robot = options.robot or DEFAULT_ROBOT
    others = options.references or options.contact or options.orbit or options.cabin
    options.guided = options.guided or (METHODS[0] if others else '')
    # Nobody operates a cell whose time does not wait.
    options.pendant = options.view and not options.lockstep and find_spec('nicegui') is not None
    # The launch file starts the described nodes in other processes, whose log shows a token of their own.
    options.debug_token = new_token() if options.debug_port and not options.describe else ''
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
        check_syntax(read_source(options.program))
        if options.check:
            sizes = sizes_of(robot.num_axes, options.io, options.io_map, options.frames)
            check_first(options.program, sizes)
    graph = cell_graph(options)
    if options.describe:
        print(json.dumps([asdict(node) for node in graph], indent=2))
        return ExitCode.OK
    # Loads the middleware, which a description does not need.
    from robots_controller.live_cell.cell_run import run_cell_alone  # noqa: PLC0415

    return run_cell_alone(options, console, graph, robot)
