"""Collision checks next to fcl's own broad phase and to Pinocchio, posture by posture.

Run by `make benchmark-dynamics`. All take turns over the same postures and the same convex bodies, and check
the same pairs; their contacts are compared before the clock starts.

- ours, fcl and coal: `CollisionDetection.in_contact`, checks of its input and kinematics included.
- fcl manager: python-fcl's `DynamicAABBTreeCollisionManager` with a callback per pair; our kinematics.
- Pinocchio: `computeCollisions`, which stops at the first contact, with coal's shapes and its kinematics.

Distances are those of `CollisionDetection.distance`, with nearest points that are proven; Pinocchio's
`computeDistances` has neither. The path is one of the robot's largest motions in joint space that is free.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import fcl
import numpy as np
from pinocchio_bodies import PinocchioBodies
from rich.console import Console
from rich.table import Table

from robots_core import BaseRobotModel, load_robot_model
from robots_core.blocks import CollisionDetection, JointPath, Scene, read_scene
from robots_core.blocks.collision.engine import FclEngine

SCENE = Path(__file__).parents[2] / 'programs' / 'scenes' / 'car_frame.yaml'
CELLS = (('kuka_kr210_r2700', SCENE), ('kuka_kr210_r2700', None), ('ur5e', None), ('bello_bot', None))
SAMPLES = 100
MARGIN = 0.005  # m

Check = Callable[[np.ndarray], Any]


def manager_check(detection: CollisionDetection) -> Check:
    """python-fcl's broad phase over the same bodies, asked for the same pairs."""
    table = detection._set
    wanted = {(int(a), int(b)) for a, b in zip(table.first, table.second, strict=True)}
    # A callback gets fresh objects: who they are is known by the geometries of their contacts.
    shapes = [FclEngine.geometry(solid) for solid in table.solids]
    number = {id(shape): k for k, shape in enumerate(shapes)}
    objects = [fcl.CollisionObject(shape) for shape in shapes]
    manager = fcl.DynamicAABBTreeCollisionManager()
    manager.registerObjects(objects)
    manager.setup()
    request = fcl.CollisionRequest()

    def callback(one: Any, other: Any, found: list[bool]) -> bool:
        result = fcl.CollisionResult()
        if fcl.collide(one, other, request, result):
            contact = result.contacts[0]
            pair = number[id(contact.o1)], number[id(contact.o2)]
            if pair in wanted or pair[::-1] in wanted:
                found.append(True)
                return True
        return False

    def check(q: np.ndarray) -> bool:
        table.place(q)
        for item, R, t in zip(objects, table.R, table.t, strict=True):
            item.setRotation(R)
            item.setTranslation(t)
        manager.update()
        found: list[bool] = []
        manager.collide(found, callback)
        return bool(found)

    return check


def checks(robot: BaseRobotModel, scene: Scene) -> tuple[dict[str, Check], dict[str, Check]]:
    ours = {engine: CollisionDetection(robot, scene=scene, engine=engine) for engine in ('fcl', 'coal')}
    bare = PinocchioBodies.of(robot, scene)
    contact: dict[str, Check] = {f'ours, {engine}': item.in_contact for engine, item in ours.items()}
    contact['fcl manager'] = manager_check(CollisionDetection(robot, scene=scene))
    contact['Pinocchio'] = bare.in_contact
    distance: dict[str, Check] = {f'ours, {engine}': item.distance for engine, item in ours.items()}
    distance['Pinocchio'] = bare.closest_pair
    return contact, distance


def rates(calls: dict[str, Check], postures: Sequence[np.ndarray], rounds: int) -> dict[str, float]:
    """Calls per second of each, medians of turns."""
    times: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(rounds):
        for name, call in calls.items():
            start = time.thread_time()
            for q in postures:
                call(q)
            times[name].append((time.thread_time() - start) / len(postures))
    return {name: 1.0 / float(np.median(values)) for name, values in times.items()}


def free_path(
    robot: BaseRobotModel, detection: CollisionDetection, postures: Sequence[np.ndarray]
) -> JointPath:
    """The longest of the straight motions from home to some postures that keeps the margin."""
    ways = (JointPath.straight(robot.home, q) for q in postures if not detection.in_contact(q))
    free = [way for way in ways if detection.first_approach(way, margin=MARGIN) is None]
    return max(free, key=lambda way: float(np.abs(way.position[1] - way.position[0]).sum()))


def milliseconds(call: Callable[[], Any], rounds: int) -> float:
    times = []
    for _ in range(rounds):
        start = time.thread_time()
        call()
        times.append(time.thread_time() - start)
    return 1e3 * float(np.median(times))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--rounds', type=int, default=11, help='turns that each takes')
    rounds = parser.parse_args().rounds
    contact_table = Table('robot', 'pairs', title=f'Contact checks per second, medians of {rounds} turns')
    distance_table = Table('robot', 'pairs', title='Distances per second; whole paths, ms')
    for name in ('ours, fcl', 'ours, coal', 'fcl manager', 'Pinocchio'):
        contact_table.add_column(name, justify='right')
    for name in ('ours, fcl', 'ours, coal', 'Pinocchio', 'path kept free', 'closest approach'):
        distance_table.add_column(name, justify='right')
    for name, file in CELLS:
        robot = load_robot_model(name)
        scene = read_scene(file) if file else Scene()
        axes = robot.axes_data
        postures = list(np.random.default_rng(0).uniform(axes.lower, axes.upper, (SAMPLES, axes.num_axes)))
        contact, distance = checks(robot, scene)
        for q in postures:
            answers = {label: bool(check(q)) for label, check in contact.items()}
            assert len(set(answers.values())) == 1, f'{name}: {answers} at {q}'
        detection = CollisionDetection(robot, scene=scene)
        path = free_path(robot, detection, postures)
        title = f'{name}, {file.stem}' if file else f'{name}, alone'
        pairs = str(detection._set.first.size)
        found = rates(contact, postures, rounds)
        contact_table.add_row(title, pairs, *(f'{rate:.0f}' for rate in found.values()))
        found = rates(distance, postures, rounds)
        distance_table.add_row(
            title,
            pairs,
            *(f'{rate:.0f}' for rate in found.values()),
            f'{milliseconds(lambda d=detection, p=path: d.first_approach(p, margin=MARGIN), rounds):.2f}',
            f'{milliseconds(lambda d=detection, p=path: d.closest_approach(p), rounds):.1f}',
        )
    Console(width=150).print(contact_table, distance_table)


if __name__ == '__main__':
    main()
