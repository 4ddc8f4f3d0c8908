"""The frames of a robot by the names that messages give them: those of its base, and its flange."""

from typing import Final

from robots_core.errors import InvalidInputError
from robots_core.pose import Pose

BASE_FRAME: Final = 'base'
BASE_LINK: Final = 'base_link'
TOOL_FRAME: Final = 'tool0'
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
