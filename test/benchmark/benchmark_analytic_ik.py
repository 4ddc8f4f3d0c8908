"""Analytic inverse kinematics next to EAIK (Ostermeier et al. 2025), pose by pose from Python.

Run by `make benchmark-analytic-ik`. Both take turns over the same poses, so that a busy machine hits both.
Our time includes the checks of the pose, the limits and the turns, which EAIK leaves to its caller; EAIK's is
that of the bare call, without taking the solutions out of its result. As limits spare us branches, our time
without limits, for all branches that exist, is shown too.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from eaik.IK_HP import HPRobot
from rich.console import Console
from rich.table import Table

from robots_core import BaseRobotModel, available_robot_models, load_robot_model
from robots_core.errors import NoAnalyticInverseKinematicsError
from robots_core.robot_model.analytic.analytic_solver import AnalyticSolver
from robots_core.robot_model.analytic.axis_lines import AxisLines

POSES = 500
EXACT = 1e-9  # m and rad


@dataclass(frozen=True)
class Solver:
    """One solver: its call per pose, and how to get solutions out of it."""

    calls: list[tuple[object, ...]]
    call: Callable[..., object]
    solutions: Callable[[object], np.ndarray]


def eaik_solver(robot: BaseRobotModel, poses: list[tuple[np.ndarray, np.ndarray]]) -> Solver:
    lines = AxisLines.of(robot)
    way = np.vstack([np.zeros(3), lines.points, lines.r])
    peer = HPRobot(lines.directions, np.diff(way, axis=0))
    targets = []
    for r, T in poses:
        target = np.eye(4)
        target[:3, :3], target[:3, 3] = T @ lines.T.T, r
        targets.append((target,))
    return Solver(targets, peer.IK, lambda result: np.array(result.Q).reshape(-1, 6))  # type: ignore[attr-defined]


def our_solver(robot: BaseRobotModel, poses: list[tuple[np.ndarray, np.ndarray]]) -> Solver:
    return Solver(list(poses), robot.inverse_kinematics_analytic, np.asarray)


def unlimited_solver(robot: BaseRobotModel, poses: list[tuple[np.ndarray, np.ndarray]]) -> Solver:
    return Solver(list(poses), AnalyticSolver(robot, limited=False).solve, np.asarray)


def microseconds(solver: Solver) -> float:
    """Mean time of a call over all poses, us."""
    call = solver.call
    start = time.perf_counter()
    for arguments in solver.calls:
        call(*arguments)
    return (time.perf_counter() - start) / len(solver.calls) * 1e6


def exactness(
    robot: BaseRobotModel, solver: Solver, poses: list[tuple[np.ndarray, np.ndarray]]
) -> tuple[str, str]:
    """Solutions per pose, and the share of them that miss the pose by more than `EXACT`."""
    count, missed, worst = 0, 0, 0.0
    for (r, T), arguments in zip(poses, solver.calls, strict=True):
        for q in solver.solutions(solver.call(*arguments)):
            its_r, its_T = robot.direct_kinematics(q)
            error = max(np.linalg.norm(its_r - r), np.linalg.norm(its_T - T) / np.sqrt(2.0))
            count += 1
            missed += error > EXACT
            worst = max(worst, float(error))
    return f'{count / len(poses):.2f}', f'{missed / max(count, 1):.2%} (worst {worst:.1e})'


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--rounds', type=int, default=41, help='turns that each solver takes')
    rounds = parser.parse_args().rounds
    table = Table('robot', title=f'Analytic inverse kinematics, medians of {rounds} turns of {POSES} poses')
    columns = ('ours us', 'no limits us', 'EAIK us', 'ratio', 'ratio no limits')
    for column in (*columns, 'ours per pose', 'EAIK per pose', 'ours inexact', 'EAIK inexact'):
        table.add_column(column, justify='right')
    for name in available_robot_models():
        robot = load_robot_model(name)
        try:
            robot.inverse_kinematics_analytic(*robot.direct_kinematics(robot.home))
        except NoAnalyticInverseKinematicsError:
            continue
        axes = robot.axes_data
        lower = np.where(axes.continuous, -np.pi, axes.lower)
        upper = np.where(axes.continuous, np.pi, axes.upper)
        postures = np.random.default_rng(12).uniform(lower, upper, (POSES, 6))
        poses = [robot.direct_kinematics(q) for q in postures]
        solvers = our_solver(robot, poses), unlimited_solver(robot, poses), eaik_solver(robot, poses)
        times = [[microseconds(solver) for solver in solvers] for _ in range(rounds)]
        ours, unlimited, peer = np.median(times, axis=0)
        (count, inexact), _, (its_count, its_inexact) = (exactness(robot, s, poses) for s in solvers)
        figures = [f'{value:.2f}' for value in (ours, unlimited, peer, ours / peer, unlimited / peer)]
        table.add_row(name, *figures, count, its_count, inexact, its_inexact)
    Console(width=170).print(table)


if __name__ == '__main__':
    main()
