"""The motion of a recorded bag, for the payload that moved it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from robots_controller.recording.bag_file import read_bag
from robots_controller.recording.joint_rows import joint_rows
from robots_controller.recording.message_rows import NANOSECONDS
from robots_controller.recording.recorded_robot import recorded_robot
from robots_core.blocks.calibration.motion_samples import MotionSamples
from robots_core.errors import BagError
from robots_core.robot_model.base_robot_model import BaseRobotModel


def recorded_motion(
    path: Path, *, robot: str = '', namespace: str = '/'
) -> tuple[BaseRobotModel, MotionSamples]:
    """The robot and the motion of a bag.

    Args:
        path: Of the bag.
        robot: Name of the robot; '' for the one that the bag names.
        namespace: Of the recorded cell.

    Raises:
        RobotsError: it is no bag, names no robot, or has no torques.
    """
    bag, prefix = read_bag(path), namespace.rstrip('/') + '/'
    model = recorded_robot(bag, prefix, robot)
    rows = joint_rows(bag, f'{prefix}joint_states', model)
    q, _, tau = rows.values
    if q is None or tau is None:
        raise BagError(
            f'{path} has no torques (effort) in {prefix}joint_states; simulated drives of the level '
            'rigid_body measure them'
        )
    stamp, first = np.unique(rows.stamp, return_index=True)
    return model, MotionSamples.from_recording((stamp - stamp[0]) / NANOSECONDS, q[first], tau[first])
