"""check_bag: compare a recorded bag with an expected one."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from robots_controller.cell_arguments import EXIT_OK, exit_code
from robots_controller.recording.bag_comparison import compare_bags
from robots_controller.recording.bag_file import read_bag
from robots_controller.recording.bag_tolerances import BagTolerances, read_tolerances
from robots_core.errors import RobotsError

EXIT_DIFFERENT = 1


def main() -> None:
    """Run from the command line."""
    sys.exit(exit_code(lambda _: check_bag(sys.argv[1:])))


def check_bag(arguments: Sequence[str]) -> int:
    """Compare the bags of a command line.

    Returns:
        Exit code: 0 if they agree, 1 if not.

    Raises:
        RobotsError: a bag or file that cannot be read.
    """
    parser = argparse.ArgumentParser(
        prog='check_bag', description='Compare a recorded bag with an expected one, within tolerances.'
    )
    parser.add_argument('recorded', type=Path, help='the bag to check: a folder, or a .mcap or .db3 file')
    parser.add_argument('--against', type=Path, required=True, metavar='EXPECTED', help='the expected bag')
    parser.add_argument(
        '--tolerances',
        type=Path,
        metavar='FILE',
        help='tolerances (YAML); by default all values must be equal',
    )
    parser.add_argument('--junit', type=Path, metavar='FILE', help='write the result as JUnit XML')
    parser.add_argument('--partial', action='store_true', help='accept a recorded bag that was cut off')
    options = parser.parse_args(arguments)
    tolerances = read_tolerances(options.tolerances) if options.tolerances else BagTolerances()
    recorded, expected = read_bag(options.recorded), read_bag(options.against)
    for bag, accepted in ((recorded, options.partial), (expected, False)):
        if bag.problem and not accepted:
            raise RobotsError(f'{bag.path} is incomplete: {bag.problem}')
        if bag.problem:
            print(f'{bag.path} is incomplete: {bag.problem}')
    comparison = compare_bags(recorded, expected, tolerances)
    print(comparison.describe())
    if comparison.unknown:
        print(f'compared byte by byte, as their types are not known: {", ".join(comparison.unknown)}')
    if comparison.unexpected:
        print(f'not compared, as not in {options.against}: {", ".join(comparison.unexpected)}')
    if options.junit:
        options.junit.write_text(comparison.junit(str(options.recorded)), encoding='utf-8')
    return EXIT_OK if comparison.ok else EXIT_DIFFERENT


if __name__ == '__main__':
    main()
