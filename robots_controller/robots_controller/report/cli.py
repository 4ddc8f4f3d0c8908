"""report: show what a recorded run did, or compare two runs."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from robots_controller.cell_arguments import EXIT_OK, exit_code
from robots_controller.report.comparison import compare_runs
from robots_controller.report.page.comparison_page import comparison_page, show_comparison
from robots_controller.report.page.page import report_page, write_page
from robots_controller.report.run_report import run_report
from robots_controller.report.terminal import show_report


def main(arguments: Sequence[str] | None = None) -> int:
    """Report on bags.

    Returns:
        0 for a report, 2 for what cannot be reported on.
    """
    parser = argparse.ArgumentParser(prog='report', description=__doc__)
    parser.add_argument('bag', type=Path, metavar='BAG', help='a recorded bag, live or simulated')
    parser.add_argument(
        'other', type=Path, nargs='?', metavar='BAG', help='a second bag, to compare with the first'
    )
    parser.add_argument('-o', '--output', type=Path, metavar='FILE', help='write an HTML page')
    parser.add_argument(
        '--robot', default='', help='name of the robot; by default the one that the bag names'
    )
    parser.add_argument(
        '--scene', type=Path, metavar='FILE', help='scene around the robot, for distances (YAML)'
    )
    parser.add_argument('--namespace', default='/', help='ROS namespace of the recorded cell')
    options = parser.parse_args(arguments)
    return exit_code(lambda console: _report(options, console))


def _report(options: argparse.Namespace, console: Console) -> int:
    reports = [
        run_report(bag, robot=options.robot, scene=options.scene, namespace=options.namespace)
        for bag in (options.bag, options.other)
        if bag is not None
    ]
    if len(reports) == 1:
        show_report(reports[0], console)
    else:
        show_comparison(compare_runs(*reports), console)
    if options.output is not None:
        one = len(reports) == 1
        write_page(
            options.output, report_page(reports[0]) if one else comparison_page(compare_runs(*reports))
        )
        console.print(f'page: {options.output}')
    return EXIT_OK


if __name__ == '__main__':
    sys.exit(main())
