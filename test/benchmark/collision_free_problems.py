"""Problems of collision-free planning, made from seeds: shelf, bin, cage, cluttered table and car frame.

After the scenes of MotionBenchMaker (Chamzas et al. 2022), scaled to the reach of the arm: from one posture
to another, both free, with the tool inside or close to what stands around it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from robots_core import BaseRobotModel, Pose
from robots_core.blocks import CollisionDetection, Scene, SceneObject, read_scene
from robots_core.blocks.collision.scene import AttachedObject
from robots_core.blocks.inverse_kinematics.damped_least_squares import DampedLeastSquares
from robots_core.orientation import rotation_from_vector
from robots_core.robot_model.shapes import Box, Capsule, Cylinder

CAR: Final = Path(__file__).parents[2] / 'programs' / 'scenes' / 'car_frame.yaml'
MARGIN: Final = 0.005  # m
CLEARANCE: Final = 0.01  # m, of both ends
REACH: Final = {'franka_fr3': 0.85, 'ur5e': 0.85, 'kuka_kr210_r2700': 2.7}  # m
# The robots' shoulders are at this height, of the reach.
SHOULDER: Final = {'franka_fr3': 0.39, 'ur5e': 0.19, 'kuka_kr210_r2700': 0.25}
FORWARD: Final = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])  # tool along x
DOWN: Final = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
TRIES: Final = 60


@dataclass(frozen=True)
class Problem:
    """A motion to plan: joint positions (n,) of start and target, both free, rad."""

    scene: Scene
    start: np.ndarray
    target: np.ndarray


Rng = np.random.Generator
Places = Callable[[Rng], Pose]


def _box(name: str, size: tuple[float, ...], at: tuple[float, ...]) -> SceneObject:
    return SceneObject(name, Box(tuple(size)), Pose(np.array(at), np.eye(3)))


def _jittered(rng: Rng, pose: Pose, way: float, turn: float) -> Pose:
    r = pose.r + rng.uniform(-way, way, 3)
    return Pose(r, rotation_from_vector(rng.uniform(-turn, turn, 3)) @ pose.T)


def shelf(rng: Rng, height: float) -> tuple[list[SceneObject], Places, Places]:
    """Three boards between two sides; from one compartment to another."""
    x, depth, width, wall = rng.uniform(0.55, 0.65), 0.35, rng.uniform(0.7, 0.9), 0.02
    boards = height - 0.35 + np.arange(4) * rng.uniform(0.32, 0.36)
    middle = 0.5 * (boards[0] + boards[-1])
    items = [
        _box(f'board_{k}', (depth, width, wall), (x + 0.5 * depth, 0.0, z)) for k, z in enumerate(boards)
    ]
    tall = boards[-1] - boards[0] + wall
    items += [
        _box(f'side_{side}', (depth, wall, tall), (x + 0.5 * depth, sign * 0.5 * width, middle))
        for side, sign in (('left', 1.0), ('right', -1.0))
    ]
    items.append(_box('back', (wall, width, tall), (x + depth, 0.0, middle)))

    def inside(level: int) -> Places:
        def place(rng: Rng) -> Pose:
            z = 0.5 * (boards[level] + boards[level + 1])
            at = (x + rng.uniform(0.02, 0.12), rng.uniform(-0.25, 0.25) * width, z)
            return _jittered(rng, Pose(np.array(at), FORWARD), 0.02, 0.15)

        return place

    first, last = rng.permutation(3)[:2]
    return items, inside(int(first)), inside(int(last))


def bin_(rng: Rng, height: float) -> tuple[list[SceneObject], Places, Places]:
    """A box that is open above; from beside it to its bottom."""
    size, deep, wall = rng.uniform(0.30, 0.38), rng.uniform(0.25, 0.35), 0.015
    x, y, floor = rng.uniform(0.48, 0.55), rng.uniform(-0.2, 0.2), height - 0.35
    items = [_box('bottom', (size, size, wall), (x, y, floor))]
    for k, (dx, dy) in enumerate(((1, 0), (-1, 0), (0, 1), (0, -1))):
        sides = (wall, size, deep) if dx else (size, wall, deep)
        items.append(_box(f'wall_{k}', sides, (x + 0.5 * dx * size, y + 0.5 * dy * size, floor + 0.5 * deep)))

    def inside(rng: Rng) -> Pose:
        at = np.array([x, y, floor + rng.uniform(0.10, 0.18)])
        return _jittered(rng, Pose(at, DOWN), 0.03, 0.2)

    def beside(rng: Rng) -> Pose:
        side = rng.choice([-1.0, 1.0])
        at = np.array([x - 0.1, y + side * (0.5 * size + 0.15), floor + 0.5 * deep])
        return _jittered(rng, Pose(at, DOWN), 0.04, 0.3)

    return items, beside, inside


def cage(rng: Rng, height: float) -> tuple[list[SceneObject], Places, Places]:
    """A crate of bars; from in front of it to its inside, past the bars."""
    x, size, bar = rng.uniform(0.42, 0.48), rng.uniform(0.42, 0.48), 0.025
    low, y = height - 0.25, rng.uniform(-0.1, 0.1)
    items = []
    for k, (dx, dy) in enumerate(((0, -1), (0, 0), (0, 1), (1, -1), (1, 0), (1, 1))):
        if dx or dy:
            at = (x + dx * size, y + 0.5 * dy * size, low + 0.5 * size)
            items.append(_box(f'post_{k}', (bar, bar, size), at))
    for k, z in enumerate((low, low + size)):
        items += [_box(f'rail_{k}{dx}', (bar, size, bar), (x + dx * size, y, z)) for dx in range(2)]
        for dy in (-1.0, 0.0, 1.0):
            at = (x + 0.5 * size, y + 0.5 * dy * size, z)
            items.append(_box(f'beam_{k}{dy:.0f}', (size, bar, bar), at))
    items.append(_box('beside_low', (size, bar, bar), (x + 0.5 * size, y - 0.5 * size, low + 0.5 * size)))
    items.append(_box('beside_high', (size, bar, bar), (x + 0.5 * size, y + 0.5 * size, low + 0.5 * size)))

    def inside(rng: Rng) -> Pose:
        at = np.array([x + rng.uniform(0.1, 0.2), y, low + 0.5 * size])
        return _jittered(rng, Pose(at, FORWARD), 0.05, 0.2)

    def outside(rng: Rng) -> Pose:
        at = np.array([x - 0.12, y + rng.choice([-1.0, 1.0]) * (0.5 * size + 0.15), low + 0.4 * size])
        return _jittered(rng, Pose(at, FORWARD), 0.06, 0.4)

    return items, outside, inside


def table(rng: Rng, height: float) -> tuple[list[SceneObject], Places, Places]:
    """A table with a dozen objects; from one place between them to another."""
    top = height - 0.35
    items = [_box('table', (0.7, 1.2, 0.04), (0.65, 0.0, top - 0.02))]
    spots: list[np.ndarray] = []
    for _ in range(200):
        at = np.array([rng.uniform(0.38, 0.85), rng.uniform(-0.5, 0.5)])
        if all(np.linalg.norm(at - other) > 0.15 for other in spots):
            spots.append(at)
    for k, at in enumerate(spots[2:14]):
        tall, wide = rng.uniform(0.12, 0.40), rng.uniform(0.03, 0.06)
        geometry = Cylinder(wide, tall) if k % 2 else Box((2.0 * wide, 2.0 * wide, tall))
        pose = Pose(np.array([*at, top + 0.5 * tall]), rotation_from_vector(np.array([0.0, 0.0, k * 0.5])))
        items.append(SceneObject(f'object_{k}', geometry, pose))

    def spot(index: int) -> Places:
        def place(rng: Rng) -> Pose:
            at = np.array([*spots[index], top + rng.uniform(0.12, 0.2)])
            return _jittered(rng, Pose(at, DOWN), 0.02, 0.3)

        return place

    return items, spot(0), spot(1)


def car_frame(rng: Rng, height: float) -> tuple[list[SceneObject], Places, Places]:
    """The frame of a car; from in front of one window to the inside behind another."""
    scale, x = 1.0 / 2.7, 0.02
    items = []
    for item in read_scene(CAR).objects:
        if item.name == 'floor':
            continue
        match item.geometry:
            case Box(size):
                geometry: Box | Capsule = Box(tuple(scale * value for value in size))
            case Capsule(radius, length):
                geometry = Capsule(scale * radius, scale * length)
        at = scale * item.pose.r + np.array([x - 0.18, 0.0, height - 0.36])
        items.append(SceneObject(item.name, geometry, Pose(at, item.pose.T)))

    def window(sign: float, inside: float) -> Places:
        def place(rng: Rng) -> Pose:
            at = np.array([0.58 + inside, sign * 0.2, height + 0.03])
            return _jittered(rng, Pose(at, FORWARD), 0.04, 0.25)

        return place

    side = rng.choice([-1.0, 1.0])
    return items, window(side, 0.06), window(-side, 0.12)


FAMILIES: Final = {'shelf': shelf, 'bin': bin_, 'cage': cage, 'table': table, 'car frame': car_frame}


def _scaled(item: SceneObject, reach: float) -> SceneObject:
    match item.geometry:
        case Box(size):
            geometry: Box | Capsule | Cylinder = Box(tuple(reach * value for value in size))
        case Capsule(radius, length):
            geometry = Capsule(reach * radius, reach * length)
        case Cylinder(radius, length):
            geometry = Cylinder(reach * radius, reach * length)
    return replace_geometry(item, geometry, Pose(reach * item.pose.r, item.pose.T))


def replace_geometry(item: SceneObject, geometry: Box | Capsule | Cylinder, pose: Pose) -> SceneObject:
    return replace(item, geometry=geometry, pose=pose)


def problems(robot: BaseRobotModel, family: str, count: int) -> Iterator[Problem]:
    """Problems of a family, the same for the same robot."""
    name = robot.name
    reach, seed = REACH[name], 0
    finger = AttachedObject(
        'finger', Cylinder(0.02 * reach, 0.1 * reach), Pose(np.array([0.0, 0.0, 0.06 * reach]), np.eye(3))
    )
    tool = Pose(np.array([0.0, 0.0, 0.11 * reach]), np.eye(3))
    while count > 0:
        seed += 1
        rng = np.random.default_rng([seed, list(FAMILIES).index(family)])
        items, *places = FAMILIES[family](rng, SHOULDER[name])
        scene = Scene(tuple(_scaled(item, reach) for item in items), (finger,))
        detection = CollisionDetection(robot, scene=scene)
        ends = [_free_posture(robot, detection, rng, place, tool, reach) for place in places]
        if ends[0] is not None and ends[1] is not None:
            count -= 1
            yield Problem(scene, ends[0], ends[1])


def _free_posture(  # noqa: PLR0917
    robot: BaseRobotModel,
    detection: CollisionDetection,
    rng: Rng,
    place: Places,
    tool: Pose,
    reach: float,
) -> np.ndarray | None:
    solver = DampedLeastSquares(robot)
    low, high = (np.clip(limit, -np.pi, np.pi) for limit in (robot.axes_data.lower, robot.axes_data.upper))
    for _ in range(TRIES):
        pose = place(rng)
        pose = Pose(reach * pose.r, pose.T) @ tool.inverse()
        seed = np.clip(robot.home + rng.uniform(-1.0, 1.0, robot.num_axes), low, high)
        found = solver.solve(pose, seed)
        q = found.q
        if not found.converged or (q < low).any() or (q > high).any():
            continue
        closest = detection.distance(q)
        if closest is None or closest.distance > CLEARANCE:
            return q
    return None
