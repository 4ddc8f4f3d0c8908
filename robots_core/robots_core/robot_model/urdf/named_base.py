"""A link of a URDF that is named as the base, and lies elsewhere."""

from __future__ import annotations

from typing import Final

import pinocchio as pin

from robots_core.base_frames import BASE_FRAME
from robots_core.pose import Pose
from robots_core.robot_model.urdf.substitutions import Substitutions

SAME: Final = 1e-6  # m, rad


def note_other_base(model: pin.Model, base: str, substitutions: Substitutions) -> None:
    """Note a link `base` that is not where the base of the robot is: messages name that by the same name.

    Args:
        model: The robot.
        base: Its base link.
        substitutions: Receives what is taken in its place.

    Raises:
        UnknownRobotError: there is one, and substitutions are refused.
    """
    if base == BASE_FRAME or not model.existFrame(BASE_FRAME, pin.FrameType.BODY):
        return
    frame = model.frames[model.getFrameId(BASE_FRAME, pin.FrameType.BODY)]
    if frame.parentJoint:
        where = f'moves with {model.names[frame.parentJoint]}'
    else:
        link = Pose(frame.placement.translation, frame.placement.rotation)
        distance, angle = Pose.identity().distance_to(link)
        if distance <= SAME and angle <= SAME:
            return
        x, y, z = (f'{value:.6g}' for value in link.r)
        where = f'lies at ({x}, {y}, {z}) m and turned by {angle:.4g} rad, seen from {base}'
    substitutions.add(
        f'link {BASE_FRAME} {where}; it would have to be the root, or lie where that does',
        f'{base}, to which poses in frame {BASE_FRAME} refer',
    )
