"""What the person in the cabin felt in a recorded run of the program, next to what was wanted."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from motion_simulator.cabin import HEAD_IN_FLANGE, RATE, ROBOT, cue, head
from motion_simulator.references import POSE, recorded
from robots_controller.recording.bag_file import read_bag
from robots_controller.recording.joint_rows import joint_rows, seconds
from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.blocks import CueingStep, VehicleMotion
from robots_core.errors import RobotsError
from robots_core.validation import Array

NANOSECONDS: Final = 1_000_000_000


@dataclass(frozen=True, eq=False)
class RecordedCabin:
    """The guided part of a run. Times are in s since the first pose of the reference.

    Attributes:
        robot: It.
        time: Of the cueing, (k,).
        steps: What the cueing asks for, k.
        reference_time: Of the references to the drives, (m,).
        reference: Their joint positions, velocities and accelerations, (3, m, n).
        drive_time: Of the feedback, (l,).
        drives: Joint positions and velocities by the drives, (2, l, n).
    """

    robot: BaseRobotModel
    time: Array
    steps: list[CueingStep]
    reference_time: Array
    reference: Array
    drive_time: Array
    drives: Array

    def cabin(self) -> Array:
        """Surge, sway, heave (m), roll, pitch, yaw (rad) by the drives, (l, 6)."""
        found = []
        for q in self.drives[0]:
            place = head(Pose(*self.robot.direct_kinematics(q)))
            found.append([*place.r, *place.angles('zyx')[::-1]])
        return np.array(found)

    def felt(self) -> list[VehicleMotion]:
        """What the person felt by the drives, l."""
        turned, velocity, rotation = [], [], []
        for q, q_dot in zip(*self.drives, strict=True):
            _, T = self.robot.direct_kinematics(q)
            twist = self.robot.jacobian(q) @ q_dot
            turned.append(T @ HEAD_IN_FLANGE.T)
            velocity.append(twist[:3] + np.cross(twist[3:], T @ HEAD_IN_FLANGE.r))
            rotation.append(turned[-1].T @ twist[3:])
        acceleration = np.gradient(np.array(velocity), self.drive_time, axis=0)
        return [VehicleMotion.of_body(*row) for row in zip(turned, acceleration, rotation, strict=True)]

    def tracking(self) -> tuple[Array, Array]:
        """Distance (l,) m and angle (l,) rad of the head by the drives to what the cueing asks for."""
        wanted = np.array([step.cabin[0] for step in self.steps])
        errors = []
        for time, q in zip(self.drive_time, self.drives[0], strict=True):
            row = [np.interp(time, self.time, column) for column in wanted.T]
            there = Pose.from_angles(row[:3], row[:2:-1])
            errors.append(head(Pose(*self.robot.direct_kinematics(q))).distance_to(there))
        position, angle = np.array(errors).T
        return position, angle


def read_cabin(run: Path | str, references: Path | str) -> RecordedCabin:
    """Read a run.

    Args:
        run: Bag of `simulate` or `cell`.
        references: Bag that guided the robot, see `references`.

    Raises:
        RobotsError: not readable, or the robot was not guided.
    """
    robot, bag = load_robot_model(ROBOT), read_bag(run)
    poses = bag.deserialized([POSE])[POSE]
    if not poses:
        raise RobotsError(f'{run} holds no {POSE}: the robot was not guided')
    steps = cue(recorded(references).sampled())
    start = seconds(poses[0][1].header.stamp)
    end = len(steps) / RATE
    reference, drives = (joint_rows(bag, topic, robot) for topic in ('/joint_reference', '/joint_states'))
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
    return RecordedCabin(robot, np.arange(len(steps)) / RATE, steps, *rows[0], *rows[1])
