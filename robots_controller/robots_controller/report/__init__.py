"""What a recorded run did: figures, a page in one file, a terminal summary, and what changed between two."""

from robots_controller.report.comparison import compare_runs
from robots_controller.report.page.page import write_report
from robots_controller.report.run_report import RunReport, run_report

__all__ = ['RunReport', 'compare_runs', 'run_report', 'write_report']
