"""run_case: simulate one case of a study; a row of its table."""

import math
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

from robots_controller.report.run_report import RunReport, run_report
from robots_controller.simulate import simulate
from robots_controller.simulation.simulation_run import SimulationRun
from robots_controller.study.study_case import StudyCase
from robots_core.errors import ProgramError, RobotsError

Row = dict[str, Any]
"""One row of the results."""

_FIGURES: Final[dict[str, tuple[type, Callable[[SimulationRun, RunReport], Any]]]] = {
    'ok': (bool, lambda run, _: run.ok),
    'reason': (str, lambda run, _: '' if run.error is None else str(run.error)),
    'line': (int, lambda run, _: 0 if run.error is None else run.error.line),
    'cycle_time': (float, lambda run, _: run.duration),
    'moving': (float, lambda _, report: report.times['moving']),
    'waiting': (float, lambda _, report: report.times['waiting']),
    'io': (float, lambda _, report: report.times['io']),
    'motions': (int, lambda _, report: len(report.moved)),
    'way': (float, lambda _, report: sum(motion.length for motion in report.moved)),
    'energy': (float, lambda _, report: float(report.energy.sum())),
    'velocity_use': (float, lambda _, report: report.uses['velocity'].ratio),
    'acceleration_use': (float, lambda _, report: report.uses['acceleration'].ratio),
    'torque_use': (float, lambda _, report: report.uses['torque'].ratio),
    'path_deviation': (
        float,
        lambda _, report: math.nan if report.farthest is None else report.farthest.path_deviation,
    ),
    'smallest_distance': (
        float,
        lambda _, report: math.nan if report.clearance is None else report.clearance.smallest,
    ),
}
FIGURES: Final = {name: kind for name, (kind, _) in _FIGURES.items()}
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
            report = run_report(bag, robot=case.robot, scene=scene or None)
            return {**case.settings, **{name: value(run, report) for name, (_, value) in _FIGURES.items()}}
        except RobotsError as error:
            line = error.line if isinstance(error, ProgramError) else 0
            return failed_row(case, str(error).replace(f'{folder}/', ''), line)
        except Exception as error:  # noqa: BLE001  # one case must not end a study of thousands
            return failed_row(case, f'{type(error).__name__}: {error}'.replace(f'{folder}/', ''))


def failed_row(case: StudyCase, reason: str, line: int = 0) -> Row:
    """The row of a case that could not be simulated."""
    figures: Row = {name: math.nan if kind is float else kind() for name, kind in FIGURES.items()}
    return {**case.settings, **figures, 'reason': reason, 'line': line}
