"""simulate: run a robot program in a simulated cell, and judge the run as cell does."""

import argparse
import contextlib
import signal
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.progress import Progress, SpinnerColumn, TextColumn

from robots_controller.commands.cell_arguments import CELL_OPTIONS
from robots_controller.commands.cell_setup import show_substitutions, take_from_program
from robots_controller.commands.json_output import print_json
from robots_controller.program_check.program_check import check_first, sizes_of
from robots_controller.report.report_json import report_data
from robots_controller.report.run_report import run_report
from robots_controller.report.terminal import show_verdict
from robots_controller.simulate import simulate
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core.blocks.following.following_methods import METHODS
from robots_core.errors import OptionError
from robots_core.exit_codes import ExitCode
from robots_core.robot_choice import load_robot_model

DRAW_PERIOD = 0.1  # s of the machine's time between two drawings of the bar


def start_simulation(options: argparse.Namespace, console: Console) -> int:
    """Simulate as the command line says; see `run`."""
    for number in (signal.SIGTERM, signal.SIGHUP):  # as Ctrl-C
        signal.signal(number, lambda *_: signal.raise_signal(signal.SIGINT))
    # Started in the background, a process ignores SIGINT.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    return run(complete_options(options), console)


def complete_options(options: argparse.Namespace) -> argparse.Namespace:
    """Take from the program what the command line does not say.

    Raises:
        RobotsError: a program that does not exist, or no robot.
    """
    take_from_program(options)
    options.guided = options.guided or METHODS[0]
    if not options.robot:
        raise OptionError(f'{options.program} does not say which robot it is for; --robot does')
    return options


def run(options: argparse.Namespace, console: Console) -> int:
    """Simulate, with a bar on a terminal, and say how it went.

    Returns:
        Exit code, as of `cell`: 0 if all went well; 1 if the program failed, a target was missed or a limit
        was broken; 130 after Ctrl-C.

    Raises:
        RobotsError: input that is not valid.
    """
    console.print(f'[bold]{options.robot}[/] simulates [bold]{Path(options.program).name}[/]')
    if options.note:
        console.print(f'[yellow]{options.note}[/]')
    robot = load_robot_model(options.robot)
    show_substitutions(robot, console)
    if options.check:
        sizes = sizes_of(robot.num_axes, options.io, options.io_map, options.frames)
        check_first(options.program, sizes)
    with _bag_folder(options) as bag:
        with _bar(console) as on_progress:
            result = simulate(
                options.program,
                bag=bag,
                points_file=options.points,
                on_progress=on_progress,
                longest=options.longest,
                patience=options.patience,
                **{name: getattr(options, name) for name in CELL_OPTIONS},
            )
        return _show(result, options, console)


@contextlib.contextmanager
def _bag_folder(options: argparse.Namespace) -> Iterator[Path]:
    """Where the bag goes; the verdict needs one for a while."""
    if options.bag is not None:
        yield options.bag
        return
    with tempfile.TemporaryDirectory(prefix='simulate_') as folder:
        yield Path(folder) / 'bag'


@contextlib.contextmanager
def _bar(console: Console) -> Iterator[Callable[[float, int], None] | None]:
    """Shows where the simulation is, on a terminal."""
    if not console.is_terminal:
        yield None
        return
    columns = (SpinnerColumn(), TextColumn('{task.description}'))
    with Progress(*columns, console=console, transient=True, refresh_per_second=1.0 / DRAW_PERIOD) as bar:
        task = bar.add_task('')
        start = time.monotonic()
        drawn = start

        def on_progress(now: float, line: int) -> None:
            nonlocal drawn
            wall = time.monotonic()
            if wall - drawn >= DRAW_PERIOD:
                drawn = wall
                speed = _times_real_time(now / (wall - start))
                bar.update(task, description=f'line {line}, {now:.1f} s, {speed}')

        yield on_progress


def _times_real_time(factor: float) -> str:
    return f'{factor:.0f} times real time' if factor >= 1.0 else f'{factor:.2f} of real time'


def _show(result: SimulationRun, options: argparse.Namespace, console: Console) -> int:
    """Say how a run went; returns an exit code."""
    for text in result.printed:
        console.print(escape(text))
    seconds = sum(result.cost.values())
    speed = _times_real_time(result.real_time_factor)
    console.print(f'{result.duration:.3f} s simulated in {seconds:.2f} s, {speed}')
    if options.bag is not None:
        console.print(f'bag: {result.bag}')
    assert result.bag is not None
    source = '' if options.bag is not None else f'simulated with {options.drive} drives'
    report = run_report(result.bag, robot=options.robot, scene=options.scene or None, source=source)
    if options.report is not None:
        # On demand: the page draws the robot, which takes libraries that a run without one does not need.
        from robots_controller.report.page.page import report_page, write_page  # noqa: PLC0415

        write_page(options.report, report_page(report))
    if result.interrupted:
        console.print('[bold red]interrupted[/]: this is the beginning only')
    elif not options.json:
        show_verdict(report, console)
    if options.json:
        print_json(report_data(report))
    if options.report is not None:
        console.print(f'report: {options.report}')
    if result.interrupted:
        return ExitCode.INTERRUPTED
    return ExitCode.OK if report.ok else ExitCode.FAILED
