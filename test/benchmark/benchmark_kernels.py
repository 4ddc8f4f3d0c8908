# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""What compiled functions save over Pinocchio's calls from Python, per call and per use.

Run by `make benchmark-kinematics`; --markdown prints the table of docs/explanation/benchmarks.md. A use is
what a person waits for, or what a node does in a period of the controller; next to it stands how often the
function is called there at least. Functions that other compiled functions call are measured in a compiled
loop, as they are used. Pinocchio would be called there from a loop in Python, whose own time is not counted.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np
import pinocchio as pin

from robots_core import Pose, load_robot_model
from robots_core.blocks import RigidBodyDrive
from robots_core.kernels.chain_dynamics import bodies_of, chain_dynamics_of, fill_dynamics, fill_torques
from robots_core.kernels.loaded_numba import nb
from robots_core.kernels.serial_chain import SerialChain, jacobian_der, pose_and_jacobian, tool_poses
from robots_core.robot_model.urdf_robot_model import UrdfRobotModel
from robots_core.validation import Array
from robots_planning import LinearCartesianDynamicProgramming

ROBOT = 'kuka_kr210_r2700'
PERIOD = 4000.0  # us, of the controller
SAMPLES = 500
WORLD = pin.LOCAL_WORLD_ALIGNED


@dataclass(frozen=True)
class Kernel:
    """One comparison.

    Attributes:
        name: The compiled function, or in words what is not compiled.
        ours: Runs over all samples, compiled.
        peer: Calls of Pinocchio and numpy for one sample, `peer(q, q_dot, q_ddot)`.
        use: What it is for.
        calls: How often it is called there, at least.
    """

    name: str
    ours: Callable[[Array, Array, Array], object]
    peer: Callable[[Array, Array, Array], object]
    use: str
    calls: int


@nb.njit
def _poses(chain: Array, q: Array, r: Array, T: Array, J: Array) -> None:
    for k in range(q.shape[0]):
        pose_and_jacobian(chain, q[k], r, T, J)


@nb.njit
def _one_pose(chain: Array, q: Array, r: Array, T: Array) -> bool:
    return tool_poses(chain, q.reshape((1, q.size)), r.reshape((1, 3)), T.reshape((1, 3, 3)))


@nb.njit
def _sum_of_torques(M: Array, q_ddot: Array, tau_aux: Array, tau: Array) -> bool:
    total = 0.0
    for i in range(tau.size):
        tau[i] = tau_aux[i]
        for j in range(tau.size):
            tau[i] += M[i, j] * q_ddot[j]
        total += tau[i]
    return total - total == 0.0


@nb.njit
def _derivatives(J: Array, q_dot: Array, J_der: Array) -> None:
    for k in range(q_dot.shape[0]):
        jacobian_der(J, q_dot[k], J_der)


@nb.njit
def _matrices(dynamics: Any, q: Array, q_dot: Array, M: Array, bias: Array, weight: Array) -> None:
    bodies = bodies_of(q.shape[1])
    for k in range(q.shape[0]):
        fill_dynamics(dynamics, q[k], q_dot[k], bodies, M, bias, weight)


@nb.njit
def _torques(dynamics: Any, q: Array, q_dot: Array, q_ddot: Array, tau: Array) -> None:
    bodies = bodies_of(q.shape[1])
    for k in range(q.shape[0]):
        fill_torques(dynamics, q[k], q_dot[k], q_ddot[k], bodies, tau)


def kernels(robot: UrdfRobotModel) -> list[Kernel]:
    """All comparisons of a robot."""
    model = pin.buildModelFromXML(robot.description)
    data, n = model.createData(), robot.num_axes
    tool0 = model.getFrameId('tool0', pin.FrameType.BODY)
    chain, dynamics = SerialChain.of(robot).arrays, chain_dynamics_of(robot).arrays
    r, T, J, M = np.empty(3), np.empty((3, 3)), np.empty((6, n)), np.empty((n, n))
    J_der, bias, weight = np.empty((6, n)), np.empty(n), np.empty(n)
    home = np.array(robot.home)
    pose = Pose(*robot.direct_kinematics(home + 0.1))
    target = Pose(pose.r + np.array([0.0, 0.3, -0.3]), pose.T)
    points = len(LinearCartesianDynamicProgramming(robot).generate(home + 0.1, target).time)
    steps = RigidBodyDrive(robot, home, period=1e-6 * PERIOD)._steps

    def tool_pose(q: Array, _: Array, __: Array) -> object:
        pin.forwardKinematics(model, data, q)
        placement = pin.updateFramePlacement(model, data, tool0)
        return placement.translation.copy(), placement.rotation.copy()

    def walk(q: Array, _: Array, __: Array) -> object:
        columns = pin.computeJointJacobians(model, data, q)
        placement = pin.updateFramePlacement(model, data, tool0)
        return (
            columns,
            placement.translation,
            placement.rotation,
            pin.getFrameJacobian(model, data, tool0, WORLD),
        )

    def derivative(q: Array, q_dot: Array, _: Array) -> object:
        pin.computeJointJacobiansTimeVariation(model, data, q, q_dot)
        return pin.getFrameJacobianTimeVariation(model, data, tool0, WORLD)

    def matrices(q: Array, q_dot: Array, _: Array) -> object:
        return pin.crba(model, data, q), pin.nonLinearEffects(model, data, q, q_dot)

    def torques(q: Array, q_dot: Array, q_ddot: Array) -> object:
        return pin.rnea(model, data, q, q_dot, q_ddot)

    return [
        Kernel(
            'tool_poses',
            lambda q, *_: robot.tool_poses(q),
            tool_pose,
            'verification of a planned line',
            points,
        ),
        Kernel(
            'pose_and_jacobian',
            lambda q, *_: _poses(chain, q, r, T, J),
            walk,
            'plan of a line, once a point',
            points,
        ),
        Kernel(
            'jacobian_der',
            lambda _, q_dot, __: _derivatives(J, q_dot, J_der),
            derivative,
            'plan of a line, once a point',
            points,
        ),
        Kernel(
            'fill_dynamics',
            lambda q, q_dot, _: _matrices(dynamics, q, q_dot, M, bias, weight),
            matrices,
            'rigid-body drives, one period',
            steps,
        ),
        Kernel(
            'fill_dynamics',
            lambda q, q_dot, _: _matrices(dynamics, q, q_dot, M, bias, weight),
            matrices,
            'plan of a line with torque limits, once a point',
            points,
        ),
        Kernel(
            'fill_torques',
            lambda q, q_dot, q_ddot: _torques(dynamics, q, q_dot, q_ddot, bias),
            torques,
            'plan of a line with torque limits, once a point',
            points,
        ),
    ]


def single_calls(robot: UrdfRobotModel) -> list[Kernel]:
    """What nodes call once a period; as compiled functions, they would be called from Python."""

    def each(call: Callable[..., object]) -> Callable[[Array, Array, Array], object]:
        def run(q: Array, q_dot: Array, q_ddot: Array) -> None:
            for motion in zip(q, q_dot, q_ddot, strict=True):
                call(*motion)

        return run

    chain, n = SerialChain.of(robot).arrays, robot.num_axes
    _, M, tau_aux = robot.rigid_dynamics(robot.home, np.ones(n), np.ones(n))

    def one_pose(q: Array, _: Array, __: Array) -> object:
        r, T = np.empty(3), np.empty((3, 3))
        return _one_pose(chain, q, r, T), r, T

    def sum_of_torques(_: Array, __: Array, q_ddot: Array) -> object:
        tau = np.empty(n)
        return _sum_of_torques(M, q_ddot, tau_aux, tau), tau

    def direct_kinematics(q: Array, _: Array, __: Array) -> object:
        return robot.direct_kinematics(q)

    def numpy_sum(_: Array, __: Array, q_ddot: Array) -> object:
        tau = M.dot(q_ddot) + tau_aux
        return isfinite(sum(tau.tolist())), tau

    return [
        Kernel('pose of the tool', each(one_pose), direct_kinematics, 'a period of a node', 1),
        Kernel('sum of torques', each(sum_of_torques), numpy_sum, 'a period of a node', 1),
    ]


def measured(kernel: Kernel, motions: tuple[Array, Array, Array], rounds: int) -> tuple[float, float]:
    """Median times of one call, compiled and Pinocchio's, us of the processor."""
    kernel.ours(*motions)
    times = []
    for _ in range(rounds):
        start = time.process_time()
        kernel.ours(*motions)
        between = time.process_time()
        for motion in zip(*motions, strict=True):
            kernel.peer(*motion)
        times.append((between - start, time.process_time() - between))
    ours, peer = 1e6 * np.median(times, axis=0) / len(motions[0])
    return float(ours), float(peer)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--rounds', type=int, default=41, help='turns that each takes')
    parser.add_argument('--markdown', action='store_true', help='print the table for the documentation')
    options = parser.parse_args()
    robot = load_robot_model(ROBOT)
    assert isinstance(robot, UrdfRobotModel)
    rng = np.random.default_rng(5)
    motions = tuple(rng.uniform(-1.0, 1.0, (3, SAMPLES, robot.num_axes)))
    headings = (
        'function',
        'compiled',
        'Pinocchio',
        'use',
        'calls',
        'compiled',
        'Pinocchio',
        'more, of a period',
    )
    line = (
        '| {} | {} | {} | {} | {} | {} | {} | {} |'
        if options.markdown
        else '{:18} {:>9} {:>10}  {:48} {:>6} {:>11} {:>11} {:>18}'
    )
    print(line.format(*headings))
    if options.markdown:
        print(line.format(*['---'] * len(headings)))
    for kernel in (*single_calls(robot), *kernels(robot)):
        ours, peer = measured(kernel, motions, options.rounds)
        print(
            line.format(
                f'`{kernel.name}`' if options.markdown else kernel.name,
                f'{ours:.2f} µs',
                f'{peer:.2f} µs',
                kernel.use,
                kernel.calls,
                f'{kernel.calls * ours:.0f} µs',
                f'{kernel.calls * peer:.0f} µs',
                f'{100.0 * kernel.calls * (peer - ours) / PERIOD:.1f} %',
            )
        )


if __name__ == '__main__':
    main()
