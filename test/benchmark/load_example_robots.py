"""Load every robot of the package example-robot-data, and hold what loads to basic laws.

Run by `make load-example-robots`. Each URDF either loads with all its shapes, or is refused by a
`RobotsError` that says why. Of those that are refused, each way from the base to an end is tried as `?tip=`
would have it, without shapes. Anything else that is raised, and any robot that breaks a law, is an error and
the exit code 1:

- The tool's orientation is orthonormal, and the Jacobian the derivative of its pose.
- The mass matrix is symmetric, and positive definite where every body has a mass and an inertia.
- Torques are those of the recursive Newton-Euler algorithm.
"""

from __future__ import annotations

import sys
from collections import Counter
from importlib.metadata import distribution
from pathlib import Path

import numpy as np
from lxml import etree
from rich.console import Console
from rich.table import Table

from robots_core import BaseRobotModel, UrdfRobotModel, load_robot_model
from robots_core.errors import RobotsError
from robots_core.pose import rotation_vector
from robots_core.robot_model.urdf.urdf_tree import MOVING_JOINTS, LinkTree, link_of

PACKAGE = 'example-robot-data'
ROBOTS = 'cmeel.prefix/share/example-robot-data/robots'
POSTURES = 10
STEP = 1e-5  # rad (m)
# Products of a few dozen rotations, and central differences of motions of some metres.
EXACT, DIFFERENCE = 1e-12, 1e-7


class BrokenLawError(Exception):
    """A robot loaded, and is wrong."""


def check(name: str, deviation: float, allowed: float) -> None:
    if not deviation <= allowed:
        raise BrokenLawError(f'{name}: off by {deviation:.3g}, allowed is {allowed:.3g}')


def check_laws(robot: BaseRobotModel) -> None:
    """Raise BrokenLawError unless the robot keeps the laws."""
    n, axes = robot.num_axes, robot.axes_data
    low, high = np.maximum(axes.lower, -np.pi), np.minimum(axes.upper, np.pi)
    rng = np.random.default_rng(3)
    for q in (robot.home, *rng.uniform(low, high, (POSTURES, n))):
        r, T = robot.direct_kinematics(q)
        check('orientation', float(np.abs(T @ T.T - np.eye(3)).max()), EXACT)
        check('handedness', abs(float(np.linalg.det(T)) - 1.0), EXACT)
        J = robot.jacobian(q)
        for unit, column in zip(np.eye(n), J.T, strict=True):
            before, after = (robot.direct_kinematics(q + way * unit) for way in (-STEP, STEP))
            moved = np.concatenate([after[0] - before[0], rotation_vector(after[1] @ before[1].T)])
            scale = 1.0 + float(np.linalg.norm(r))
            check('Jacobian', float(np.abs(moved / (2.0 * STEP) - column).max()), DIFFERENCE * scale)
        q_dot, q_ddot = rng.uniform(-1.0, 1.0, (2, n))
        tau, M, _ = robot.rigid_dynamics(q, q_dot, q_ddot)
        scale = 1.0 + float(np.abs(M).max())
        check('symmetry of the mass matrix', float(np.abs(M - M.T).max()), EXACT * scale)
        least = float(np.linalg.eigvalsh(M).min())
        if has_inertia(robot):
            check('lowest eigenvalue of the mass matrix, below zero', -least, -np.finfo(float).tiny)
        reference = robot.rigid_dynamics_model.torques(q, q_dot, q_ddot)
        scale = 1.0 + float(np.abs(reference).max())
        check('torques', float(np.abs(tau - reference).max()), EXACT * scale)


def has_inertia(robot: BaseRobotModel) -> bool:
    """Whether every body that an axis moves has a mass and an inertia."""
    model = robot.rigid_dynamics_model
    return bool((model.masses[1:] > 0.0).all() and (np.linalg.eigvalsh(model.inertias[1:]) > 0.0).all())


def ends(urdf: Path) -> list[str]:
    """The last link of every way from the base with axes of its own, before joints that mimic others."""
    root = etree.parse(urdf).getroot()
    base = LinkTree(root).base(None)
    for joint in root.findall('joint'):
        if joint.find('mimic') is not None:
            root.remove(joint)
    tree = LinkTree(root)
    moving = [joint for joint in root.findall('joint') if joint.get('type') in MOVING_JOINTS]
    carriers = {link_of(joint, 'parent') for joint in moving}
    behind = {link_of(joint, 'child') for joint in moving} & tree.below(base)[0]
    return sorted(link for link in behind if not tree.below(link)[0] & carriers)


def load_chains(urdf: Path) -> tuple[Counter[int], list[str]]:
    """How many chains of how many axes load, and the reasons of the others."""
    loaded: Counter[int] = Counter()
    refused = []
    for tip in ends(urdf):
        try:
            robot = UrdfRobotModel(urdf, tip=tip, shapes_on_demand=True)
            check_laws(robot)
        except RobotsError as error:
            refused.append(f'?tip={tip}: {error}')
        else:
            loaded[robot.num_axes] += 1
    return loaded, refused


def outcome(urdf: Path) -> tuple[str, str]:
    """Axes, and what became of a URDF."""
    try:
        robot = load_robot_model(f'urdf:{urdf}')
    except RobotsError as error:
        refusal = str(error)
    else:
        check_laws(robot)
        return str(robot.num_axes), 'loaded' if has_inertia(robot) else 'loaded; bodies without inertia'
    try:
        loaded, refused = load_chains(urdf)
    except RobotsError:
        return '', refusal  # no tree of links at all
    chosen = ', '.join(f'{count} of {axes} axes' for axes, count in sorted(loaded.items()))
    lines = [refusal, *([f'by ?tip= load {chosen}'] if chosen else []), *refused]
    return '', '\n'.join(lines)


def main() -> None:
    folder = Path(str(distribution(PACKAGE).locate_file(ROBOTS)))
    urdfs = sorted(folder.rglob('*.urdf'))
    if not urdfs:
        sys.exit(f'no URDF below {folder}')
    table = Table('robot', 'axes', 'outcome', title=f'{PACKAGE} {distribution(PACKAGE).version}')
    whole, broken = 0, []
    for urdf in urdfs:
        name = str(urdf.relative_to(folder))
        try:
            axes, text = outcome(urdf)
        except Exception as error:  # noqa: BLE001  # whatever it is, the others are tried too
            broken.append(name)
            axes, text = '', f'ERROR {type(error).__name__}: {error}'
        whole += bool(axes)
        table.add_row(name, axes, text.replace(f'{folder}/', ''))
    Console(width=180).print(table)
    print(
        f'{whole} of {len(urdfs)} load as they are, {len(urdfs) - whole - len(broken)} are refused by reason'
    )
    if broken:
        sys.exit(f'{len(broken)} end in an error: {", ".join(broken)}')


if __name__ == '__main__':
    main()
