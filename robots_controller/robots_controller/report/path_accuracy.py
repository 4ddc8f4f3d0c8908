"""Path accuracy: how far points are from a path of points, references from lines and targets."""

import math

import numpy as np

from robots_controller.recording.motion_record import MotionRecord
from robots_controller.report.recorded_run import RecordedRun
from robots_controller.report.run_signals import RunSignals
from robots_core.blocks.inverse_kinematics.held_inverse_kinematics import inverse_kinematics_for
from robots_core.blocks.inverse_kinematics.hold import held_by
from robots_core.validation import Array


def distance_to_path(points: Array, path: Array) -> Array:
    """Distances (m,) of points (m, 3) to the nearest place of a path through points (k, 3), k >= 1.

    The path is straight between its points.
    """
    if len(path) < 2:
        return np.asarray(np.linalg.norm(points - path[0], axis=1))
    chords = np.diff(path, axis=0)
    squared = np.maximum((chords**2).sum(axis=1), np.finfo(np.float64).tiny)
    length = np.append(0.0, np.cumsum(np.linalg.norm(chords, axis=1)))
    coarse = path[:: math.isqrt(len(path))]
    best = np.linalg.norm(points[:, None] - coarse, axis=2).min(axis=1)
    left, at = np.arange(len(points)), np.zeros(len(points), dtype=int)  # points, and the next chord of each
    while left.size:
        away = points[left] - path[at]
        along = np.clip((away * chords[at]).sum(axis=1) / squared[at], 0.0, 1.0)
        best[left] = np.minimum(best[left], np.linalg.norm(away - along[:, None] * chords[at], axis=1))
        # Until the path is so much longer, no place of it can be closer.
        near = length[at] + np.linalg.norm(away, axis=1) - best[left]
        at = np.maximum(at + 1, np.searchsorted(length, near, side='right') - 1)
        left, at = left[at < len(chords)], at[at < len(chords)]
    return np.asarray(best)


def line_deviation(run: RecordedRun, signals: RunSignals, motion: MotionRecord, part: slice) -> float:
    """Largest distance of some references from a motion's straight line, outside the zones at its ends, m."""
    tool = motion.settings.tool_pose
    r = _tool_positions(signals, motion, part)
    start = r[0] if motion.before is None else (motion.before.pose @ tool).r
    away = distance_to_path(r, np.array([start, motion.tool_target.r]))
    outside = np.ones(len(r), dtype=bool)
    for corner, row in ((motion.before, 0), (None if motion.own else motion, -1)):
        if corner is not None:
            outside &= zone_distances(run, signals, corner, part, row) > corner.zone[0]
    return float(away[outside].max(initial=0.0))


def zone_distances(
    run: RecordedRun, signals: RunSignals, motion: MotionRecord, part: slice, row: int = 0
) -> Array:
    """Distances of a part of the references from a motion's target, in the unit of its zone, (k,) m or rad.

    The target of the tool has the configuration of the reference in this row of the part.
    """
    if not motion.zone[1]:
        return np.asarray(
            np.linalg.norm(_tool_positions(signals, motion, part) - motion.tool_target.r, axis=1)
        )
    q, corner = run.reference[0][part], motion.q
    if corner is None:
        hold = held_by(run.robot.num_axes, motion.settings.hold)
        ik = inverse_kinematics_for(run.robot, tool=motion.settings.tool_offset, hold=hold)
        corner = ik.solve(motion.tool_target, q[row]).q
    return np.asarray(np.abs(q - corner).max(axis=1))


def _tool_positions(signals: RunSignals, motion: MotionRecord, part: slice) -> Array:
    """Positions of the motion's tool according to the references, (k, 3) m."""
    r, T = (values[part] for values in signals.flange_reference)
    return np.asarray(r + T @ motion.settings.tool_pose.r)
