"""Simulate generated programs: make generated-programs FIRST=0 COUNT=2000."""

import sys
import tempfile
import traceback
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from .program_generator import generate
from .run_laws import broken_laws, simulated


def problems_of(seed: int) -> tuple[int, str, list[str]]:
    """Seed, how the program ended, and what did not hold."""
    program = generate(seed)
    with tempfile.TemporaryDirectory(prefix='generated_') as folder:
        try:
            run, report = simulated(program, Path(folder))
            return seed, run.state, broken_laws(program, run, report)
        except Exception:  # noqa: BLE001  # every one is a finding
            return seed, 'CRASHED', [traceback.format_exc()]


def main() -> int:
    """Print what does not hold, and how many programs finished."""
    first, count = int(sys.argv[1]), int(sys.argv[2])
    workers = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    states: dict[str, int] = {}
    broken = 0
    with ProcessPoolExecutor(workers) as pool:
        for seed, state, problems in pool.map(problems_of, range(first, first + count)):
            states[state] = states.get(state, 0) + 1
            broken += bool(problems)
            for problem in problems:
                print(f'seed {seed} ({state}): {problem}', flush=True)
    print(
        ', '.join(f'{number} {state}' for state, number in sorted(states.items())), f'{broken} with problems'
    )
    return 1 if broken else 0


if __name__ == '__main__':
    sys.exit(main())
