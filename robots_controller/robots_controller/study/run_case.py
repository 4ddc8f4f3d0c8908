"""run_case: simulate one case of a study; a row of its table."""

import math
import tempfile
from pathlib import Path
from typing import Any, Final

from robots_controller.report.run_report import RunReport, run_report
from robots_controller.report.run_signals import LIMITS
from robots_controller.simulate import simulate
from robots_controller.simulation.simulation_run import SimulationRun
from robots_controller.study.study_case import StudyCase
from robots_core.errors import ProgramError, RobotsError

Row = dict[str, Any]
"""One row of the results."""

FIGURES: Final = {
    'ok': bool,
    'reason': str,
    'line': int,
    'cycle_time': float,
    'moving': float,
    'waiting': float,
    'io': float,
    'motions': int,
    'way': float,
    'energy': float,
    'velocity_use': float,
    'acceleration_use': float,
    'torque_use': float,
    'path_deviation': float,
    'smallest_distance': float,
}
"""Columns that the simulation fills: s, m, J, parts of limits; NaN for what is not known."""


def run_case(case: StudyCase) -> Row | None:
    """Simulate a case in a folder of its own.

    Returns:
        Settings and figures; of a case that fails with its reason. None if it was interrupted.
    """
    with tempfile.TemporaryDirectory(prefix='study_') as folder:
        try:
            program, scene, io = case.unpack(Path(folder))
            bag = Path(folder) / 'bag'
            run = simulate(
                program,
                robot=case.robot,
                drive=case.drive,
                scene=scene,
                io=io,
                bag=bag,
                longest=case.longest,
            )
            if run.interrupted:
                return None
            return _row(case, run, run_report(bag, robot=case.robot, scene=scene or None))
        except RobotsError as error:
            line = error.line if isinstance(error, ProgramError) else 0
            return failed_row(case, str(error).replace(f'{folder}/', ''), line)
        except Exception as error:  # noqa: BLE001  # one case must not end a study of thousands
            return failed_row(case, f'{type(error).__name__}: {error}'.replace(f'{folder}/', ''))


def failed_row(case: StudyCase, reason: str, line: int = 0) -> Row:
    """The row of a case that could not be simulated."""
    nothing = {float: math.nan, int: 0, str: '', bool: False}
    figures: Row = {name: nothing[kind] for name, kind in FIGURES.items()}
    return {**case.settings, **figures, 'reason': reason, 'line': line}


def _row(case: StudyCase, run: SimulationRun, report: RunReport) -> Row:
    use = {name: values for name, values in report.signals.use.items() if name in LIMITS}
    moved = [item for item in report.motions if item.motion.moved]
    return {
        **case.settings,
        'ok': run.ok,
        'reason': '' if run.error is None else str(run.error),
        'line': 0 if run.error is None else run.error.line,
        'cycle_time': run.duration,
        **report.times,
        'motions': len(moved),
        'way': sum(motion.length for motion in moved),
        'energy': float(report.energy.sum()),
        **{f'{name}_use': float(values.max()) for name, values in use.items()},
        'path_deviation': max((motion.path_deviation for motion in moved), default=math.nan),
        'smallest_distance': math.nan if report.clearance is None else report.clearance.smallest,
    }
