"""Substitutions: what a URDF lacks, and what is taken in its place."""

from typing import Final

import pinocchio as pin

from robots_core.base_frames import BASE_FRAME
from robots_core.errors import InvalidInputError, UnknownRobotError
from robots_core.pose import Pose

SAME: Final = 1e-6  # m, rad


class Substitutions:
    """Collects what was substituted, one sentence each.

    Args:
        strict: Refuse whatever is lacking.

    Raises:
        InvalidInputError: `strict` is no truth value.
    """

    def __init__(self, *, strict: bool) -> None:
        if not isinstance(strict, bool):
            raise InvalidInputError(f'strict = {strict!r} must be true or false')
        self.strict = strict
        self.sentences: list[str] = []
        """What was substituted so far."""

    def refuse(self, lacking: str) -> None:
        """Refuse what is lacking, where nothing may be substituted.

        Raises:
            UnknownRobotError: it is strict.
        """
        if self.strict:
            raise UnknownRobotError(lacking)

    def add(self, lacking: str, taken: str) -> None:
        """Note a substitution.

        Args:
            lacking: What the files lack, and what would be valid.
            taken: What is taken in its place.

        Raises:
            UnknownRobotError: it is strict.
        """
        self.refuse(lacking)
        self.sentences.append(f'{lacking}; taken in its place: {taken}')


def note_other_base(model: pin.Model, base: str, substitutions: Substitutions) -> None:
    """Note a link `base` that is not where the robot's base link is: messages name that by the same name.

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
