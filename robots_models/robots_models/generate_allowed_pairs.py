"""Finds pairs of shapes that need no collision check: `python -m robots_models.generate_allowed_pairs ur5e`.

Writes `allowed_pairs.yaml` into the robot's folder. To be run again when its shapes, axes or limits change.
"""

import argparse
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from robots_core import load_robot_model
from robots_core.blocks.collision.allowed_pair_sampling import find_allowed_pairs

FILE = 'allowed_pairs.yaml'
HEADER = """Pairs of shapes that collision checks leave out.
Made by `python -m robots_models.generate_allowed_pairs {robot}`; what was here before is replaced."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Write the tables of the robots that the command line names."""
    parser = argparse.ArgumentParser(description='Find pairs of shapes that need no collision check.')
    parser.add_argument('robots', nargs='+', metavar='robot', help='name of a robot of this package')
    parser.add_argument(
        '--into', type=Path, help="folder that holds the robots' folders; this package's own by default"
    )
    options = parser.parse_args(arguments)
    for robot in options.robots:
        table = find_allowed_pairs(load_robot_model(robot))
        root = options.into or Path(__file__).parent
        table.write(root / robot / FILE, HEADER.format(robot=robot))
        counts = Counter(table.reasons.values())
        print(f'{robot}: ' + ', '.join(f'{number} {reason}' for reason, number in sorted(counts.items())))


if __name__ == '__main__':
    main()
