"""The robot that a bag was recorded with."""

from collections.abc import Mapping, Sequence
from typing import Any, Final

from robots_controller.recording.bag_file import Bag
from robots_core.errors import InvalidInputError

NAMING: Final = ('program_status', 'motion_result')
"""Topics whose messages name the robot."""


def recorded_robot(bag: Bag, messages: Mapping[str, Sequence[tuple[int, Any]]]) -> str:
    """Name of the robot that a bag was recorded with.

    Args:
        bag: The bag.
        messages: Its messages of the topics `NAMING`, by topic.

    Raises:
        InvalidInputError: none of them names it.
    """
    for topic in NAMING:
        for _, message in messages[topic]:
            if message.hardware_id:
                return str(message.hardware_id)
    raise InvalidInputError(
        f'{bag.path} does not say which robot it was recorded with; name it: --robot NAME'
    )
