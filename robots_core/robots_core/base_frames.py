"""The frames of a robot's base, by the names that messages give them."""

from typing import Final

from robots_core.errors import InvalidInputError
from robots_core.pose import Pose

BASE_FRAME: Final = 'base'
BASE_LINK: Final = 'base_link'
BASE_FRAMES: Final = ('', BASE_FRAME, BASE_LINK)
"""A message without a frame is in `base`."""
AT_BASE: Final = Pose.identity()


def frame_in_base(name: str, base_link: Pose) -> Pose:
    """The frame of a message, seen from the base.

    Args:
        name: One of `BASE_FRAMES`.
        base_link: See `BaseRobotModel.base_link`.

    Raises:
        InvalidInputError: another frame.
    """
    if name not in BASE_FRAMES:
        names = ' and '.join(map(repr, filter(None, BASE_FRAMES)))
        raise InvalidInputError(f'frame {name!r} is unknown; valid are {names}')
    return base_link if name == BASE_LINK else AT_BASE
