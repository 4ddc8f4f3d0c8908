"""Where chaser and target were in a recorded run of the program, and their momentum."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import numpy as np

from robots_controller.recording.bag_file import read_bag
from robots_controller.recording.joint_rows import joint_rows
from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.blocks.floating_base.rendezvous import PARTS
from robots_core.errors import RobotsError
from robots_core.orientation import rotation_vector
from robots_core.validation import Array

ROBOT: Final = 'debris_arm?gravity=0,0,0'
TOPICS: Final = ('/base_pose', '/target_pose', '/momentum', '/digital_inputs', '/grasp_status')
HELD, REFUSED, AT_REST = 0, 1, 2
"""Digital inputs, as the program has them."""


@dataclass(frozen=True, eq=False)
class RecordedBodies:
    """A run. Times are in s since its first pose.

    Attributes:
        robot: The arm.
        time: Of the poses and of the momentum, (k,).
        base: Poses of the chaser's base, k.
        target: Poses of the target, k.
        joints: Joint positions, (k, n).
        momentum: Of the `PARTS`, (k, 3, 6): N s, and N m s about the world's origin.
        inputs: When the digital inputs 1 to 3 first were on; none for one that never was.
        report: What became of the grasp.
    """

    robot: BaseRobotModel
    time: Array
    base: Sequence[Pose]
    target: Sequence[Pose]
    joints: Array
    momentum: Array
    inputs: Sequence[float | None]
    report: str

    @property
    def drift(self) -> Array:
        """Change of the total momentum since the start, (k, 6)."""
        total = self.momentum.sum(axis=1)
        return np.asarray(total - total[0])

    def tool(self, k: int) -> Pose:
        """Pose of the gripper in the world."""
        return self.base[k] @ self.robot.pose(self.joints[k])

    def rates(self, poses: Sequence[Pose]) -> Array:
        """Angular velocity between poses, (k - 1, 3) rad/s, world axes."""
        turned = [rotation_vector(after.T @ before.T.T) for before, after in pairwise(poses)]
        return np.asarray(np.array(turned) / np.diff(self.time)[:, None])


def read_bodies(run: Path | str) -> RecordedBodies:
    """Read a run.

    Args:
        run: Bag of `simulate` or `cell`.

    Raises:
        RobotsError: not readable, or of a robot that stands on the ground.
    """
    robot, bag = load_robot_model(ROBOT), read_bag(run)
    found = bag.deserialized(TOPICS)
    if not found['/base_pose']:
        raise RobotsError(f'{run} holds no /base_pose: its robot was not in orbit')
    count = min(len(found[topic]) for topic in ('/base_pose', '/target_pose', '/momentum'))
    start = found['/base_pose'][0][0]
    stamps = np.array([stamp for stamp, _ in found['/base_pose'][:count]], np.int64)
    states = joint_rows(bag, '/joint_states', robot)
    at = np.clip(np.searchsorted(states.stamp, stamps), 0, len(states.stamp) - 1)
    position = states.values[0]
    assert position is not None
    momentum = [np.array(message.data).reshape(len(PARTS), 6) for _, message in found['/momentum'][:count]]
    inputs = [
        next((1e-9 * (stamp - start) for stamp, message in found['/digital_inputs'] if message.data[i]), None)
        for i in range(3)
    ]
    return RecordedBodies(
        robot,
        np.asarray(1e-9 * (stamps - start), np.float64),
        [_pose(message) for _, message in found['/base_pose'][:count]],
        [_pose(message) for _, message in found['/target_pose'][:count]],
        position[at],
        np.array(momentum),
        inputs,
        found['/grasp_status'][-1][1].message,
    )


def describe(bodies: RecordedBodies) -> list[str]:
    """Figures of the run, in lines."""
    rates = [
        np.degrees(np.linalg.norm(bodies.rates(poses), axis=1)) for poses in (bodies.base, bodies.target)
    ]
    turned = np.degrees(bodies.base[-1].distance_to(bodies.base[0])[1])
    lines = [bodies.report or 'nothing was grasped']
    for name, index in (('grasped', HELD), ('at rest', AT_REST)):
        time = bodies.inputs[index]
        lines.append(f'{name}: never' if time is None else f'{name} after {time:.1f} s')
    lines.append(f'the chaser turned by {turned:.1f} degrees, at most at {rates[0].max():.2f} degrees/s')
    ends = ', '.join(f'{name} {rate[-1]:.4f}' for name, rate in zip(PARTS, rates, strict=False))
    lines.append(f'angular velocity at the end, degrees/s: {ends}')
    linear, angular = (
        np.linalg.norm(bodies.drift[:, part], axis=1).max() for part in (slice(3), slice(3, 6))
    )
    lines.append(f'total momentum changed by at most {linear:.1e} N s and {angular:.1e} N m s')
    return lines


def _pose(message: Any) -> Pose:
    p, o = message.pose.position, message.pose.orientation
    return Pose.from_quaternion([p.x, p.y, p.z], [o.x, o.y, o.z, o.w])
