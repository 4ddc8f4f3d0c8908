"""Run generated programs: make generated-programs FIRST=0 COUNT=2000 WAYS=simulated,lockstep,live."""

import argparse
import os
import sys
import tempfile
import traceback
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

from counted_cases import count_cases
from ros_domains import reserved_domain

from .other_ways import live_problems, lockstep_problems
from .program_generator import generate
from .run_laws import broken_laws, simulated

REPORT_EVERY = 10  # programs


def problems_of(ways: list[str], seed: int) -> tuple[int, str, list[str]]:
    """Seed, how the program ended, and what did not hold."""
    count_cases('generated programs')
    program = generate(seed)
    with reserved_domain() as environment, tempfile.TemporaryDirectory(prefix='generated_') as name:
        os.environ.update(environment)
        folder = Path(name)
        try:
            run, report = simulated(program, folder)
            problems = broken_laws(program, run, report)
            if 'lockstep' in ways:
                problems += lockstep_problems(program, folder)
            if 'live' in ways:
                problems += live_problems(program, run, folder)
        except Exception:  # noqa: BLE001  # every one is a finding
            return seed, 'CRASHED', [traceback.format_exc()]
    return seed, run.state, problems


def main() -> int:
    """Print what does not hold, and how many programs finished."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('first', type=int)
    parser.add_argument('count', type=int)
    parser.add_argument('workers', type=int)
    parser.add_argument('ways', help='simulated, and lockstep and live too if they are named')
    options = parser.parse_args()
    seeds = range(options.first, options.first + options.count)
    ways = options.ways.split(',')
    # A live cell has its references on time where it has two processors.
    workers = max(1, options.workers // 2) if 'live' in ways else options.workers
    states: dict[str, int] = {}
    broken = 0
    with ProcessPoolExecutor(workers) as pool:
        found = pool.map(partial(problems_of, ways), seeds)
        for done, (seed, state, problems) in enumerate(found, 1):
            states[state] = states.get(state, 0) + 1
            broken += bool(problems)
            for problem in problems:
                print(f'seed {seed} ({state}): {problem}', flush=True)
            if done % REPORT_EVERY == 0:
                print(f'{done} of {options.count}, {broken} with problems', flush=True)
    print(
        ', '.join(f'{number} {state}' for state, number in sorted(states.items())), f'{broken} with problems'
    )
    return 1 if broken else 0


if __name__ == '__main__':
    sys.exit(main())
