"""What holds of every run of a robot program, whatever it does."""

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Final

import numpy as np

from cell.bag_checks import resampled_acceleration
from robots_controller.report.run_report import RunReport, run_report
from robots_controller.simulate import simulate
from robots_controller.simulation.record.events import OutputChanged
from robots_controller.simulation.simulation_run import SimulatedMotion, SimulationRun
from robots_core import load_robot_model
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning import Trajectory

from .program_generator import FIRST_ON_PATH, GeneratedProgram

SAMPLE: Final = 1e-3  # s, between places of a tool on a plan, and of resampled references
# References of a trajectory are its own to rounding; between two of them the acceleration is not constant.
LIMIT_TOLERANCE: Final = 1e-3
# The controller's moving average cuts curves by acceleration * (window)^2 / 24, and lags by half its window.
PLACE_TOLERANCE: Final = 5e-4  # m
LAG: Final = 3  # periods between an output and the reference at its place
PERIOD_TOLERANCE: Final = 1e-6  # s


def simulated(program: GeneratedProgram, folder: Path) -> tuple[SimulationRun, RunReport]:
    """A run with its report."""
    path = program.write(folder)
    io = path.with_suffix('.yaml') if program.io else ''
    run = simulate(path, robot=program.robot, drive='ideal', io=io, bag=folder / 'bag', longest=120.0)
    return run, run_report(folder / 'bag')


def broken_laws(program: GeneratedProgram, run: SimulationRun, report: RunReport) -> list[str]:
    """What does not hold of a run, a line each."""
    robot = load_robot_model(program.robot)
    return [
        *_verdict(program, run, report),
        *_references(run, robot),
        *_speeds(run, robot),
        *_outputs(run, robot),
    ]


def _verdict(program: GeneratedProgram, run: SimulationRun, report: RunReport) -> Iterator[str]:
    refused = [motion for motion in run.motions if not motion.ok and motion.plan is None]
    if report.ok != (run.state == 'FINISHED'):
        yield f'the program has {run.state}, the verdict is ok = {report.ok}: {report.problems}'
    if program.impossible and run.state != 'FAILED':
        yield f'the last motion is impossible, the program has {run.state}'
    if run.state == 'FAILED' and not refused:
        yield f'the program failed without a motion that is refused: {run.error}'


def _references(run: SimulationRun, robot: BaseRobotModel) -> Iterator[str]:
    axes = robot.axes_data
    q, q_dot, q_ddot = (run.reference[:, row] for row in range(3))
    steps = np.diff(q, axis=0) / run.period
    jumps = np.diff(q, 2, axis=0) / run.period**2
    way = Trajectory(run.time, q, q_dot, q_ddot)
    between = np.arange(0.0, way.duration, SAMPLE)
    resampled = way.sample(between)[2] / resampled_acceleration(run.period)
    for what, times, values, limit in (
        ('velocity', run.time, q_dot, axes.velocity),
        ('velocity between references', run.time, steps, axes.velocity),
        ('acceleration', run.time, q_ddot, axes.acceleration),
        ('acceleration between references', run.time, jumps, axes.acceleration),
        ('resampled acceleration', between + run.time[0], resampled, axes.acceleration),
    ):
        use = np.abs(values) / limit
        row, axis = np.unravel_index(int(np.argmax(use)), use.shape)
        if use[row, axis] > 1.0 + LIMIT_TOLERANCE:
            yield f'{what} of {axes.names[axis]}: {100.0 * use[row, axis]:.2f} % at {times[row]:.3f} s'
    outside = np.maximum(axes.lower - q, q - axes.upper).max()
    if outside > 1e-9:
        yield f'an axis is {outside:.3g} outside its limits'


def _speeds(run: SimulationRun, robot: BaseRobotModel) -> Iterator[str]:
    for motion in run.motions:
        if motion.plan is None or not motion.command.kind.cartesian:
            continue
        _, places, turns = _way(motion, robot)
        for what, values, limit in (
            ('speed', np.linalg.norm(np.diff(places, axis=0), axis=1), motion.settings.cartesian_speed),
            ('angular speed', turns, motion.settings.rotation_speed),
        ):
            fastest = float(values.max(initial=0.0)) / SAMPLE
            if fastest > limit * (1.0 + LIMIT_TOLERANCE):
                yield f'line {motion.command.line}: {what} {fastest:.4g} of {limit:.4g}'


def _outputs(run: SimulationRun, robot: BaseRobotModel) -> Iterator[str]:
    """Outputs on the path are switched once each, in the period in which their place is reached."""
    events = [event for event in run.events if isinstance(event, OutputChanged) and event.kind == 'digital']
    if not run.ok:  # the last thing that happens to the outputs: they get their fail-safe values
        end = events[-1].time if events else 0.0
        events = [event for event in events if (event.value, event.time) != (0.0, end)]
    flange = [robot.direct_kinematics(q) for q in run.reference[:, 0]]
    for motion in run.motions:
        for switch in motion.command.switches:
            found = [event for event in events if event.index == switch.index]
            label = f'line {motion.command.line}, output {switch.index} ({switch.anchor} {switch.at:g})'
            if len(found) > 1 or (motion.ok and not found):
                yield f'{label} was switched {len(found)} times'
            if not motion.ok or not found:
                continue
            (event,) = found
            if event.line != motion.command.line:
                yield f'{label} is booked to line {event.line}'
            times, places, _ = _way(motion, robot)
            expected = _expected(motion, switch.anchor, switch.at, times, places)
            row = min(int(np.searchsorted(run.time, event.time - PERIOD_TOLERANCE)), len(flange) - 1)
            tool = motion.settings.tool_pose.r
            here = [r + T @ tool for r, T in flange[max(row - 1, 0) : row + LAG + 1]]
            off = distance_to_way(expected, np.array(here))
            if off > PLACE_TOLERANCE:
                yield f'{label} was switched {1e3 * off:.3f} mm off its place, at {event.time:.3f} s'
    late = [event.index for event in events if event.index >= FIRST_ON_PATH and event.value != 1.0]
    if late:
        yield f'outputs {late} were switched off'


def _way(motion: SimulatedMotion, robot: BaseRobotModel) -> tuple[Array, Array, Array]:
    """Times on the plan (m,), places of the tool (m, 3) and turns between them (m - 1,), 1 ms apart."""
    assert motion.plan is not None
    start, end = motion.start_on_plan, motion.end_on_plan
    times = start + SAMPLE * np.arange(int((end - start) / SAMPLE) + 1)
    tool = motion.settings.tool_pose
    frames = [robot.direct_kinematics(q) for q in motion.plan.trajectory.sample(np.append(times, end))[0]]
    places = np.array([r + T @ tool.r for r, T in frames])
    turns = [
        np.arccos(np.clip(0.5 * (np.trace(first[1].T @ second[1]) - 1.0), -1.0, 1.0))
        for first, second in pairwise(frames[:-1])
    ]
    return np.append(times, end), places, np.array(turns)


def _expected(motion: SimulatedMotion, anchor: str, at: float, times: Array, places: Array) -> Array:
    """Where a switch belongs, (3,)."""
    way = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1)))
    if anchor.startswith('distance'):
        wanted = at if anchor == 'distance_after_start' else way[-1] - at
        time = np.interp(wanted, way, times)
    else:
        wanted = motion.start_on_plan + at if anchor == 'time_after_start' else motion.end_on_plan - at
        time = np.clip(wanted, motion.start_on_plan, motion.end_on_plan)
    return np.array([np.interp(time, times, places[:, axis]) for axis in range(3)])


def distance_to_way(place: Array, points: Array) -> float:
    """Distance of a place to the straight way through points, m."""
    nearest = float(np.linalg.norm(points - place, axis=1).min())
    for first, second in pairwise(points):
        along = second - first
        squared = float(along @ along)
        if squared > 0.0:
            part = np.clip((place - first) @ along / squared, 0.0, 1.0)
            nearest = min(nearest, float(np.linalg.norm(first + part * along - place)))
    return nearest
