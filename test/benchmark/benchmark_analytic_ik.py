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
# The same posture, found from the pose: close to singularities the pose hardly determines the angles.
SAME_POSTURE = 1e-4  # rad


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
    """Mean processor time of a call over all poses, us."""
    call = solver.call
    start = time.process_time()
    for arguments in solver.calls:
        call(*arguments)
    return (time.process_time() - start) / len(solver.calls) * 1e6


@dataclass(frozen=True)
class Quality:
    """What a solver's solutions are worth.

    Attributes:
        per_pose: Solutions per pose.
        inexact: Share of them that miss the pose by more than `EXACT`.
        worst: Largest error, m and rad.
        missing: Share of the poses without the posture that they were made from.
    """

    per_pose: float
    inexact: float
    worst: float
    missing: float


def quality(
    robot: BaseRobotModel, solver: Solver, poses: list[tuple[np.ndarray, np.ndarray]], postures: np.ndarray
) -> Quality:
    count, inexact, worst, missing = 0, 0, 0.0, 0
    for (r, T), arguments, posture in zip(poses, solver.calls, postures, strict=True):
        found = solver.solutions(solver.call(*arguments))
        for q in found:
            its_r, its_T = robot.direct_kinematics(q)
            error = max(np.linalg.norm(its_r - r), np.linalg.norm(its_T - T) / np.sqrt(2.0))
            count += 1
            inexact += error > EXACT
            worst = max(worst, float(error))
        turns = (found - posture) / (2.0 * np.pi)
        away = 2.0 * np.pi * np.abs(turns - np.round(turns)).max(axis=1, initial=0.0)
        missing += away.min(initial=np.inf) > SAME_POSTURE
    return Quality(count / len(poses), inexact / max(count, 1), worst, missing / len(poses))


@dataclass(frozen=True)
class Comparison:
    """Times (us) and solutions on one robot."""

    ours: float
    unlimited: float
    peer: float
    our_quality: Quality
    peer_quality: Quality


def compare(robot: BaseRobotModel, rounds: int, seed: int) -> Comparison:
    """Medians over rounds of random poses."""
    axes = robot.axes_data
    lower, upper = axes.one_turn
    postures = np.random.default_rng(seed).uniform(lower, upper, (POSES, 6))
    poses = [robot.direct_kinematics(q) for q in postures]
    solvers = our_solver(robot, poses), unlimited_solver(robot, poses), eaik_solver(robot, poses)
    times = [[microseconds(solver) for solver in solvers] for _ in range(rounds)]
    ours, unlimited, peer = np.median(times, axis=0)
    qualities = (quality(robot, solver, poses, postures) for solver in (solvers[0], solvers[2]))
    return Comparison(float(ours), float(unlimited), float(peer), *qualities)


def has_closed_form(robot: BaseRobotModel) -> bool:
    try:
        robot.inverse_kinematics_analytic(*robot.direct_kinematics(robot.home))
    except NoAnalyticInverseKinematicsError:
        return False
    return True


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--rounds', type=int, default=41, help='turns that each solver takes')
    parser.add_argument('--seed', type=int, default=12, help='of the poses')
    options = parser.parse_args()
    table = Table(
        'robot', title=f'Analytic inverse kinematics, medians of {options.rounds} turns of {POSES} poses'
    )
    columns = ('ours us', 'no limits us', 'EAIK us', 'ratio', 'ratio no limits')
    for column in (
        *columns,
        'ours per pose',
        'EAIK per pose',
        'ours inexact',
        'EAIK inexact',
        'ours missing',
    ):
        table.add_column(column, justify='right')
    for name in available_robot_models():
        robot = load_robot_model(name)
        if not has_closed_form(robot):
            continue
        c = compare(robot, options.rounds, options.seed)
        figures = (c.ours, c.unlimited, c.peer, c.ours / c.peer, c.unlimited / c.peer)
        both = (c.our_quality, c.peer_quality)
        table.add_row(
            name,
            *(f'{value:.2f}' for value in figures),
            *(f'{each.per_pose:.2f}' for each in both),
            *(f'{each.inexact:.2%} (worst {each.worst:.1e})' for each in both),
            f'{c.our_quality.missing:.2%}',
        )
    Console(width=180).print(table)


if __name__ == '__main__':
    main()
