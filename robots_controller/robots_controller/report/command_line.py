"""report: show what a recorded run did, or compare two runs."""

import argparse

from rich.console import Console

from robots_controller.commands.json_output import print_json
from robots_controller.report.comparison import compare_runs
from robots_controller.report.page.comparison_page import comparison_page, show_comparison
from robots_controller.report.page.page import report_page, write_page
from robots_controller.report.report_json import comparison_data, report_data
from robots_controller.report.run_report import run_report
from robots_controller.report.terminal import show_report
from robots_core.exit_codes import ExitCode


def report(options: argparse.Namespace, console: Console) -> int:
    """Report on bags; returns an exit code.

    Raises:
        RobotsError: a bag that cannot be reported on, or options that do not fit it.
    """
    first, *others = (
        run_report(bag, robot=options.robot, scene=options.scene, namespace=options.namespace)
        for bag in (options.bag, options.other)
        if bag is not None
    )
    comparison = compare_runs(first, *others) if others else None
    if options.json:
        print_json(report_data(first) if comparison is None else comparison_data(comparison))
    elif comparison is None:
        show_report(first, console)
    else:
        show_comparison(comparison, console)
    if options.output is not None:
        page = report_page(first) if comparison is None else comparison_page(comparison)
        write_page(options.output, page)
        console.print(f'page: {options.output}')
    return ExitCode.OK
