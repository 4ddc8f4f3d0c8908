"""For tests with pytest: recorded bags against expected ones.

Example:
    def test_my_cell(tmp_path):
        ...  # record into tmp_path / 'bag'
        assert_bag_matches(tmp_path / 'bag', 'expected/bag', 'expected/tolerances.yaml')
"""

from pathlib import Path

from robots_controller.recording.bag_comparison import Comparison, compare_bags
from robots_controller.recording.bag_file import read_bag
from robots_controller.recording.bag_tolerances import BagTolerances, read_tolerances


def assert_bag_matches(
    recorded: Path | str, expected: Path | str, tolerances: BagTolerances | Path | str | None = None
) -> Comparison:
    """Fail the test with the first difference, if there is one.

    Args:
        recorded: The bag to check.
        expected: The expected bag.
        tolerances: How far apart they may be, or the YAML file that says so.

    Returns:
        The comparison, which found no difference.

    Raises:
        AssertionError: the bags differ, or one of them is incomplete.
        RobotsError: a bag or file that cannot be read.
    """
    if isinstance(tolerances, (Path, str)):
        tolerances = read_tolerances(tolerances)
    bags = read_bag(recorded), read_bag(expected)
    for bag in bags:
        if bag.problem:
            raise AssertionError(f'{bag.path} is incomplete: {bag.problem}')
    comparison = compare_bags(*bags, tolerances)
    if not comparison.ok:
        raise AssertionError(f'{recorded} is not as {expected}\n{comparison.describe()}')
    return comparison
