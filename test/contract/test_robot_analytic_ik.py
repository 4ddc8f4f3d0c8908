"""Every robot with a closed form: its postures reach the pose, none is lost, at singularities too."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from scipy.optimize import brentq

from robots_core import BaseRobotModel, Pose
from robots_core.blocks import AnalyticalInverseKinematic
from robots_core.errors import NoAnalyticInverseKinematicsError

POSES = 10_000
SINGULAR_POSTURES = 12
ACCURACY = 1e-9  # m and rad: what the suite promises
# Descriptions print angles with twelve digits, so axes miss their ideal places by up to some 1e-11 rad (m);
# a posture is known from its pose up to that, divided by the smallest singular value of the Jacobian.
PRINTED = 3e-11
# Where two branches meet, the pose depends on the posture's square: it is known to the root of PRINTED.
MERGED = 3.0 * np.sqrt(PRINTED)
OFFSETS = (0.0, 1e-12, -1e-12, 1e-10, 1e-9, 1e-8, -1e-8, 1e-7, 1e-6, -1e-6)  # rad from a singularity


@pytest.fixture
def analytic_robot(robot: BaseRobotModel) -> BaseRobotModel | None:
    """The robot, or None where it says why it has no closed form."""
    try:
        robot.inverse_kinematics_analytic(*robot.direct_kinematics(robot.home))
    except NoAnalyticInverseKinematicsError as error:
        assert robot.name in str(error)  # noqa: PT017  # saying so by name is the other valid answer
        with pytest.raises(NoAnalyticInverseKinematicsError):
            AnalyticalInverseKinematic(robot)
        return None
    return robot


def random_postures(robot: BaseRobotModel, count: int, seed: int) -> np.ndarray:
    axes = robot.axes_data
    lower, upper = axes.one_turn
    return np.random.default_rng(seed).uniform(lower, upper, (count, robot.num_axes))


def errors(robot: BaseRobotModel, solutions: np.ndarray, r: np.ndarray, T: np.ndarray) -> np.ndarray:
    """The larger of position error (m) and orientation error (rad) of each solution."""
    its_r, its_T = (np.array(parts) for parts in zip(*map(robot.direct_kinematics, solutions), strict=True))
    # Small angles: the Frobenius norm of the difference is the angle times the root of 2.
    turned = np.linalg.norm(its_T - T, axis=(1, 2)) / np.sqrt(2.0)
    return np.maximum(np.linalg.norm(its_r - r, axis=1), turned)


def distances_modulo_turns(robot: BaseRobotModel, solutions: np.ndarray, q: np.ndarray) -> np.ndarray:
    difference = np.abs(solutions - q)
    turns = np.where(robot.axes_data.prismatic, 0.0, 2.0 * np.pi * np.round(difference / (2.0 * np.pi)))
    return np.abs(difference - turns).max(axis=1)


def knowable(robot: BaseRobotModel, q: np.ndarray) -> float:
    """How well a pose determines the joint positions that it was computed from, rad."""
    smallest = float(np.linalg.svd(robot.jacobian(q), compute_uv=False)[-1])
    return PRINTED / max(smallest, 1e-12)


def test_every_posture_is_found_and_reaches_its_pose(analytic_robot: BaseRobotModel | None):
    if (robot := analytic_robot) is None:
        return
    postures = random_postures(robot, POSES, seed=5)
    poses = [robot.direct_kinematics(q) for q in postures]
    found = [robot.inverse_kinematics_analytic(r, T) for r, T in poses]
    counts = np.array([len(solutions) for solutions in found])
    assert (counts > 0).all(), postures[counts == 0]
    solutions, number = np.vstack(found), np.repeat(np.arange(POSES), counts)
    outside = (solutions < robot.axes_data.lower) | (solutions > robot.axes_data.upper)
    assert not outside.any(), postures[number[outside.any(axis=1)]]
    r, T = (np.array(parts)[number] for parts in zip(*poses, strict=True))
    missed = errors(robot, solutions, r, T) >= ACCURACY
    assert not missed.any(), postures[number[missed]]
    distances = distances_modulo_turns(robot, solutions, postures[number])
    nearest = np.minimum.reduceat(distances, np.cumsum(counts) - counts)
    for q, distance in zip(postures[nearest >= 1e-9], nearest[nearest >= 1e-9], strict=True):
        assert distance < knowable(robot, q), q


def singular_postures(robot: BaseRobotModel) -> Iterator[tuple[int, np.ndarray]]:
    """Postures where the determinant of the Jacobian changes its sign along one axis, and that axis."""
    axes = robot.axes_data
    lower, upper = axes.one_turn
    for start in random_postures(robot, SINGULAR_POSTURES, seed=6):
        for axis in range(1, robot.num_axes - 1):

            def determinant(value: float, start: np.ndarray = start, axis: int = axis) -> float:
                q = start.copy()
                q[axis] = value
                return float(np.linalg.det(robot.jacobian(q)))

            grid = np.linspace(lower[axis], upper[axis], 30)
            values = [determinant(value) for value in grid]
            for index in range(len(grid) - 1):
                if values[index] * values[index + 1] < 0.0:
                    q = start.copy()
                    q[axis] = brentq(determinant, grid[index], grid[index + 1], xtol=1e-15)
                    yield axis, q


@pytest.mark.filterwarnings('error')
def test_singular_poses_and_their_neighbours_are_reached(analytic_robot: BaseRobotModel | None):
    if (robot := analytic_robot) is None:
        return
    axes = robot.axes_data
    kinds = set()
    for axis, singular in singular_postures(robot):
        kinds.add(axis)
        for offset in OFFSETS:
            q = singular.copy()
            q[axis] = np.clip(q[axis] + offset, axes.lower[axis], axes.upper[axis])
            r, T = robot.direct_kinematics(q)
            for solutions in (
                robot.inverse_kinematics_analytic(r, T),
                robot.inverse_kinematics_analytic(r, T, q_near=q),
            ):
                assert len(solutions) > 0, (q, offset)
                assert np.isfinite(solutions).all(), (q, offset)
                assert errors(robot, solutions, r, T).max() < ACCURACY, (q, offset)
    assert len(kinds) >= 2, f'only axes {kinds} make {robot.name} singular'


def test_postures_beside_singularities_are_found(analytic_robot: BaseRobotModel | None):
    if (robot := analytic_robot) is None:
        return
    for axis, singular in singular_postures(robot):
        for offset in (-1e-6, 1e-6):
            q = singular.copy()
            q[axis] = np.clip(q[axis] + offset, robot.axes_data.lower[axis], robot.axes_data.upper[axis])
            solutions = robot.inverse_kinematics_analytic(*robot.direct_kinematics(q), q_near=q)
            distance = np.abs(solutions - q).max(axis=1).min()
            assert distance < max(knowable(robot, q), MERGED), (q, offset)


def test_solve_returns_to_where_the_robot_stands(analytic_robot: BaseRobotModel | None):
    if (robot := analytic_robot) is None:
        return
    tool = Pose.from_angles([0.1, -0.2, 0.3], [0.4, 1.5, -2.0])
    block = AnalyticalInverseKinematic(robot, tool=tool)
    for q in random_postures(robot, 200, seed=8):
        pose = Pose(*robot.direct_kinematics(q)) @ tool
        solution = block.solve(pose, q)
        assert np.abs(solution - q).max() < max(knowable(robot, q), 1e-9), q
        for turned in block.solve_all(pose, turns=True)[:4]:
            robot.axes_data.check_position(turned)
            assert max(pose.distance_to(Pose(*robot.direct_kinematics(turned)) @ tool)) < ACCURACY
