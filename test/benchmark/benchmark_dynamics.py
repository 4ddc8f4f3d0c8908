"""Dynamics and drives of every robot next to bare Pinocchio, call by call.

Run by `make benchmark-dynamics`. All take turns over the same motions, so that a busy machine hits all;
before the clock starts, the results are compared. Ours are the public methods with their checks:

- inverse dynamics: `NumericalDynamics.torques` and `FunctionDynamics.torques` next to `rnea`.
- M and bias: `NumericalDynamics.rigid_dynamics` next to `crba`, `nonLinearEffects` and the sum.
- forward dynamics: `NumericalDynamics.accelerations` next to `aba`, which knows no friction at rest.
- turning base: `NumericalDynamics.torques` on a base that turns next to `rnea` on a floating base.
- drive step: 4 ms of `RigidBodyDrive`, 16 steps with controllers that feed forward, motors, gears and
  friction, next to as many bare `aba` calls, which are what an explicit integration of the bodies alone would
  take at least. Below 4000 us one core runs it in real time.
A section is a function that makes rows for a robot; to measure something else, add one to SECTIONS.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin
from rich.console import Console
from rich.table import Table

from robots_core import BaseRobotModel, available_robot_models, load_robot_model
from robots_core.blocks import BaseMotion, FunctionDynamics, NumericalDynamics, RigidBodyDrive
from robots_core.robot_model.urdf.urdf_chain import pinocchio_xml, read_urdf_chain

SAMPLES = 100
PERIOD = 0.004  # s, of the drives' step
# Two ways to the same sums; forward dynamics divide by the mass matrix, of condition numbers up to 1e5.
AGREEMENT = 1e-8


@dataclass(frozen=True)
class Row:
    """What is measured: ours and its peer, each called once per sample.

    Attributes:
        name: Of the row.
        peer_name: What it is measured against.
        ours: Takes a sample.
        peer: Takes a sample.
        samples: Arguments of the calls.
        same: The results of both must agree.
    """

    name: str
    peer_name: str
    ours: Callable[..., Any]
    peer: Callable[..., Any]
    samples: list[tuple[Any, ...]]
    same: bool = True


def motions(robot: BaseRobotModel) -> list[tuple[np.ndarray, ...]]:
    axes = robot.axes_data
    rng = np.random.default_rng(5)
    low, high = axes.one_turn
    q = rng.uniform(low, high, (SAMPLES, axes.num_axes))
    v, a = rng.uniform(-1.0, 1.0, (2, SAMPLES, axes.num_axes))
    return list(zip(q, v, a, strict=True))


def dynamics_rows(robot: BaseRobotModel) -> Iterator[Row]:
    """Inverse and forward dynamics."""
    model = pin.buildModelFromXML(pinocchio_xml(read_urdf_chain(robot.description)))
    data = model.createData()
    samples = motions(robot)
    # The bodies alone: the peer has neither friction nor rotors.
    bare = {'friction': False, 'rotors': False}
    numerical, function = NumericalDynamics(robot, **bare), FunctionDynamics(robot, **bare)

    def rnea(q: np.ndarray, v: np.ndarray, a: np.ndarray) -> Any:
        return pin.rnea(model, data, q, v, a)

    def matrices(q: np.ndarray, v: np.ndarray, a: np.ndarray) -> Any:
        M, bias = pin.crba(model, data, q), pin.nonLinearEffects(model, data, q, v)
        return M.dot(a) + bias, M, bias

    def aba(q: np.ndarray, v: np.ndarray, a: np.ndarray) -> Any:
        return pin.aba(model, data, q, v, a)

    yield Row('inverse dynamics, numerical', 'rnea', numerical.torques, rnea, samples)
    yield Row('inverse dynamics, function', 'rnea', function.torques, rnea, samples)
    yield Row('M and bias', 'crba + nonLinearEffects', numerical.rigid_dynamics, matrices, samples)
    yield Row('forward dynamics', 'aba', numerical.accelerations, aba, samples)
    turning = NumericalDynamics(
        robot, base=BaseMotion(angular_velocity=[0.1, 0.2, 0.3], angular_acceleration=[1.0, 2.0, 3.0]), **bare
    )
    floating, floating_data = turning.model, turning.model.createData()
    configuration, speed, push = pin.neutral(floating), np.zeros(floating.nv), np.zeros(floating.nv)
    push[:3] = -turning.gravity
    speed[3:6], push[3:6] = turning.base.angular_velocity, turning.base.angular_acceleration

    def moving(q: np.ndarray, v: np.ndarray, a: np.ndarray) -> Any:
        configuration[7:], speed[6:], push[6:] = q, v, a
        return pin.rnea(floating, floating_data, configuration, speed, push)[6:]

    yield Row('turning base', 'rnea, floating base', turning.torques, moving, samples)


def drive_rows(robot: BaseRobotModel) -> Iterator[Row]:
    """The rigid-body drives' step, on a reference that swings about home."""
    model = pin.buildModelFromXML(pinocchio_xml(read_urdf_chain(robot.description)))
    data = model.createData()
    drive = RigidBodyDrive(robot, robot.home, period=PERIOD, feed_forward=True)
    wave = 0.05 * robot.axes_data.velocity
    angles = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES
    samples = [(robot.home + wave * np.sin(x), wave * np.cos(x)) for x in angles]
    steps = round(PERIOD / 0.25e-3)
    still = np.zeros(robot.num_axes)

    def bodies(q: np.ndarray, v: np.ndarray) -> None:
        for _ in range(steps):
            pin.aba(model, data, q, v, still)

    yield Row('drive step of 4 ms', f'{steps} x aba', drive.step, bodies, samples, same=False)


SECTIONS: list[Callable[[BaseRobotModel], Iterator[Row]]] = [dynamics_rows, drive_rows]


def compare(robot: str, row: Row) -> None:
    """Refuse to time calls that do not agree."""
    for sample in row.samples[:10]:
        ours, peer = row.ours(*sample), row.peer(*sample)
        pairs = zip(ours, peer, strict=True) if isinstance(ours, tuple) else [(ours, peer)]
        for mine, its in pairs:
            if not np.abs(mine - its).max() <= AGREEMENT * (1.0 + np.abs(its).max()):
                raise SystemExit(f'{row.name} of {robot}: ours and {row.peer_name} differ')


def mean_time(call: Callable[..., Any], samples: list[tuple[Any, ...]]) -> float:
    """Mean time of one core that a call takes, us."""
    start = time.thread_time()
    for sample in samples:
        call(*sample)
    return (time.thread_time() - start) / len(samples) * 1e6


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--rounds', type=int, default=21, help='turns that each takes')
    parser.add_argument('--robot', action='append', help='these robots alone')
    options = parser.parse_args()
    table = Table(
        'robot', 'what', title=f'Ours and the peer, medians of {options.rounds} turns of {SAMPLES} calls'
    )
    for column in ('ours, us', 'per second', 'peer', 'peer, us', 'ours / peer'):
        table.add_column(column, justify='left' if column == 'peer' else 'right')
    for name in options.robot or available_robot_models():
        robot = load_robot_model(name)
        for section in SECTIONS:
            for row in section(robot):
                if row.same:
                    compare(name, row)
                times = [
                    (mean_time(row.ours, row.samples), mean_time(row.peer, row.samples))
                    for _ in range(options.rounds)
                ]
                ours, peer = np.median(times, axis=0)
                table.add_row(
                    name,
                    row.name,
                    f'{ours:.2f}',
                    f'{1e6 / ours:,.0f}',
                    row.peer_name,
                    f'{peer:.2f}',
                    f'{ours / peer:.2f}',
                )
        table.add_section()
    Console(width=130).print(table)


if __name__ == '__main__':
    main()
