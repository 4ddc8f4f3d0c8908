"""Kinematics and dynamics of every robot next to bare Pinocchio, roboticstoolbox and EAIK, call by call.

Run by `make benchmark-kinematics`. All take turns over the same motions, in CPU time, so that a busy machine
hits all. Ours is the robot's public method with its checks. Every call stands in a function of its own, so
that calling it takes the same. Pinocchio's come in two kinds. The bare calls leave their result where they
put it:

- FK: `framesForwardKinematics`, which computes the pose of the tool into `data`; no array comes out.
- J: `computeFrameJacobian`.
- J_der: `computeJointJacobiansTimeVariation` and `getFrameJacobianTimeVariation`.
- dynamics: `crba` and `nonLinearEffects`; without tau.

"To the same arrays" adds what is left to have what ours returns: for FK the reading of position and
orientation (faster after `forwardKinematics` and `updateFramePlacement`), for the dynamics the sum of
torques. These results are compared with ours before the clock starts.

roboticstoolbox takes part with its compiled `ETS.eval` (FK) and `ETS.jacob0`. Its derivative of the Jacobian
and its dynamics of a robot that is not given by Denavit-Hartenberg parameters are plain Python, and left out;
so are robots with an axis that slides. Analytic inverse kinematics is measured by the functions of
`make benchmark-analytic-ik`, over fewer poses.

The last table is of `Pose`, with its checks, next to `pinocchio.SE3`, which has none.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import pinocchio as pin
from benchmark_analytic_ik import eaik_solver, microseconds, our_solver
from benchmark_inverse_kinematics import elementary_transforms, ranges
from rich.console import Console
from rich.table import Table

from robots_core import BaseRobotModel, Pose, available_robot_models, load_robot_model
from robots_core.errors import NoAnalyticInverseKinematicsError
from robots_core.robot_model.urdf.urdf_chain import pinocchio_xml, read_urdf_chain

SAMPLES = 200
# Two ways to the same sums; relative to the largest entry.
AGREEMENT = 1e-9

# How many of q, q_dot and q_ddot a call takes.
ARGUMENTS = {'FK': 1, 'J': 1, 'J_der': 2, 'dynamics': 3, 'bare FK': 1, 'bare dynamics': 2}

POSE_GOALS = {'construction': 5.0, 'product': 3.0}  # us

Calls = dict[str, Callable[..., Any]]
Motion = tuple[np.ndarray, np.ndarray, np.ndarray]


def our_calls(robot: BaseRobotModel) -> Calls:
    def fk(q: np.ndarray) -> Any:
        return robot.direct_kinematics(q)

    def jacobian(q: np.ndarray) -> Any:
        return robot.jacobian(q)

    def jacobian_der(q: np.ndarray, q_dot: np.ndarray) -> Any:
        return robot.jacobian_der(q, q_dot)

    def dynamics(q: np.ndarray, q_dot: np.ndarray, q_ddot: np.ndarray) -> Any:
        return robot.rigid_dynamics(q, q_dot, q_ddot)

    return {'FK': fk, 'J': jacobian, 'J_der': jacobian_der, 'dynamics': dynamics}


def pinocchio_calls(robot: BaseRobotModel) -> Calls:
    """Calls on a model of their own; those that begin with `bare` yield less than ours."""
    chain = read_urdf_chain(robot.description)
    model = pin.buildModelFromXML(pinocchio_xml(chain))
    data = model.createData()
    tool0 = model.getFrameId(chain.tip, pin.FrameType.BODY)
    world = pin.LOCAL_WORLD_ALIGNED

    def bare_fk(q: np.ndarray) -> Any:
        return pin.framesForwardKinematics(model, data, q)

    def fk(q: np.ndarray) -> Any:
        pin.forwardKinematics(model, data, q)
        placement = pin.updateFramePlacement(model, data, tool0)
        return placement.translation, placement.rotation

    def jacobian(q: np.ndarray) -> Any:
        return pin.computeFrameJacobian(model, data, q, tool0, world)

    def jacobian_der(q: np.ndarray, q_dot: np.ndarray) -> Any:
        pin.computeJointJacobiansTimeVariation(model, data, q, q_dot)
        return pin.getFrameJacobianTimeVariation(model, data, tool0, world)

    def bare_dynamics(q: np.ndarray, q_dot: np.ndarray) -> Any:
        return pin.crba(model, data, q), pin.nonLinearEffects(model, data, q, q_dot)

    def dynamics(q: np.ndarray, q_dot: np.ndarray, q_ddot: np.ndarray) -> Any:
        M, tau_aux = pin.crba(model, data, q), pin.nonLinearEffects(model, data, q, q_dot)
        return M.dot(q_ddot) + tau_aux, M, tau_aux

    return {
        'FK': fk,
        'J': jacobian,
        'J_der': jacobian_der,
        'dynamics': dynamics,
        'bare FK': bare_fk,
        'bare dynamics': bare_dynamics,
    }


def toolbox_calls(robot: BaseRobotModel) -> Calls:
    if any(robot.axes_data.prismatic):
        return {}
    peer = elementary_transforms(robot)
    return {'FK': peer.eval, 'J': peer.jacob0}


def random_motions(robot: BaseRobotModel) -> list[Motion]:
    rng = np.random.default_rng(5)
    q = rng.uniform(*ranges(robot), (SAMPLES, robot.num_axes))
    v, a = rng.uniform(-1.0, 1.0, (2, SAMPLES, robot.num_axes))
    return list(zip(q, v, a, strict=True))


def compare(name: str, calls: dict[str, Calls], motions: Iterable[Motion]) -> None:
    """Refuse to time calls that do not agree."""
    for motion in motions:
        for what, call in calls['ours'].items():
            arguments = motion[: ARGUMENTS[what]]
            mine = call(*arguments)
            for peer in ('Pinocchio', 'toolbox'):
                if what not in calls[peer]:
                    continue
                its = calls[peer][what](*arguments)
                if peer == 'toolbox' and what == 'FK':
                    its = its[:3, 3], its[:3, :3]
                pairs = zip(mine, its, strict=True) if isinstance(mine, tuple) else [(mine, its)]
                for expected, value in pairs:
                    scale = max(1.0, float(np.abs(expected).max()))
                    if not np.abs(expected - value).max() <= AGREEMENT * scale:
                        raise SystemExit(f'{what} of {name}: ours and that of {peer} differ')


def mean_time(call: Callable[..., Any], arguments: list[tuple[np.ndarray, ...]]) -> float:
    """Mean CPU time of a call, us."""
    start = time.process_time()
    for some in arguments:
        call(*some)
    return (time.process_time() - start) / len(arguments) * 1e6


def analytic_times(robot: BaseRobotModel, motions: list[Motion], rounds: int) -> tuple[float, float] | None:
    """Median time per pose of ours and of EAIK, us."""
    try:
        robot.inverse_kinematics_analytic(*robot.direct_kinematics(robot.home))
    except NoAnalyticInverseKinematicsError:
        return None
    poses = [robot.direct_kinematics(q) for q, _, _ in motions]
    solvers = our_solver(robot, poses), eaik_solver(robot, poses)
    ours, peer = np.median([[microseconds(solver) for solver in solvers] for _ in range(rounds)], axis=0)
    return float(ours), float(peer)


def measure(calls: dict[str, Calls], motions: list[Motion], rounds: int) -> dict[str, dict[str, float]]:
    """Median times, us, by whose call and which."""
    arguments = {what: [motion[:count] for motion in motions] for what, count in ARGUMENTS.items()}
    times: dict[str, dict[str, list[float]]] = {whose: {what: [] for what in calls[whose]} for whose in calls}
    for _ in range(rounds):
        for what, some in arguments.items():
            for whose, samples in times.items():
                if what in samples:
                    samples[what].append(mean_time(calls[whose][what], some))
    return {
        whose: {what: float(np.median(values)) for what, values in samples.items()}
        for whose, samples in times.items()
    }


def pose_times(rounds: int) -> dict[str, tuple[float, float]]:
    """Median times of `Pose` and of `pinocchio.SE3`, us, by what is done."""
    rng = np.random.default_rng(5)
    arrays = [(r, pin.exp3(rotation)) for r, rotation in rng.normal(size=(SAMPLES, 2, 3))]
    poses, peers = [Pose(*pose) for pose in arrays], [pin.SE3(T, r) for r, T in arrays]

    def construct(r: np.ndarray, T: np.ndarray) -> Any:
        return Pose(r, T)

    def peer_construct(r: np.ndarray, T: np.ndarray) -> Any:
        return pin.SE3(T, r)

    def multiply(first: Pose, second: Pose) -> Any:
        return first @ second

    def peer_multiply(first: pin.SE3, second: pin.SE3) -> Any:
        return first * second

    pairs = {
        'construction': ((construct, arrays), (peer_construct, arrays)),
        'product': (
            (multiply, list(zip(poses, poses[::-1], strict=True))),
            (peer_multiply, list(zip(peers, peers[::-1], strict=True))),
        ),
    }
    return {
        what: tuple(np.median([[mean_time(*side) for side in sides] for _ in range(rounds)], axis=0))
        for what, sides in pairs.items()
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--rounds', type=int, default=41, help='turns that each takes')
    rounds = parser.parse_args().rounds
    heading = f'medians of {rounds} turns of {SAMPLES} calls, us of CPU time; ours / peer, ratio'
    plain = Table('robot', title=f'Ours and bare calls of Pinocchio, {heading}')
    for column in ('FK', 'J', 'J_der', 'dynamics'):
        plain.add_column(column, justify='right')
    same = Table('robot', title=f'Ours and Pinocchio to the same arrays, {heading}')
    for column in ('FK', 'dynamics'):
        same.add_column(column, justify='right')
    peers = Table('robot', title=f'Ours and other peers, {heading}')
    for column in ('FK, roboticstoolbox', 'J, roboticstoolbox', 'analytic IK, EAIK'):
        peers.add_column(column, justify='right')

    def cell(mine: float, its: float) -> str:
        return f'{mine:.2f} / {its:.2f}  {mine / its:.2f}'

    for name in available_robot_models():
        robot = load_robot_model(name)
        motions = random_motions(robot)
        calls = {
            'ours': our_calls(robot),
            'Pinocchio': pinocchio_calls(robot),
            'toolbox': toolbox_calls(robot),
        }
        compare(name, calls, motions[:10])
        medians = measure(calls, motions, rounds)
        ours, bare, toolbox = medians['ours'], medians['Pinocchio'], medians['toolbox']
        plain.add_row(
            name, *(cell(ours[what], bare.get(f'bare {what}', bare[what])) for what in our_calls(robot))
        )
        same.add_row(name, *(cell(ours[what], bare[what]) for what in ('FK', 'dynamics')))
        toolbox_cells = [cell(ours[what], toolbox[what]) if toolbox else '-' for what in ('FK', 'J')]
        analytic = analytic_times(robot, motions, rounds)
        peers.add_row(name, *toolbox_cells, cell(*analytic) if analytic else '-')
    poses = Table('Pose', 'Pose / pinocchio.SE3, ratio', 'at most', title=f'Poses, {heading}')
    for what, times in pose_times(rounds).items():
        poses.add_row(what, cell(*times), f'{POSE_GOALS[what]:g}')
    console = Console(width=150)
    console.print(plain, same, peers, poses)


if __name__ == '__main__':
    main()
