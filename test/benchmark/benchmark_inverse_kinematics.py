"""Numerical and constrained inverse kinematics next to their peers, in one process, turn by turn.

Run by `make benchmark-inverse-kinematics`. Every solution is checked with the robot's own kinematics
(Pinocchio), not with that of the solver. Medians over repetitions in which all solvers take turns, so that a
busy machine hits all of them.
"""

from __future__ import annotations

import argparse
import datetime as dt
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import daqp
import numpy as np
import pink
import pinocchio as pin
import piqp
import quadprog
from pink.limits import AccelerationLimit, ConfigurationLimit, VelocityLimit
from proxsuite import proxqp
from rich.console import Console
from rich.table import Table
from roboticstoolbox.ets import ET, ETS

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.blocks import ConstrainedInverseKinematics, DampedLeastSquares
from robots_core.blocks.inverse_kinematics.chain import SerialChain
from robots_core.blocks.inverse_kinematics.quadratic_program import solve_quadratic_program

ROBOTS = ('ur5e', 'franka_fr3', 'kuka_lbr_iiwa14', 'kinova_j2n6s300', 'kuka_kr210_r2700')
TOLERANCE = 1e-6  # m and rad
# The peers' residual is half the squared error; searched a little more exactly, so that rounding of the check
# costs nobody a solution.
LM_TOLERANCE = 0.5 * (0.9 * TOLERANCE) ** 2
DT = 0.004
console = Console(width=130)


@dataclass
class Contest:
    """Times per call (us) of solvers that take turns."""

    calls: dict[str, Callable[[], object]]
    times: dict[str, list[float]] = field(default_factory=dict)
    results: dict[str, object] = field(default_factory=dict)

    def run(self, repetitions: int, count: int) -> None:
        """Each call works on `count` problems."""
        for name, call in self.calls.items():
            self.results[name] = call()  # warm
        for _ in range(repetitions):
            for name, call in self.calls.items():
                start = time.perf_counter()
                call()
                self.times.setdefault(name, []).append(1e6 * (time.perf_counter() - start) / count)

    def median(self, name: str) -> float:
        return float(np.median(self.times[name]))


def ranges(robot: BaseRobotModel) -> tuple[np.ndarray, np.ndarray]:
    axes = robot.axes_data
    return np.where(axes.continuous, -np.pi, axes.lower), np.where(axes.continuous, np.pi, axes.upper)


def elementary_transforms(robot: BaseRobotModel) -> ETS:
    """The robot for roboticstoolbox: a frame on each axis, z along it."""
    chain, (low, high) = SerialChain.of(robot), ranges(robot)
    parts, last = [], np.eye(4)
    for direction, point, lower, upper in zip(chain.directions, chain.points, low, high, strict=True):
        frame = np.eye(4)
        x = np.cross(direction, np.eye(3)[np.argmin(np.abs(direction))])
        x /= np.linalg.norm(x)
        frame[:3, :3] = np.column_stack([x, np.cross(direction, x), direction])
        frame[:3, 3] = point
        parts += [ET.SE3(np.linalg.inv(last) @ frame), ET.Rz(qlim=[lower, upper])]
        last = frame
    tool = np.eye(4)
    tool[:3, :3], tool[:3, 3] = chain.T, chain.r
    return ETS([*parts, ET.SE3(np.linalg.inv(last) @ tool)])


def solved_share(robot: BaseRobotModel, poses: list[Pose], solutions: list[np.ndarray]) -> float:
    axes = robot.axes_data
    solved = 0
    for pose, q in zip(poses, solutions, strict=True):
        inside = (q >= axes.lower - 1e-9).all() and (q <= axes.upper + 1e-9).all()
        if inside:
            r, T = robot.direct_kinematics(q)
            sine = 0.5 * np.linalg.norm(np.cross(T.T, pose.T.T).sum(axis=0))
            off = max(float(np.linalg.norm(r - pose.r)), float(sine))
            solved += off <= TOLERANCE and np.trace(T.T @ pose.T) > 0.0
    return 100.0 * solved / len(poses)


def numerical(repetitions: int, count: int) -> None:
    table = Table(
        title=f'DampedLeastSquares, {count} random reachable poses from random starts, 1e-6 m and rad'
    )
    for column in ('robot', 'ours us', 'ours %', 'ik_LM us', 'ik_LM %', 'ratio', 'solve_many us', 'poses/s'):
        table.add_column(column, justify='right')
    for name in ROBOTS:
        robot = load_robot_model(name)
        low, high = ranges(robot)
        rng = np.random.default_rng(7)
        poses = [Pose(*robot.direct_kinematics(q)) for q in rng.uniform(low, high, (count, low.size))]
        starts = rng.uniform(low, high, (count, low.size))
        ours, peer = (
            DampedLeastSquares(robot, tolerances=(TOLERANCE, TOLERANCE)),
            elementary_transforms(robot),
        )
        matrices = []
        for pose in poses:
            matrix = np.eye(4)
            matrix[:3, :3], matrix[:3, 3] = pose.T, pose.r
            matrices.append(matrix)
        r, T = np.array([pose.r for pose in poses]), np.array([pose.T for pose in poses])
        our_work = list(zip(poses, starts, strict=True))
        peer_work = list(zip(matrices, starts, strict=True))

        def solve_ours(ours: DampedLeastSquares = ours, work: list = our_work) -> object:
            return [ours.solve(pose, start).q for pose, start in work]

        def solve_peer(peer: ETS = peer, work: list = peer_work) -> object:
            return [
                np.asarray(peer.ik_LM(matrix, q0=start, tol=LM_TOLERANCE, joint_limits=True)[0])
                for matrix, start in work
            ]

        def solve_many(
            ours: DampedLeastSquares = ours, r: np.ndarray = r, T: np.ndarray = T, s: np.ndarray = starts
        ) -> object:
            return list(ours.solve_many(r, T, s).q)

        contest = Contest({'ours': solve_ours, 'peer': solve_peer, 'many': solve_many})
        contest.run(repetitions, count)
        shares = {key: solved_share(robot, poses, found) for key, found in contest.results.items()}
        mine, other, many = (contest.median(key) for key in ('ours', 'peer', 'many'))
        table.add_row(
            name,
            f'{mine:.1f}',
            f'{shares["ours"]:.2f}',
            f'{other:.1f}',
            f'{shares["peer"]:.2f}',
            f'{mine / other:.2f}',
            f'{many:.1f}',
            f'{1e6 / many:.0f}',
        )
    console.print(table)
    console.print('targets: at least 99.95 %, ratio at most 0.7 on every robot')


def constrained(repetitions: int, count: int) -> None:
    table = Table(title='ConstrainedInverseKinematics.step (with torque limits) and a step of pink (without)')
    for column in ('robot', 'ours us', 'pink us', 'ratio'):
        table.add_column(column, justify='right')
    for name in ('kuka_kr210_r2700', 'franka_fr3', 'kuka_kr500_r2830'):
        robot = load_robot_model(name)
        axes = robot.axes_data
        low, high = ranges(robot)
        rng = np.random.default_rng(3)
        states = 0.7 * robot.home + 0.3 * rng.uniform(low, high, (count, low.size))
        targets = [Pose(*robot.direct_kinematics(np.clip(q + 0.02, low, high))) for q in states]
        still = np.zeros(low.size)
        ours = ConstrainedInverseKinematics(robot, DT)
        model = pin.buildModelFromXML(robot.description)
        model.lowerPositionLimit, model.upperPositionLimit = np.array(low), np.array(high)
        model.velocityLimit = np.array(axes.velocity)
        limits = [
            ConfigurationLimit(model),
            VelocityLimit(model),
            AccelerationLimit(model, np.array(axes.acceleration)),
        ]
        task = pink.FrameTask('tool0', position_cost=1.0, orientation_cost=0.5)
        configuration = pink.Configuration(model, model.createData(), states[0])
        placements = [pin.SE3(np.array(pose.T), np.array(pose.r)) for pose in targets]

        def step_ours(
            ours: ConstrainedInverseKinematics = ours,
            states: np.ndarray = states,
            targets: list = targets,
            still: np.ndarray = still,
        ) -> object:
            for q, pose in zip(states, targets, strict=True):
                step = ours.step(pose, q, still)
            return step

        def step_pink(
            configuration: pink.Configuration = configuration,
            task: pink.FrameTask = task,
            placements: list = placements,
            states: np.ndarray = states,
            limits: list = limits,
        ) -> object:
            for q, placement in zip(states, placements, strict=True):
                task.set_target(placement)
                configuration.update(q)
                velocity = pink.solve_ik(
                    configuration, [task], DT, solver='daqp', damping=1e-6, limits=limits
                )
            return velocity

        contest = Contest({'ours': step_ours, 'pink': step_pink})
        contest.run(repetitions, count)
        mine, other = contest.median('ours'), contest.median('pink')
        table.add_row(name, f'{mine:.1f}', f'{other:.1f}', f'{mine / other:.2f}')
    console.print(table)
    console.print('target: ratio at most 0.3')


def quadratic_programs(repetitions: int, count: int) -> None:  # noqa: C901  # one small function per solver
    """The same programs, of the shape of the constrained block, through every solver's own interface."""
    robot = load_robot_model('franka_fr3')
    low, high = ranges(robot)
    n = robot.num_axes
    rng = np.random.default_rng(5)
    programs = []
    for q in rng.uniform(low, high, (count, n)):
        J = robot.jacobian(q)
        H = J.T @ J + 1e-6 * np.eye(n)
        f = -J.T @ rng.normal(size=6)
        _, M, tau_aux = robot.rigid_dynamics(q, np.zeros(n), np.zeros(n))
        rows = M / (DT * robot.axes_data.effort[:, None])
        c = np.concatenate([1.0 - tau_aux / robot.axes_data.effort, 1.0 + tau_aux / robot.axes_data.effort])
        width = DT * robot.axes_data.acceleration
        programs.append((H, f, -width, width, np.vstack([rows, -rows]), c))

    def ours() -> object:
        found = []
        for H, f, lower, upper, C, c in programs:
            x, multipliers = np.empty(n), np.empty(2 * n)
            low, high = np.concatenate([lower, -c[n:]]), np.concatenate([upper, c[:n]])
            solve_quadratic_program(H, f, low, high, C[:n], x, multipliers)
            found.append(x)
        return found

    def by_quadprog() -> object:
        eye = np.eye(n)
        return [
            quadprog.solve_qp(H, -f, np.vstack([eye, -eye, -C]).T, np.concatenate([lower, -upper, -c]))[0]
            for H, f, lower, upper, C, c in programs
        ]

    def by_daqp() -> object:
        free, sense = np.full(2 * n, -1e30), np.zeros(3 * n, dtype=np.int32)
        return [
            daqp.solve(H, f, C, np.concatenate([upper, c]), np.concatenate([lower, free]), sense)[0]
            for H, f, lower, upper, C, c in programs
        ]

    def by_piqp() -> object:
        found = []
        solver = piqp.DenseSolver()
        for k, (H, f, lower, upper, C, c) in enumerate(programs):
            if k == 0:
                solver.setup(P=H, c=f, G=C, h_u=c, x_l=lower, x_u=upper)
            else:
                solver.update(P=H, c=f, G=C, h_u=c, x_l=lower, x_u=upper)
            solver.solve()
            found.append(solver.result.x.copy())
        return found

    def by_proxsuite() -> object:
        found = []
        solver = proxqp.dense.QP(n, 0, 2 * n, True)
        free = np.full(2 * n, -1e30)
        for k, (H, f, lower, upper, C, c) in enumerate(programs):
            if k == 0:
                solver.init(H, f, None, None, C, free, c, lower, upper)
            else:
                solver.update(H=H, g=f, C=C, l=free, u=c, l_box=lower, u_box=upper)
            solver.solve()
            found.append(solver.results.x.copy())
        return found

    contest = Contest(
        {'ours': ours, 'daqp': by_daqp, 'quadprog': by_quadprog, 'piqp': by_piqp, 'proxsuite': by_proxsuite}
    )
    contest.run(repetitions, count)
    table = Table(title=f'{count} quadratic programs of {n} variables, {n} bounds, {2 * n} rows')
    for column in ('solver', 'us', 'largest excess of the objective'):
        table.add_column(column, justify='right')
    best = contest.results['ours']
    for name, found in contest.results.items():
        excess = max(
            abs(_objective(program, x) - _objective(program, y))
            for program, x, y in zip(programs, found, best, strict=True)
        )
        table.add_row(name, f'{contest.median(name):.1f}', f'{excess:.1e}')
    console.print(table)


def _objective(program: tuple[np.ndarray, ...], x: np.ndarray) -> float:
    return float(0.5 * x @ program[0] @ x + program[1] @ x)


FIRST_RESULT = """
import time; start = time.perf_counter()
import numpy as np
from robots_core import Pose, load_robot_model
from robots_core.blocks import {block}
robot = load_robot_model('kuka_kr210_r2700')
pose = Pose(*robot.direct_kinematics(robot.home + 0.1))
{call}
print(time.perf_counter() - start)
"""
CALLS = {
    'DampedLeastSquares': 'DampedLeastSquares(robot).solve(pose, robot.home)',
    'ConstrainedInverseKinematics': (
        'ConstrainedInverseKinematics(robot, 0.004).step(pose, robot.home, np.zeros(robot.num_axes))'
    ),
}


def first_results(repetitions: int) -> None:
    table = Table(
        title='Time to the first result of a fresh process (imports and robot included), code cached'
    )
    for column in ('block', 's'):
        table.add_column(column, justify='right')
    for block, call in CALLS.items():
        code = FIRST_RESULT.format(block=block, call=call)
        times = [
            float(subprocess.run([sys.executable, '-P', '-c', code], check=True, capture_output=True).stdout)
            for _ in range(repetitions)
        ]
        table.add_row(block, f'{np.median(times):.2f}')
    console.print(table)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--poses', type=int, default=2000)
    parser.add_argument('--repetitions', type=int, default=5)
    options = parser.parse_args()
    console.print(f'{dt.datetime.now(tz=dt.UTC):%Y-%m-%d}')
    numerical(options.repetitions, options.poses)
    constrained(options.repetitions, 500)
    quadratic_programs(options.repetitions, 500)
    first_results(options.repetitions)


if __name__ == '__main__':
    main()
