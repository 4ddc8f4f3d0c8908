"""MotionFigures: how long, how close to limits, how exact and how costly each motion of a run is."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import zip_longest
from typing import Final

import numpy as np

from robots_controller.degrees import in_degrees
from robots_controller.recording.motion_record import MotionRecord
from robots_controller.report.path_accuracy import distance_to_path, line_deviation, zone_distances
from robots_controller.report.recorded_run import RecordedRun
from robots_controller.report.run_signals import LIMITS, QUANTITIES, RunSignals, energy
from robots_core.blocks.inverse_kinematics.hold import POSE, held_angle, held_by
from robots_core.validation import Array
from robots_core.wording.rounding import apart
from robots_planning.motion_kinds import LINE
from robots_planning.trajectory import Trajectory

# Planners keep a part in a thousand from limits, and references are samples of what they planned.
AT_LIMIT: Final = 0.98
# A plateau of speed is flat to rounding; its samples need not be within a hundredth by chance.
FLAT: Final = 0.99
HIGHEST: Final = 95.0  # percentile of what counts as the highest
PLATEAU: Final = 0.1  # of a motion's time: shorter is the turning point of a curve
PATH_PERIOD: Final = 1e-3  # s between points of a planned path; between them it is straight to a micrometre
AROUND: Final = 0.5  # s of the plan before and after a motion, where the tool is that lags at its ends
POSITION_TOLERANCE: Final = 1e-4  # m
ORIENTATION_TOLERANCE: Final = math.radians(0.01)  # rad
LINE_TOLERANCE: Final = 1e-4  # m
# A blend is planned to its zone, and passes between two references that are compared with it.
ZONE_TOLERANCE: Final = 1e-3  # of the zone
# The controller's guard lets rounding pass. It computes no torques, and its moving average is one of the
# motion: this is what that makes of torques at their limit.
USE_TOLERANCE: Final[Mapping[str, float]] = {
    'position': 1e-5,
    'velocity': 1e-5,
    'acceleration': 1e-5,
    'torque': 1e-3,
}


@dataclass(frozen=True)
class DecidingLimit:
    """What decides a motion.

    Attributes:
        quantity: 'velocity', 'acceleration' or 'torque' of an axis; 'tool speed' or 'tool acceleration'
            where these are what was asked for.
        joint: The axis; '' for the tool.
        use: Highest value over limit in the motion; for the tool the value itself, m/s or m/s^2.
        share: Part of the motion's time that it is there, 0..1.
    """

    quantity: str
    joint: str
    use: float
    share: float

    def describe(self) -> str:
        """A few words for a person."""
        if not self.joint:
            unit = 'm/s' if self.quantity == 'tool speed' else 'm/s²'
            return f'{self.quantity} {self.use:.3g} {unit}'
        return f'{self.quantity} of {self.joint} at {100.0 * self.use:.0f} %'


def deciding_limit(
    time: Array, use: dict[str, Array], names: tuple[str, ...], tool_speed: Array, *, cartesian: bool
) -> DecidingLimit:
    """The limit that decides a motion: of those that are reached, the one that is held longest.

    An axis reaches a limit at its full value. The speed or acceleration of a tool that follows a path is
    reached where it stays at its highest value: it is as fast as it was set to be. If nothing is reached,
    the program requests less than full speed of the axes, and the highest use decides.

    Args:
        time: (k,) s.
        use: Value over limit by name of `LIMITS`, (k, n) each, over the motion.
        names: The axes.
        tool_speed: (k,) m/s.
        cartesian: The tool follows a path.
    """
    found = []
    for quantity in LIMITS:
        peak = use[quantity].max(axis=0)
        for axis, name in enumerate(names):
            share = float(np.mean(use[quantity][:, axis] >= AT_LIMIT * peak[axis])) if peak[axis] else 0.0
            found.append(DecidingLimit(quantity, name, float(peak[axis]), share))
    reached = [limit for limit in found if limit.use >= AT_LIMIT]
    if cartesian and tool_speed.size > 1:
        acceleration = np.abs(np.gradient(tool_speed, time))
        tool = [_plateau('tool speed', tool_speed), _plateau('tool acceleration', acceleration)]
        reached += [limit for limit in tool if limit.share >= PLATEAU]
    return max(reached, key=lambda limit: limit.share) if reached else max(found, key=lambda limit: limit.use)


def _plateau(quantity: str, values: Array) -> DecidingLimit:
    # Of an acceleration that is a difference of samples, those at corners mean nothing.
    highest = float(np.percentile(values, HIGHEST))
    share = float(np.mean(np.abs(values - highest) <= (1.0 - FLAT) * highest)) if highest else 0.0
    return DecidingLimit(quantity, '', highest, share)


@dataclass(frozen=True)
class Passing:
    """How a motion ran through to the next one.

    Attributes:
        distance: How near the references came to the target, m or rad.
        zone: How near they had to come, in the same unit.
        joints: The unit is rad (m) of the axis that is farthest away, and not m of the tool.
    """

    distance: float
    zone: float
    joints: bool

    @property
    def ok(self) -> bool:
        """The references came into the zone."""
        return self.distance <= self.zone * (1.0 + ZONE_TOLERANCE)

    def describe(self) -> str:
        """'12.3 of 30 mm'."""
        factor, unit = (math.degrees(1.0), 'deg') if self.joints else (1e3, 'mm')
        distance, zone = factor * self.distance, factor * self.zone
        return f'{f"{distance:.1f}" if self.ok else apart(distance, zone, 1)} of {zone:g} {unit}'


@dataclass(frozen=True)
class WorstUse:
    """The axis that uses most of a limit.

    Attributes:
        joint: Its name.
        ratio: How much of it.
        time: When, s from the program's start.
    """

    joint: str
    ratio: float
    time: float


@dataclass(frozen=True, eq=False)
class MotionFigures:
    """Figures of a motion; NaN or None where there are none, as of one that was refused.

    Attributes:
        motion: The motion.
        position_error: Distance of the tool to its target at the end, m; that of the references where the
            next motion followed at once; NaN where it was passed.
        orientation_error: Angle to its target at the end, rad, in the directions that it holds.
        passing: How the target was passed; None where the robot stood there.
        line_deviation: Largest distance of the references to the straight line outside the zones at its ends,
            m; None of other paths.
        uses: By limit of `QUANTITIES`, the axis with the highest use.
        length: Way of the tool by the drives, m.
        fastest: Highest speed of the tool by the drives, m/s.
        deciding: The limit that makes it last.
        path_deviation: Largest distance of the tool to the planned path, m.
        lag: Largest distance of the tool to where the reference is at that time, m.
        energy: That the axes take up, J.
        closest: Smallest distance to anything, m; NaN without a scene.
        problem: Why the motion is not as it should be; '' if it is.
    """

    motion: MotionRecord
    position_error: float = math.nan
    orientation_error: float = math.nan
    passing: Passing | None = None
    line_deviation: float | None = None
    uses: Mapping[str, WorstUse] = field(default_factory=dict)
    length: float = math.nan
    fastest: float = math.nan
    deciding: DecidingLimit | None = None
    path_deviation: float = math.nan
    lag: float = math.nan
    energy: float = math.nan
    closest: float = math.nan
    problem: str = ''

    @property
    def ok(self) -> bool:
        """The target was reached exactly, or passed within its zone, inside all limits."""
        return not self.problem


def motion_figures(run: RecordedRun, signals: RunSignals) -> tuple[MotionFigures, ...]:
    """Figures of all motions, in order.

    A program that finishes has dealt with motions that did not come to their targets: a handler ended them.
    """
    found = []
    for motion, after in zip_longest(run.motions, run.motions[1:]):
        figures = _figures(run, signals, motion, after) if motion.moved else MotionFigures(motion)
        problems = _problems(figures)
        if not motion.ok and not run.finished:
            problems.insert(0, in_degrees(motion.message))
        found.append(replace(figures, problem='; '.join(problems)))
    return tuple(found)


def _figures(
    run: RecordedRun, signals: RunSignals, motion: MotionRecord, after: MotionRecord | None
) -> MotionFigures:
    part = run.window(motion.start, motion.end)
    way = signals.tool[part]
    passing, errors, deviation = None, (math.nan, math.nan), None
    if motion.ok and motion.own:
        stood = (run.reference if motion.followed else run.feedback)[0][part][-1]
        tool, target = motion.settings.tool_pose, motion.tool_target
        position, _ = (run.robot.pose(stood) @ tool).distance_to(target)
        hold = POSE if motion.q is not None else held_by(run.robot.num_axes, motion.settings.hold)
        errors = position, held_angle(run.robot, stood, tool, target, hold)
    elif motion.ok:
        passing = _passing(run, signals, motion, after)
    if motion.kind is LINE:
        deviation = line_deviation(run, signals, motion, part)
    return MotionFigures(
        motion=motion,
        position_error=errors[0],
        orientation_error=errors[1],
        passing=passing,
        line_deviation=deviation,
        uses={quantity: worst_use(run, signals.use[quantity], part) for quantity in QUANTITIES},
        length=float(np.linalg.norm(np.diff(way, axis=0), axis=1).sum()),
        fastest=float(signals.tool_speed[part].max()),
        deciding=deciding_limit(
            run.time[part],
            {quantity: signals.use[quantity][part] for quantity in LIMITS},
            run.robot.axes_data.names,
            signals.reference_speed[part],
            cartesian=motion.kind.cartesian,
        ),
        path_deviation=float(distance_to_path(way, _planned_path(run, motion)).max()),
        lag=float(signals.lag[part].max()),
        energy=float(energy(run.time[part], signals.power[part]).sum()),
    )


def _passing(
    run: RecordedRun, signals: RunSignals, motion: MotionRecord, after: MotionRecord | None
) -> Passing:
    """How near the references came between the middles of a motion and of the next one."""
    next_middle = motion.end if after is None or not after.moved else 0.5 * (after.start + after.end)
    near = run.window(0.5 * (motion.start + motion.end), next_middle)
    row = min(int(np.searchsorted(run.time[near], motion.end)), near.stop - near.start - 1)
    return Passing(float(zone_distances(run, signals, motion, near, row).min()), *motion.zone)


def worst_use(run: RecordedRun, use: Array, part: slice = slice(None)) -> WorstUse:
    """The axis that uses most of a limit in a part of a run, of how much of it the axes use, (m, n)."""
    row, axis = np.unravel_index(int(np.argmax(use[part])), use[part].shape)
    return WorstUse(run.robot.axes_data.names[axis], float(use[part][row, axis]), float(run.time[part][row]))


def _planned_path(run: RecordedRun, motion: MotionRecord) -> Array:
    """Positions of the tool on the motion's part of the plan and a little around it, (k, 3) m."""
    plan = motion.plan
    assert plan is not None
    start, end = max(0.0, motion.path_start - AROUND), min(plan.duration, motion.path_end + AROUND)
    q = _positions(plan, start, end)
    before = motion.before
    if before is not None and before.plan is not plan and before.plan is not None:
        early = AROUND - (motion.path_start - start)
        q = np.concatenate([_positions(before.plan, before.path_end - early, before.path_end), q])
    r, T = run.robot.tool_poses(q)
    return np.asarray(r + T @ motion.settings.tool_pose.r)


def _positions(plan: Trajectory, start: float, end: float) -> Array:
    """Joint positions on a part of a plan, (k, n)."""
    return plan.sample(np.linspace(start, end, max(2, int(np.ceil((end - start) / PATH_PERIOD)) + 1)))[0]


def _problems(figures: MotionFigures) -> list[str]:
    problems = [
        _beyond(quantity, use)
        for quantity, use in figures.uses.items()
        if use.ratio > 1.0 + USE_TOLERANCE[quantity]
    ]
    if figures.position_error > POSITION_TOLERANCE or figures.orientation_error > ORIENTATION_TOLERANCE:
        position, angle = 1e3 * POSITION_TOLERANCE, math.degrees(ORIENTATION_TOLERANCE)
        problems.append(
            f'the target was missed by {apart(1e3 * figures.position_error, position, 3)} mm and '
            f'{apart(math.degrees(figures.orientation_error), angle, 4)} deg; allowed are '
            f'{position:g} mm and {angle:g} deg'
        )
    if figures.passing is not None and not figures.passing.ok:
        problems.append(f'the target was passed outside its zone, in {figures.passing.describe()}')
    if figures.line_deviation is not None and figures.line_deviation > LINE_TOLERANCE:
        problems.append(
            'the references leave the straight line by '
            f'{apart(1e3 * figures.line_deviation, 1e3 * LINE_TOLERANCE, 3)} mm, allowed is '
            f'{1e3 * LINE_TOLERANCE:g} mm'
        )
    return problems


def _beyond(quantity: str, use: WorstUse) -> str:
    return (
        f'{quantity} of {use.joint} at {apart(100.0 * use.ratio, 100.0, 2)} % of its limit '
        f'{use.time:.3f} s after the start of the program'
    )
