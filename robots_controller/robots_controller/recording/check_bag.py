"""check_bag: compare a recorded bag with an expected one."""

import argparse
from dataclasses import asdict

from rich.console import Console

from robots_controller.commands.json_output import print_json
from robots_controller.recording.bag_comparison import compare_bags
from robots_controller.recording.bag_file import read_bag
from robots_controller.recording.bag_tolerances import BagTolerances, read_tolerances
from robots_core.errors import BagError
from robots_core.exit_codes import ExitCode


def check_bag(options: argparse.Namespace, console: Console) -> int:
    """Compare two bags.

    Returns:
        An exit code: OK if they agree.

    Raises:
        RobotsError: a bag or file that cannot be read.
    """
    tolerances = read_tolerances(options.tolerances) if options.tolerances else BagTolerances()
    recorded, expected = read_bag(options.recorded), read_bag(options.against)
    for bag, accepted in ((recorded, options.partial), (expected, False)):
        if bag.problem and not accepted:
            raise BagError(f'{bag.path} is incomplete: {bag.problem}')
        if bag.problem:
            console.print(f'{bag.path} is incomplete: {bag.problem}', markup=False)
    comparison = compare_bags(recorded, expected, tolerances)
    if options.json:
        print_json({'ok': comparison.ok, 'topics': [asdict(topic) for topic in comparison.topics]})
    else:
        console.print(comparison.describe(), markup=False)
    if comparison.unknown:
        console.print(
            f'compared byte by byte, as their types are not known: {", ".join(comparison.unknown)}',
            markup=False,
        )
    if comparison.unexpected:
        console.print(
            f'not compared, as not in {options.against}: {", ".join(comparison.unexpected)}', markup=False
        )
    if options.junit:
        options.junit.write_text(comparison.junit(str(options.recorded)), encoding='utf-8')
    return ExitCode.OK if comparison.ok else ExitCode.FAILED
