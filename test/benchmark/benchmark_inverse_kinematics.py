"""Inverse kinematics next to its peers, in one process, turn by turn, as one table.

Run by `make benchmark-inverse-kinematics`; OPTIONS=--markdown prints the table of
docs/explanation/benchmarks.md. Every solution is checked with the robot's own kinematics (Pinocchio), not
with that of the solver. Times are medians over repetitions of the mean over all problems: processor time, in
which other work on the machine does not count; by the clock for `solve_many`, which has all cores. Poses are
others in every run unless `--seed` repeats one.
"""

from __future__ import annotations

import argparse
import datetime as dt
import os
import secrets
import time

import numpy as np
import pink
import pinocchio as pin
from benchmark_analytic_ik import compare, has_closed_form
from benchmark_quadratic_program import quadratic_program_rows
from contest import Contest, Row, show
from pink.limits import AccelerationLimit, ConfigurationLimit, VelocityLimit
from roboticstoolbox.ets import ET, ETS

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.blocks import ConstrainedInverseKinematics, DampedLeastSquares
from robots_core.kernels.serial_chain import SerialChain

ROBOTS = ('ur5e', 'franka_fr3', 'kuka_lbr_iiwa14', 'kinova_j2n6s300', 'kuka_kr210_r2700')
# The paper's motion simulator follows references by constrained steps.
CONSTRAINED_ROBOTS = (*ROBOTS, 'kuka_kr500_r2830')
TOLERANCE = 1e-6  # m and rad
# The peers' residual is half the squared error; searched a little more exactly, so that rounding of the check
# costs no method a solution.
LM_TOLERANCE = 0.5 * (0.9 * TOLERANCE) ** 2
DT = 0.004
STEPS = 500


def ranges(robot: BaseRobotModel) -> tuple[np.ndarray, np.ndarray]:
    axes = robot.axes_data
    return axes.one_turn


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


def numerical_rows(robot: BaseRobotModel, repetitions: int, count: int, seed: int) -> list[Row]:
    low, high = ranges(robot)
    rng = np.random.default_rng(seed)
    poses = [Pose(*robot.direct_kinematics(q)) for q in rng.uniform(low, high, (count, low.size))]
    starts = rng.uniform(low, high, (count, low.size))
    ours, peer = DampedLeastSquares(robot, tolerances=(TOLERANCE, TOLERANCE)), elementary_transforms(robot)
    r, T = np.array([pose.r for pose in poses]), np.array([pose.T for pose in poses])
    matrices = np.tile(np.eye(4), (count, 1, 1))
    matrices[:, :3, :3], matrices[:, :3, 3] = T, r

    def solve_ours() -> list[np.ndarray]:
        return [ours.solve(pose, start).q for pose, start in zip(poses, starts, strict=True)]

    def solve_peer() -> list[np.ndarray]:
        return [
            np.asarray(peer.ik_LM(matrix, q0=start, tol=LM_TOLERANCE, joint_limits=True)[0])
            for matrix, start in zip(matrices, starts, strict=True)
        ]

    single = Contest({'ours': solve_ours, 'peer': solve_peer})
    single.run(repetitions, count)
    batch = Contest({'many': lambda: list(ours.solve_many(r, T, starts).q)}, clock=time.perf_counter)
    batch.run(repetitions, count)
    our_share, peer_share, batch_share = (
        solved_share(robot, poses, found) for found in (*single.results.values(), *batch.results.values())
    )
    many, cores = batch.median('many'), len(os.sched_getaffinity(0))
    return [
        Row(
            '`DampedLeastSquares.solve`',
            robot.name,
            single.median('ours'),
            '`ik_LM`',
            single.median('peer'),
            0.7,
            f'{our_share:.2f} % solved, peer {peer_share:.2f} %',
        ),
        Row(
            f'`solve_many`, {cores} cores',
            robot.name,
            many,
            quality=f'{1e6 / many:.0f} poses a second, {batch_share:.2f} % solved',
        ),
    ]


def analytic_row(robot: BaseRobotModel, repetitions: int, seed: int) -> Row:
    found = compare(robot, repetitions, seed)
    ours, peer = found.our_quality, found.peer_quality
    return Row(
        'closed form, all branches',
        robot.name,
        found.ours,
        'EAIK',
        found.peer,
        1.0,
        f'{found.unlimited:.3g} µs without limits; {ours.per_pose:.1f} a pose inside them, '
        f'worst error {ours.worst:.0e}, {100.0 * ours.missing:.0f} % missing; '
        f'peer {peer.per_pose:.1f}, {100.0 * peer.inexact:.0f} % wrong',
    )


def constrained_row(robot: BaseRobotModel, repetitions: int, count: int, seed: int) -> Row:
    """A step of ours holds torque limits too; pink's has those of position, velocity and acceleration."""
    axes = robot.axes_data
    low, high = ranges(robot)
    rng = np.random.default_rng(seed)
    states = 0.7 * robot.home + 0.3 * rng.uniform(low, high, (count, low.size))
    targets = [Pose(*robot.direct_kinematics(np.clip(q + 0.02, low, high))) for q in states]
    still = np.zeros(low.size)
    ours = ConstrainedInverseKinematics(robot, DT)
    # Joints that turn without end are two numbers in Pinocchio: pink gets them with limits.
    model = pin.buildModelFromXML(robot.description.replace('type="continuous"', 'type="revolute"'))
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

    def step_ours() -> list[float]:
        return [ours.step(pose, q, still).slack for q, pose in zip(states, targets, strict=True)]

    def step_pink() -> None:
        for q, placement in zip(states, placements, strict=True):
            task.set_target(placement)
            configuration.update(q)
            pink.solve_ik(configuration, [task], DT, solver='daqp', damping=1e-6, limits=limits)

    contest = Contest({'ours': step_ours, 'pink': step_pink})
    contest.run(repetitions, count)
    inside = np.mean(np.array(contest.results['ours']) == 0.0)
    return Row(
        '`ConstrainedInverseKinematics.step`',
        robot.name,
        contest.median('ours'),
        'pink',
        contest.median('pink'),
        0.3,
        f'{100.0 * inside:.1f} % of the steps inside all limits, those of torques too',
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--poses', type=int, default=2000)
    parser.add_argument('--repetitions', type=int, default=5)
    parser.add_argument(
        '--seed', type=int, default=None, help='of poses and starts; another one in every run'
    )
    parser.add_argument(
        '--markdown', action='store_true', help='print the table as in docs/explanation/benchmarks.md'
    )
    options = parser.parse_args()
    repetitions = options.repetitions
    seed = secrets.randbits(32) if options.seed is None else options.seed
    robots = {name: load_robot_model(name) for name in CONSTRAINED_ROBOTS}
    rows = [row for name in ROBOTS for row in numerical_rows(robots[name], repetitions, options.poses, seed)]
    rows.sort(key=lambda row: row.what)  # stable: the order of the robots stays
    rows += [
        analytic_row(robot, 4 * repetitions, seed) for robot in robots.values() if has_closed_form(robot)
    ]
    rows += [constrained_row(robot, repetitions, STEPS, seed) for robot in robots.values()]
    rng = np.random.default_rng(seed)
    rows += quadratic_program_rows(robots['franka_fr3'], DT, repetitions, STEPS, rng)
    today = f'{dt.datetime.now(tz=dt.UTC):%-d %B %Y}'
    title = (
        f'`make benchmark-inverse-kinematics` on {today}: {options.poses} random reachable poses from random '
        f'starts, 1e-6 m and rad, medians of {repetitions}, seed {seed}'
    )
    show(rows, title, markdown=options.markdown)


if __name__ == '__main__':
    main()
