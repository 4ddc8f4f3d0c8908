"""What the person in the cabin felt in a recorded run of the program, next to what was wanted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from robots_controller.recording.bag_file import Bag, read_bag
from robots_controller.recording.joint_rows import joint_rows, seconds
from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.blocks import Cabin, Cockpit, CueingStep, VehicleMotion, read_cabin
from robots_core.blocks.following.following_methods import RATE
from robots_core.blocks.motion_cueing.vehicle_inputs import INPUTS, read_input
from robots_core.errors import RobotsError
from robots_core.validation import Array

POSE: Final = '/reference_pose'
NANOSECONDS: Final = 1_000_000_000


@dataclass(frozen=True, eq=False)
class RecordedCabin:
    """The guided part of a run. Times are in s since the first pose of the reference.

    Attributes:
        robot: It.
        cabin: What it carries.
        time: Of the cueing, (k,).
        steps: What the cueing asks for, k.
        reference_time: Of the references to the drives, (m,).
        reference: Their joint positions, velocities and accelerations, (3, m, n).
        drive_time: Of the feedback, (l,).
        drives: Joint positions and velocities by the drives, (2, l, n).
    """

    robot: BaseRobotModel
    cabin: Cabin
    time: Array
    steps: list[CueingStep]
    reference_time: Array
    reference: Array
    drive_time: Array
    drives: Array

    def ways(self) -> Array:
        """Surge, sway, heave (m), roll, pitch, yaw (rad) by the drives, (l, 6)."""
        found = []
        for q in self.drives[0]:
            place = self.cabin.head_at(self.robot.pose(q))
            found.append([*place.r, *place.angles('zyx')[::-1]])
        return np.array(found)

    def felt(self) -> list[VehicleMotion]:
        """What the person felt by the drives, l."""
        head = self.cabin.head
        turned, velocity, rotation = [], [], []
        for q, q_dot in zip(*self.drives, strict=True):
            _, T = self.robot.direct_kinematics(q)
            twist = self.robot.jacobian(q) @ q_dot
            turned.append(T @ head.T)
            velocity.append(twist[:3] + np.cross(twist[3:], T @ head.r))
            rotation.append(turned[-1].T @ twist[3:])
        acceleration = np.gradient(np.array(velocity), self.drive_time, axis=0)
        return [VehicleMotion.of_body(*row) for row in zip(turned, acceleration, rotation, strict=True)]

    def tracking(self) -> tuple[Array, Array]:
        """Distance (l,) m and angle (l,) rad of the head by the drives to what the cueing asks for."""
        columns = np.array([step.cabin[0] for step in self.steps]).T
        wanted = np.column_stack([np.interp(self.drive_time, self.time, column) for column in columns])
        errors = []
        for row, q in zip(wanted, self.drives[0], strict=True):
            there = Pose.from_angles(row[:3], row[:2:-1])
            errors.append(self.cabin.head_at(self.robot.pose(q)).distance_to(there))
        position, angle = np.array(errors).T
        return position, angle


def read_recorded_cabin(run: Path | str, *, robot: str, cabin: Path | str) -> RecordedCabin:
    """Read a run.

    Args:
        run: Bag of `simulate` or `cell`.
        robot: The robot's name.
        cabin: Cabin of the run (YAML).

    Raises:
        RobotsError: not readable, or the robot was not guided.
    """
    model, bag, carried = load_robot_model(robot), read_bag(run), read_cabin(cabin)
    poses = [message for _, message in bag.deserialized([POSE])[POSE]]
    if not poses:
        raise RobotsError(f'{run} holds no {POSE}: the robot was not guided')
    stamps = [seconds(message.header.stamp) for message in poses]
    steps = _cued(bag, carried, stamps)
    start, end = stamps[0], len(steps) / RATE
    reference, drives = (joint_rows(bag, topic, model) for topic in ('/joint_reference', '/joint_states'))
    rows = []
    for found, count in ((reference, 3), (drives, 2)):
        time = found.stamp / NANOSECONDS - start
        guided = (time >= 0.0) & (time <= end)
        rows.append(
            (
                time[guided],
                np.array([values[guided] for values in found.values[:count] if values is not None]),
            )
        )
    return RecordedCabin(model, carried, np.arange(len(steps)) / RATE, steps, *rows[0], *rows[1])


def _cued(bag: Bag, cabin: Cabin, stamps: Sequence[float]) -> list[CueingStep]:
    """What the recorded inputs of a cabin are cued to, for the poses with these stamps."""
    found = bag.deserialized([f'/{topic}' for topic in INPUTS])
    inputs = sorted(
        (
            (seconds(message.header.stamp), topic, message)
            for topic in INPUTS
            for _, message in found[f'/{topic}']
        ),
        key=lambda one: one[0],
    )
    cockpit, steps = Cockpit(cabin, 1.0 / RATE), []
    for stamp in stamps:
        while inputs and inputs[0][0] <= stamp:
            _, topic, message = inputs.pop(0)
            cockpit.take(read_input(topic, message))
        steps.append(cockpit.step())
    return steps


def reasons(steps: Sequence[CueingStep]) -> dict[str, int]:
    """What was limited and in how many steps, each kind by its first case."""
    found: dict[str, tuple[str, int]] = {}
    for step in steps:
        for limit in step.limits:
            kind = ' '.join(word for word in limit.split() if not any(c.isdigit() for c in word))
            first, count = found.get(kind, (limit, 0))
            found[kind] = (first, count + 1)
    return dict(found.values())
