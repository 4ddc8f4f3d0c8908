"""The cabin: where it hangs on the robot, how far it may move, and how its motion is cued."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

import numpy as np

from robots_core import Pose
from robots_core.blocks import CabinEnvelope, CueingStep, MotionCueing, VehicleMotion, WashoutSettings
from robots_core.validation import Array

ROBOT: Final = 'kuka_kr500_r2830'
RATE: Final = 250.0  # Hz, of the poses: that of the robot's references, so that they are hardly extrapolated

# The flange holds the cabin by its roof and points down: the wrist then yaws it by A6, pitches it by A5 and
# rolls it by A4, which lets all three be fastest.
HEAD_IN_FLANGE: Final = Pose(np.array([0.0, 0.0, 0.8]), np.diag([-1.0, 1.0, -1.0]))
FLANGE_IN_MIDDLE: Final = Pose(np.array([1.6, 0.0, 1.6]), HEAD_IN_FLANGE.T.T)
"""Of the robot, where the cabin stands level: with its axes those of the robot's base."""
HEAD_IN_MIDDLE: Final = FLANGE_IN_MIDDLE @ HEAD_IN_FLANGE

ENVELOPE: Final = CabinEnvelope(
    reach=(0.4, 1.0, 0.2, 0.18, 0.18, 0.25),
    velocity=(0.8, 1.2, 0.5, 0.3, 0.3, 0.6),
    acceleration=(1.0, 1.5, 0.5, 0.4, 0.4, 0.6),
)
SETTINGS: Final = WashoutSettings(
    force_scale=(0.25, 0.2, 0.25),
    rate_scale=(0.2, 0.25, 0.2),
    translation_frequency=(0.9, 0.3, 2.5),
    translation_damping=(1.0, 0.7, 1.0),
    return_frequency=(0.2, 0.1, 0.5),
    rotation_frequency=(0.5, 0.5, 0.5),
    tilt_frequency=(2.0, 0.8),
)
"""The robot turns about its first axis, so that it has most room to the side."""


def cue(motions: Iterable[VehicleMotion | None], settings: WashoutSettings = SETTINGS) -> list[CueingStep]:
    """What the cabin does for the motion of a vehicle, a sample each 1/`RATE`; None where one is missing."""
    cueing = MotionCueing(settings, ENVELOPE, 1.0 / RATE)
    return [cueing.step(motion) for motion in motions]


def flange(step: CueingStep) -> Pose:
    """Pose of the robot's flange in its base, for the motion of the cabin."""
    return HEAD_IN_MIDDLE @ step.pose @ HEAD_IN_FLANGE.inverse()


def flange_twist(step: CueingStep) -> Array:
    """Velocity and angular velocity of the flange, (6,) m/s and rad/s, in the robot's base."""
    velocity, angular_velocity = step.twist.reshape(2, 3) @ HEAD_IN_MIDDLE.T.T
    arm = flange(step).T @ -HEAD_IN_FLANGE.r  # from the head to the flange
    return np.concatenate([velocity + np.cross(angular_velocity, arm), angular_velocity])


def head(flange_pose: Pose) -> Pose:
    """Pose of the person's head from the middle of the cabin's motion, for a flange of the robot."""
    return HEAD_IN_MIDDLE.inverse() @ flange_pose @ HEAD_IN_FLANGE
