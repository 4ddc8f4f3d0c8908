"""How many times faster than real time simulations are, and where the time goes.

Factors are simulated time per time of one core, from the program's first line to the closed bag: loading the
robot is not in it. Every case runs a few times, after one that loads all code; the median counts.
"""

from __future__ import annotations

import statistics
import sys
import tempfile
import time
from pathlib import Path

from robots_controller.simulate import simulate
from robots_controller.simulation.simulation_run import SimulationRun

PROGRAM = Path(__file__).parents[2] / 'programs' / 'welding.lua'
ROBOT = 'kuka_kr210_r2700'
REPETITIONS = 7
# What the project promises, with ideal drives.
NEEDED = 50.0
# Elastic gears and friction keep an axis from standing closer to its target.
TOLERANCES = {'ideal': None, 'second_order': None, 'rigid_body': 1e-3}


def measured(drive: str, bag: Path | None) -> tuple[SimulationRun, float]:
    """A run and its time of one core, s.

    The parts of the run's own cost are of the wall's time; a machine that does other things too stretches all
    of them alike, so that they say how the core's time was spent.
    """
    cpu, wall = time.process_time(), time.perf_counter()
    run = simulate(PROGRAM, robot=ROBOT, drive=drive, goal_tolerance=TOLERANCES[drive], bag=bag)
    cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    assert run.ok, run.error
    return run, sum(run.cost.values()) * min(1.0, cpu / wall)


def main() -> None:
    """Print the table."""
    print(f'{PROGRAM.name} on {ROBOT}, 250 Hz, median of {REPETITIONS}\n')
    print(f'{"drives":<13} {"bag":<4} {"simulated":>9} {"core":>8} {"factor":>7}   where the time goes')
    factor = 0.0
    for drive in TOLERANCES:
        for with_bag in (False, True):
            with tempfile.TemporaryDirectory() as folder:
                runs = [
                    measured(drive, Path(folder, str(number)) if with_bag else None)
                    for number in range(REPETITIONS + 1)
                ][1:]
            run, seconds = sorted(runs, key=lambda item: item[1])[REPETITIONS // 2]
            spent = {part: statistics.median(r.cost[part] for r, _ in runs) for part in sorted(run.cost)}
            total = sum(spent.values())
            parts = ', '.join(
                f'{part} {100.0 * value / total:.0f} %'
                for part, value in sorted(spent.items(), key=lambda item: -item[1])
            )
            this = run.duration / seconds
            factor = factor or this
            print(
                f'{drive:<13} {"yes" if with_bag else "no":<4} {run.duration:>7.2f} s '
                f'{1e3 * seconds:>5.0f} ms {this:>7.0f}   {parts}'
            )
    print(f'\nideal drives: {factor:.0f} times real time, promised are {NEEDED:g}')
    sys.exit(factor < NEEDED)


if __name__ == '__main__':
    main()
