"""MotionFigures: how long, how close to limits, how exact and how costly each motion of a run is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from robots_controller.report.deciding_limit import DecidingLimit, deciding_limit
from robots_controller.report.path_accuracy import distance_to_path
from robots_controller.report.recorded_motion import RecordedMotion
from robots_controller.report.recorded_run import RecordedRun
from robots_controller.report.run_signals import LIMITS, RunSignals, energy
from robots_core.validation import Array

PATH_PERIOD: Final = 1e-3  # s between points of a planned path; between them it is straight to a micrometre


@dataclass(frozen=True, eq=False)
class MotionFigures:
    """Figures of a motion that was planned and ended.

    Attributes:
        motion: The motion.
        planned: Duration of its part of the plan, s.
        duration: From its start to its end, s.
        length: Way of the tool by the drives, m.
        fastest: Highest speed of the tool by the drives, m/s.
        deciding: The limit that makes it last.
        uses: By limit, the axis with the highest use and that use.
        path_deviation: Largest distance of the tool to the planned path, m.
        lag: Largest distance of the tool to where the reference is at that time, m.
        missed: Distance of the tool to the planned end when the motion ended, m; NaN where it ran through.
        energy: That the axes take up, J.
    """

    motion: RecordedMotion
    planned: float
    duration: float
    length: float
    fastest: float
    deciding: DecidingLimit
    uses: dict[str, tuple[str, float]]
    path_deviation: float
    lag: float
    missed: float
    energy: float


def motion_figures(run: RecordedRun, signals: RunSignals) -> tuple[MotionFigures, ...]:
    """Figures of all motions that were planned and ended, in order."""
    return tuple(_figures(run, signals, motion) for motion in run.motions if motion.moved)


def _figures(run: RecordedRun, signals: RunSignals, motion: RecordedMotion) -> MotionFigures:
    part = run.window(motion.start, motion.end)
    names = run.robot.axes_data.names
    use = {quantity: signals.use[quantity][part] for quantity in LIMITS}
    tool = signals.tool[part]
    path = _planned_path(run, motion)
    whole = motion.own and motion.ok
    assert motion.plan is not None
    return MotionFigures(
        motion=motion,
        planned=motion.planned,
        duration=motion.end - motion.start,
        length=float(np.linalg.norm(np.diff(tool, axis=0), axis=1).sum()),
        fastest=float(signals.tool_speed[part].max()),
        deciding=deciding_limit(
            run.time[part], use, names, signals.reference_speed[part], cartesian=motion.cartesian
        ),
        uses={quantity: _worst(names, values) for quantity, values in use.items()},
        path_deviation=float(distance_to_path(tool, path).max()),
        lag=float(np.linalg.norm(tool - signals.tool_reference[part], axis=1).max()),
        missed=float(np.linalg.norm(tool[-1] - path[-1])) if whole else np.nan,
        energy=float(energy(run.time[part], signals.power[part]).sum()),
    )


def _worst(names: tuple[str, ...], use: Array) -> tuple[str, float]:
    axis = int(np.argmax(use.max(axis=0)))
    return names[axis], float(use[:, axis].max())


def _planned_path(run: RecordedRun, motion: RecordedMotion) -> Array:
    """Positions of the tool on the plan, (k, 3) m."""
    assert motion.plan is not None
    count = max(2, int(np.ceil(motion.plan.duration / PATH_PERIOD)) + 1)
    q, _, _ = motion.plan.sample(np.linspace(0.0, motion.plan.duration, count))
    tool = motion.command.settings.tool_pose.r
    return np.array([r + T @ tool for r, T in map(run.robot.direct_kinematics, q)])
