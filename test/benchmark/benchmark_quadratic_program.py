"""The quadratic programs of a constrained step through the interface of every solver, ours among them."""

from __future__ import annotations

from dataclasses import dataclass

import daqp
import numpy as np
import piqp
import quadprog
from contest import Contest, Row
from proxsuite import proxqp

from robots_core import BaseRobotModel
from robots_core.blocks.inverse_kinematics.quadratic_program import solve_quadratic_program

UNLIMITED = 1e30
Solutions = list[np.ndarray]


@dataclass(frozen=True)
class Program:
    """Minimise x^T H x / 2 + f^T x in -width <= x <= width, bottom <= C x <= top."""

    H: np.ndarray
    f: np.ndarray
    width: np.ndarray
    C: np.ndarray
    bottom: np.ndarray
    top: np.ndarray

    def objective(self, x: np.ndarray) -> float:
        return float(0.5 * x @ self.H @ x + self.f @ x)


def programs_of(robot: BaseRobotModel, dt: float, count: int, rng: np.random.Generator) -> list[Program]:
    """A robot at rest somewhere that is wanted to move somehow: accelerations and torques are limited."""
    axes, n = robot.axes_data, robot.num_axes
    low, high = axes.one_turn
    programs = []
    for q in rng.uniform(low, high, (count, n)):
        J = robot.jacobian(q)
        _, M, tau_aux = robot.rigid_dynamics(q, np.zeros(n), np.zeros(n))
        standing = tau_aux / axes.effort
        programs.append(
            Program(
                J.T @ J + 1e-6 * np.eye(n),
                -J.T @ rng.normal(size=6),
                dt * axes.acceleration,
                M / (dt * axes.effort[:, None]),
                -1.0 - standing,
                1.0 - standing,
            )
        )
    return programs


def by_ours(programs: list[Program]) -> Solutions:
    found = []
    for p in programs:
        n = p.f.size
        x, multipliers = np.empty(n), np.empty(2 * n)
        low, high = np.concatenate([-p.width, p.bottom]), np.concatenate([p.width, p.top])
        solve_quadratic_program(p.H, p.f, low, high, p.C, x, multipliers)
        found.append(x)
    return found


def by_daqp(programs: list[Program]) -> Solutions:
    sense = np.zeros(2 * programs[0].f.size, dtype=np.int32)
    return [
        daqp.solve(
            p.H, p.f, p.C, np.concatenate([p.width, p.top]), np.concatenate([-p.width, p.bottom]), sense
        )[0]
        for p in programs
    ]


def by_quadprog(programs: list[Program]) -> Solutions:
    eye = np.eye(programs[0].f.size)
    return [
        quadprog.solve_qp(
            p.H,
            -p.f,
            np.vstack([eye, -eye, p.C, -p.C]).T,
            np.concatenate([-p.width, -p.width, p.bottom, -p.top]),
        )[0]
        for p in programs
    ]


def by_piqp(programs: list[Program]) -> Solutions:
    found = []
    solver = piqp.DenseSolver()
    for k, p in enumerate(programs):
        call = solver.update if k else solver.setup
        call(P=p.H, c=p.f, G=p.C, h_l=p.bottom, h_u=p.top, x_l=-p.width, x_u=p.width)
        solver.solve()
        found.append(solver.result.x.copy())
    return found


def by_proxsuite(programs: list[Program]) -> Solutions:
    found = []
    n = programs[0].f.size
    solver = proxqp.dense.QP(n, 0, n, True)
    for k, p in enumerate(programs):
        call = solver.update if k else solver.init
        call(H=p.H, g=p.f, C=p.C, l=p.bottom, u=p.top, l_box=-p.width, u_box=p.width)
        solver.solve()
        found.append(solver.results.x.copy())
    return found


PEERS = {'daqp': by_daqp, 'quadprog': by_quadprog, 'piqp': by_piqp, 'proxsuite': by_proxsuite}


def quadratic_program_rows(
    robot: BaseRobotModel, dt: float, repetitions: int, count: int, rng: np.random.Generator
) -> list[Row]:
    programs = programs_of(robot, dt, count, rng)
    solvers = {'ours': by_ours, **PEERS}
    contest = Contest({name: lambda solver=solver: solver(programs) for name, solver in solvers.items()})
    contest.run(repetitions, count)
    ours = contest.results['ours']
    rows = []
    for peer in PEERS:
        excess = max(
            abs(p.objective(x) - p.objective(y))
            for p, x, y in zip(programs, contest.results[peer], ours, strict=True)
        )
        rows.append(
            Row(
                'quadratic program of a step',
                robot.name,
                contest.median('ours'),
                peer,
                contest.median(peer),
                quality=f'objectives differ by at most {excess:.0e}',
            )
        )
    return rows
