"""Planners next to their peers, in one process, turn by turn.

Run by `make benchmark-planning`. The same lines and limits, torques included, go to our dynamic programming
and to toppra (seidel), which gets the joint path of the inverse kinematics: of a robot with self-motion our
planner may choose another, faster one. The reference is toppra with 5000 intervals. Limits are checked at
10 kHz with the robot's own dynamics (Pinocchio). Medians over the lines, or the worst of them; times are
medians over repetitions in turn, of the processor's time, so that other processes hardly count.
"""

from __future__ import annotations

import argparse
import contextlib
import logging
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from rich.console import Console
from rich.table import Table
from ruckig import InputParameter, Ruckig
from ruckig import Trajectory as RuckigTrajectory
from scipy.spatial.transform import Rotation
from toppra import algorithm, constraint
from toppra.interpolator import AbstractGeometricPath

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.errors import RobotsError
from robots_planning import LinearCartesianDynamicProgramming, LinearCartesianLimited, LinearJoint
from robots_planning.path_kinematics.path_inverse_kinematics import PathInverseKinematics
from robots_planning.paths import path_grid
from robots_planning.paths.cartesian_line import CartesianLine
from robots_planning.paths.joint_path import JointPath
from robots_planning.trajectory import Trajectory

ROBOTS = ('kuka_kr210_r2700', 'staubli_tx2_90', 'ur5e', 'manutec_r3', 'mitsubishi_rv7frl', 'kuka_lbr_iiwa14')
SIX_AXES = ROBOTS[:-1]
LENGTH = 0.5  # m
CONVERGED = 5000
FINER = 5
FINE = 1e-4  # s
# Lines whose joints turn this fast per metre pass a singularity; there 5000 even steps are no reference.
NEAR_SINGULAR = 12.0  # rad/m
UNLIMITED = 1e6  # m/s and the like
console = Console(width=150)


@dataclass(frozen=True)
class Line:
    """A commanded line and its joint path."""

    q: np.ndarray
    target: Pose
    path: JointPath


class ToppraPath(AbstractGeometricPath):
    """A joint path as toppra takes it."""

    def __init__(self, path: JointPath) -> None:
        self._path = path

    def __call__(self, s: float | np.ndarray, order: int = 0) -> np.ndarray:
        places = np.asarray(s, dtype=np.float64)
        values = self._path.evaluate(np.atleast_1d(places))[order]
        return values[0] if places.ndim == 0 else values

    @property
    def dof(self) -> int:
        return self._path.num_axes

    @property
    def path_interval(self) -> np.ndarray:
        return np.array([0.0, 1.0])

    @property
    def waypoints(self) -> None:
        return None


def random_lines(robot: BaseRobotModel, count: int) -> list[Line]:
    """Lines that the robot can follow and that stay away from singularities."""
    rng, axes, kinematics = np.random.default_rng(5), robot.axes_data, PathInverseKinematics(robot)
    lines: list[Line] = []
    while len(lines) < count:
        q = np.clip(robot.home + 0.6 * rng.normal(size=robot.num_axes), axes.lower, axes.upper)
        start, way = Pose(*robot.direct_kinematics(q)), rng.normal(size=3)
        turn = Rotation.from_rotvec(0.3 * rng.normal(size=3)).as_matrix()
        target = Pose(start.r + LENGTH * way / np.linalg.norm(way), turn @ start.T)
        try:
            path = kinematics.follow(CartesianLine(start, target), q)
        except RobotsError:
            continue
        if np.abs(path.q_s).max() < NEAR_SINGULAR * LENGTH:
            lines.append(Line(q, target, path))
    return lines


def toppra_profile(
    robot: BaseRobotModel, path: JointPath, count: int, *, torque: bool = True
) -> tuple[np.ndarray, np.ndarray]:
    """Path grid and s_dot."""
    axes, model = robot.axes_data, robot.rigid_dynamics_model
    interpolated = constraint.DiscretizationType.Interpolation

    def bounds(limit: np.ndarray) -> np.ndarray:
        return np.column_stack([-limit, limit])

    limits = [
        constraint.JointVelocityConstraint(bounds(axes.velocity)),
        constraint.JointAccelerationConstraint(bounds(axes.acceleration), discretization_scheme=interpolated),
    ]
    if torque:
        limits.append(
            constraint.JointTorqueConstraint(
                lambda *state: model.torques(*(np.ascontiguousarray(part) for part in state)),
                bounds(axes.effort),
                np.zeros(robot.num_axes),
                discretization_scheme=interpolated,
            )
        )
    grid = np.linspace(0.0, 1.0, count + 1)
    solver = algorithm.TOPPRA(limits, ToppraPath(path), gridpoints=grid, solver_wrapper='seidel')
    return grid, solver.compute_parameterization(0.0, 0.0)[1]


def profile_duration(s: np.ndarray, speed: np.ndarray) -> float:
    return float((2.0 * np.diff(s) / (speed[1:] + speed[:-1])).sum())


def profile_motion(path: JointPath, s: np.ndarray, speed: np.ndarray) -> tuple[np.ndarray, ...]:
    """q, q_dot and q_ddot at 10 kHz of a profile with constant s_ddot from point to point."""
    steps = 2.0 * np.diff(s) / (speed[1:] + speed[:-1])
    begins = np.concatenate([[0.0], np.cumsum(steps)])
    t = np.arange(0.0, begins[-1], FINE)
    i = np.clip(np.searchsorted(begins, t, side='right') - 1, 0, len(steps) - 1)
    x, s_ddot = t - begins[i], (np.diff(speed) / steps)[i]
    s_dot = speed[i] + x * s_ddot
    q, q_s, q_ss = path.evaluate(s[i] + x * (speed[i] + 0.5 * x * s_ddot))
    return q, q_s * s_dot[:, None], q_ss * (s_dot**2)[:, None] + q_s * s_ddot[:, None]


def violation(robot: BaseRobotModel, motion: tuple[np.ndarray, ...]) -> float:
    """By how much of itself the worst limit is passed; 0 if none."""
    axes, model = robot.axes_data, robot.rigid_dynamics_model
    _, q_dot, q_ddot = motion
    tau = np.array([model.torques(*state) for state in zip(*motion, strict=True)])
    uses = (q_dot / axes.velocity, q_ddot / axes.acceleration, tau / axes.effort)
    return max(max(float(np.abs(use).max()) for use in uses) - 1.0, 0.0)


def milliseconds(calls: list[Callable[[], object]], repetitions: int) -> list[float]:
    """Median time of each call in this thread's share of the processor; they take turns."""
    times = np.empty((repetitions, len(calls)))
    for row in times:
        for column, call in enumerate(calls):
            begin = time.thread_time()
            call()
            row[column] = 1e3 * (time.thread_time() - begin)
    return [float(value) for value in np.median(times, axis=0)]


def dynamic_programming(count: int, repetitions: int) -> None:
    table = Table(
        title=f'{LENGTH} m lines, velocity, acceleration and torque limits: ours (whole plan) and toppra '
        f'(profile alone) over the optimum (toppra {CONVERGED}); worst violation of a limit at 10 kHz'
    )
    table.add_column('robot')
    table.add_column('s', justify='right')
    for name in ('ours', '1000', '300'):
        for column in ('ms', '%', 'worst %', 'broken'):
            table.add_column(f'{name}\n{column}', justify='right')
    for name in ROBOTS:
        robot = load_robot_model(name)
        planner = LinearCartesianDynamicProgramming(robot)
        results = []
        for line in random_lines(robot, count):
            optimum = profile_duration(*toppra_profile(robot, line.path, CONVERGED))
            trajectory = planner.generate(line.q, line.target)
            t = np.arange(0.0, trajectory.duration, FINE)
            rows = [[trajectory.duration, violation(robot, trajectory.sample(t))]]
            for grid in (1000, 300):
                profile = toppra_profile(robot, line.path, grid)
                rows.append(
                    [
                        profile_duration(*profile),
                        violation(robot, profile_motion(line.path, *profile)),
                    ]
                )

            def ours(line: Line = line, planner: LinearCartesianDynamicProgramming = planner) -> object:
                return planner.generate(line.q, line.target)

            def fine(line: Line = line, robot: BaseRobotModel = robot) -> object:
                return toppra_profile(robot, line.path, 1000)

            def coarse(line: Line = line, robot: BaseRobotModel = robot) -> object:
                return toppra_profile(robot, line.path, 300)

            times = milliseconds([ours, fine, coarse], repetitions)
            results.append(
                [
                    [ms, 100.0 * (row[0] / optimum - 1.0), row[1], optimum]
                    for ms, row in zip(times, rows, strict=True)
                ]
            )
        values = np.array(results)
        cells = [name, f'{np.median(values[:, 0, 3]):.3f}']
        for solver in range(3):
            part = values[:, solver]
            cells += [
                f'{np.median(part[:, 0]):.1f}',
                f'{np.median(part[:, 1]):.3f}',
                f'{part[:, 1].max():.3f}',
                f'{part[:, 2].max():.1e}',
            ]
        table.add_row(*cells)
    console.print(table)


def singular_lines(robot: BaseRobotModel, count: int) -> Iterator[tuple[np.ndarray, Pose]]:
    """Starts and targets: by thirds out of a straight wrist, from near it, and passing it on the way.

    How near is spread evenly over the powers of ten from 1e-7 to 0.1 rad.
    """
    rng, axes, kinematics = np.random.default_rng(7), robot.axes_data, PathInverseKinematics(robot)
    for number in range(count):
        q = np.clip(robot.home + 0.6 * rng.normal(size=robot.num_axes), axes.lower, axes.upper)
        near, way, turn = 10.0 ** rng.uniform(-7.0, -1.0), rng.normal(size=3), 0.3 * rng.normal(size=3)
        q[4] = 0.0 if number % 3 == 0 else near
        way *= LENGTH / np.linalg.norm(way)
        if number % 3 == 2:
            # Back to where the line begins.
            part, pose = rng.uniform(0.1, 0.9), kinematics.pose(q)
            begin = Pose(pose.r - part * way, Rotation.from_rotvec(-part * turn).as_matrix() @ pose.T)
            try:
                q = kinematics.follow(CartesianLine(pose, begin), q).q[-1]
            except RobotsError:
                continue
        pose = kinematics.pose(q)
        yield q, Pose(pose.r + way, Rotation.from_rotvec(turn).as_matrix() @ pose.T)


def any_lines(robot: BaseRobotModel, count: int) -> Iterator[tuple[np.ndarray, Pose]]:
    """Starts and targets at random, singular or not."""
    rng, axes = np.random.default_rng(8), robot.axes_data
    for _ in range(count):
        q = np.clip(robot.home + 0.6 * rng.normal(size=robot.num_axes), axes.lower, axes.upper)
        pose, way = Pose(*robot.direct_kinematics(q)), rng.normal(size=3)
        turn = Rotation.from_rotvec(0.3 * rng.normal(size=3)).as_matrix()
        yield q, Pose(pose.r + LENGTH * way / np.linalg.norm(way), turn @ pose.T)


def all_lines(count: int) -> None:
    table = Table(
        title=f'{LENGTH} m lines of six-axis robots that can be planned, torque limits included: '
        f'ms per whole plan, and % over that on a grid of {FINER} times as many points'
    )
    for column in ('lines', 'number', *4 * ('ms',), *3 * ('over %',)):
        table.add_column(column, justify='right')
    table.add_row('', '', 'median', '90 %', '99 %', 'most', 'median', '99 %', 'most', end_section=True)
    for name, lines in (('at random', any_lines), ('around singularities', singular_lines)):
        times, over = [], []
        for robot in map(load_robot_model, SIX_AXES):
            planner = LinearCartesianDynamicProgramming(robot)
            for q, target in lines(robot, 3 * count):

                def plan(
                    q: np.ndarray = q,
                    target: Pose = target,
                    planner: LinearCartesianDynamicProgramming = planner,
                ) -> Trajectory:
                    return planner.generate(q, target)

                try:
                    duration = plan().duration
                except RobotsError:
                    continue
                with finer_grid():
                    over.append(100.0 * (duration / plan().duration - 1.0))
                times += milliseconds([plan], 7)
        table.add_row(
            name,
            str(len(times)),
            *(f'{value:.1f}' for value in np.percentile(times, [50.0, 90.0, 99.0, 100.0])),
            *(f'{value:.3f}' for value in np.percentile(over, [50.0, 99.0, 100.0])),
        )
    console.print(table)


@contextlib.contextmanager
def finer_grid() -> Iterator[None]:
    """Plans are made on a finer grid meanwhile."""
    usual = path_grid.POINTS, path_grid.TURN_POINTS
    path_grid.POINTS, path_grid.TURN_POINTS = (FINER * points for points in usual)
    try:
        yield
    finally:
        path_grid.POINTS, path_grid.TURN_POINTS = usual


def limited(count: int, repetitions: int) -> None:
    table = Table(
        title=f'{LENGTH} m lines, velocity and acceleration limits of the axes: LinearCartesianLimited over '
        f'the optimum (toppra {CONVERGED})'
    )
    for column in ('robot', 'ms', 'over %', 'worst over %'):
        table.add_column(column, justify='right')
    for name in ROBOTS:
        robot = load_robot_model(name)
        planner = LinearCartesianLimited(
            robot,
            cartesian_speed=UNLIMITED,
            cartesian_acceleration=UNLIMITED,
            rotation_speed=UNLIMITED,
            rotation_acceleration=UNLIMITED,
        )
        over, times = [], []
        for line in random_lines(robot, count):
            optimum = profile_duration(*toppra_profile(robot, line.path, CONVERGED, torque=False))
            over.append(100.0 * (planner.generate(line.q, line.target).duration / optimum - 1.0))

            def ours(line: Line = line, planner: LinearCartesianLimited = planner) -> object:
                return planner.generate(line.q, line.target)

            times += milliseconds([ours], 5 * repetitions)
        table.add_row(name, f'{np.median(times):.2f}', f'{np.median(over):.2f}', f'{max(over):.2f}')
    console.print(table)


def joint_moves(count: int, repetitions: int) -> None:
    table = Table(title='LinearJoint and what Ruckig itself needs for the same, us')
    for column in ('robot', 'ours', 'Ruckig', 'difference'):
        table.add_column(column, justify='right')
    for name in ROBOTS:
        robot = load_robot_model(name)
        axes, planner, rng = robot.axes_data, LinearJoint(robot), np.random.default_rng(6)
        ours, peer = [], []
        for _ in range(count):
            q = np.clip(robot.home + 0.6 * rng.normal(size=(2, robot.num_axes)), axes.lower, axes.upper)
            way = np.maximum(np.abs(q[1] - q[0]), 1e-9)
            command = InputParameter(1)
            command.target_position = [1.0]
            command.max_velocity = [float((planner.velocity / way).min())]
            command.max_acceleration = [float((planner.acceleration / way).min())]
            command.max_jerk = [float((planner.jerk / way).min())]
            solver, plan = Ruckig(1), RuckigTrajectory(1)

            def plan_ours(q: np.ndarray = q, planner: LinearJoint = planner) -> object:
                return planner.generate(q[0], q[1])

            def plan_peer(
                solver: Ruckig = solver,
                command: InputParameter = command,
                plan: RuckigTrajectory = plan,
            ) -> object:
                return solver.calculate(command, plan)

            for times, ms in zip(
                (ours, peer), milliseconds([plan_ours, plan_peer], 20 * repetitions), strict=True
            ):
                times.append(1e3 * ms)
        first, second = float(np.median(ours)), float(np.median(peer))
        table.add_row(name, f'{first:.1f}', f'{second:.1f}', f'{first - second:.1f}')
    console.print(table)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--lines', type=int, default=10, help='per robot')
    parser.add_argument('--repetitions', type=int, default=5)
    arguments = parser.parse_args()
    logging.disable(logging.CRITICAL)  # toppra reports its steps
    dynamic_programming(arguments.lines, arguments.repetitions)
    all_lines(10 * arguments.lines)
    limited(arguments.lines, arguments.repetitions)
    joint_moves(arguments.lines, arguments.repetitions)


if __name__ == '__main__':
    main()
