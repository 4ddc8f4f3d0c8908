"""Reports as data for other programs: what `--json` prints, in SI units and radians."""

from typing import Any

from robots_controller.report.comparison import LineChange, RunComparison
from robots_controller.report.line_times import LineTime
from robots_controller.report.motion_figures import MotionFigures
from robots_controller.report.run_report import RunReport


def report_data(report: RunReport) -> dict[str, Any]:
    """A run: its verdict and sums, its lines and its motions."""
    run, clearance = report.run, report.clearance
    return {
        'ok': report.ok,
        'program': run.program_name,
        'robot': run.robot.name,
        'source': run.source,
        'state': run.program_state,
        'problems': report.problems,
        'cycle_time': run.duration,
        'times': report.times,
        'energy': report.energy.sum(),
        'late': run.late.max(),
        'smallest_distance': None if clearance is None else clearance.smallest,
        'lines': [_line(line) for line in report.lines],
        'motions': [_motion(item) for item in report.motions],
    }


def comparison_data(comparison: RunComparison) -> dict[str, Any]:
    """Two runs and what changed from the first to the second, line by line."""
    return {
        'before': report_data(comparison.before),
        'after': report_data(comparison.after),
        'difference': comparison.difference,
        'changes': [_change(change) for change in comparison.changes],
    }


def _line(line: LineTime) -> dict[str, Any]:
    return {**vars(line), 'total': line.total}


def _change(change: LineChange) -> dict[str, Any]:
    return {
        'before': None if change.before is None else _line(change.before),
        'after': None if change.after is None else _line(change.after),
        'difference': change.difference,
        'decided_before': change.decided_before,
        'decided_after': change.decided_after,
    }


def _motion(item: MotionFigures) -> dict[str, Any]:
    motion = item.motion
    return {
        'file': motion.file,
        'line': motion.line,
        'kind': motion.kind.title,
        'ok': item.ok,
        'problem': item.problem,
        'ended_early': motion.ended_early,
        'start': motion.start,
        'planned': motion.planned,
        'duration': motion.duration,
        'position_error': item.position_error,
        'orientation_error': item.orientation_error,
        'passed': None if item.passing is None else vars(item.passing),
        'reference_off_line': item.line_deviation,
        'measured_off_path': item.path_deviation,
        'lag': item.lag,
        'length': item.length,
        'fastest': item.fastest,
        'energy': item.energy,
        'decided_by': None if item.deciding is None else vars(item.deciding),
        'uses': {name: vars(use) for name, use in item.uses.items()},
    }
