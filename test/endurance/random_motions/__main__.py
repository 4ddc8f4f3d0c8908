"""Random motions of all robots: make random-motions COUNT=10000; one seed alone is described."""

import argparse
import os
import sys
import time
from concurrent.futures import ProcessPoolExecutor

from printed_tables import machine, show
from robots_core.robot_choice import available_robot_models

from .motion_run import MotionFigures, run_seed
from .random_motion import random_motion
from .summary import closing_line, summary

PROGRESS = 60.0  # s between two lines
CHUNK = 8  # seeds that a process takes at once


def main() -> int:
    """Print what broke a limit, with its seed, and a row per robot; returns 1 if anything did."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('first', type=int, help='first seed')
    parser.add_argument('count', type=int, help='motions')
    parser.add_argument('workers', type=int, nargs='?', default=os.cpu_count() or 1)
    parser.add_argument('--markdown', action='store_true', help='the table as Markdown')
    options = parser.parse_args()
    seeds = range(options.first, options.first + options.count)
    if not seeds:
        parser.error(f'count = {options.count} must be at least 1')
    robots = len(available_robot_models())
    began = told = time.monotonic()
    print(f'{len(seeds)} random motions of {robots} robots, seeds {seeds[0]} to {seeds[-1]}', flush=True)
    if len(seeds) == 1:
        print(_describe(seeds[0]))
    found: list[MotionFigures] = []
    with ProcessPoolExecutor(min(options.workers, len(seeds))) as pool:
        for figures in pool.map(run_seed, seeds, chunksize=CHUNK):
            found.append(figures)
            for problem in figures.problems:
                print(f'seed {figures.seed} ({figures.robot}): {problem}', flush=True)
            if time.monotonic() > told + PROGRESS:
                told = time.monotonic()
                print(f'{len(found)} motions in {told - began:.0f} s', flush=True)
    show(summary(found), markdown=options.markdown)
    broken = [figures.seed for figures in found if figures.problems]
    print(f'{closing_line(found)}; in {time.monotonic() - began:.0f} s\n{machine()}')
    for seed in broken:
        print(f'again: make random-motions FIRST={seed} COUNT=1')
    return 1 if broken else 0


def _describe(seed: int) -> str:
    motion = random_motion(seed)
    lines = [f'{motion.robot} from {motion.start.tolist()}']
    lines += [f'{kind.title} to {target} with {settings}' for kind, target, settings in motion.commands]
    lines.append(
        f'period {motion.period} s, smoothing {motion.smoothing_time} s, tool speed limit '
        f'{motion.tool_speed_limit:.4g} m/s, overrides {motion.overrides}, stop at {motion.stop_at}'
    )
    return '\n'.join(lines)


if __name__ == '__main__':
    sys.exit(main())
