"""How many times faster than real time simulations are, and where the time goes.

Factors are simulated time per time of one core, and per time of the wall's clock, from the program's first
line to the closed bag: loading the robot is not in it. A machine that does other things too stretches the
wall's time. Every case runs a few times, after one that loads all code; the medians count.

The last line is of the command `simulate`, a process of its own from its start to its end.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from robots_controller.simulate import simulate
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core.blocks.drives.drive_levels import DRIVE_LEVELS

PROGRAM = Path(__file__).parents[2] / 'programs' / 'welding.lua'
ROBOT = 'kuka_kr210_r2700'
REPETITIONS = 7
# What the project promises, with ideal drives.
NEEDED = 50.0
COMMAND = Path('install/robots_controller/lib/robots_controller/simulate')
LONGEST_COMMAND = 2.5  # s


def measured(drive: str, bag: Path | None) -> SimulationRun:
    """A run."""
    run = simulate(PROGRAM, robot=ROBOT, drive=drive, bag=bag)
    assert run.ok, run.error
    return run


def measured_command() -> tuple[float, float]:
    """Time of the command by the wall's clock and that of the processor, s, medians."""
    walls, cores = [], []
    for _ in range(REPETITIONS + 1):
        before, start = os.times(), time.perf_counter()
        subprocess.run([COMMAND, PROGRAM, '--robot', ROBOT], check=True, stdout=subprocess.DEVNULL)
        walls.append(time.perf_counter() - start)
        after = os.times()
        cores.append(
            after.children_user - before.children_user + after.children_system - before.children_system
        )
    return statistics.median(walls[1:]), statistics.median(cores[1:])


def main() -> None:
    """Print the table."""
    print(f'{PROGRAM.name} on {ROBOT}, 250 Hz, median of {REPETITIONS}\n')
    print(
        f'{"drives":<13} {"bag":<4} {"simulated":>9} {"core":>8} {"factor":>7} {"wall":>8} {"factor":>7}   '
        'where the time goes'
    )
    factors, warm = {}, {}
    for drive in DRIVE_LEVELS:
        for with_bag in (False, True):
            with tempfile.TemporaryDirectory() as folder:
                runs = [
                    measured(drive, Path(folder, str(number)) if with_bag else None)
                    for number in range(REPETITIONS + 1)
                ][1:]
            simulated = runs[0].duration
            core = statistics.median(run.processor_time for run in runs)
            wall = statistics.median(sum(run.cost.values()) for run in runs)
            spent = {part: statistics.median(r.cost[part] for r in runs) for part in sorted(runs[0].cost)}
            parts = ', '.join(
                f'{part} {100.0 * value / sum(spent.values()):.0f} %'
                for part, value in sorted(spent.items(), key=lambda item: -item[1])
            )
            factors[drive, with_bag], warm[drive, with_bag] = simulated / core, core
            print(
                f'{drive:<13} {"yes" if with_bag else "no":<4} {simulated:>7.2f} s '
                f'{1e3 * core:>5.0f} ms {simulated / core:>7.0f} '
                f'{1e3 * wall:>5.0f} ms {simulated / wall:>7.0f}   {parts}'
            )
    print(
        f'\nideal drives: {factors["ideal", False]:.0f} times real time on one core, '
        f'{factors["ideal", True]:.0f} with a bag; promised are {NEEDED:g}'
    )
    wall, core = measured_command()
    print(
        f'the command: {wall:.2f} s, {core:.2f} s of one core, of which a warm process takes '
        f'{warm["second_order", False]:.2f} s; goal {LONGEST_COMMAND:g} s'
    )
    sys.exit(factors['ideal', False] < NEEDED)


if __name__ == '__main__':
    main()
