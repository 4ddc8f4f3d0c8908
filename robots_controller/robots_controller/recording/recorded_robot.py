"""The robot that a bag was recorded with."""

from typing import Final

from robots_controller.recording.bag_file import Bag
from robots_core.errors import InvalidInputError
from robots_core.robot_choice import load_robot_model
from robots_core.robot_model.base_robot_model import BaseRobotModel

NAMING: Final = ('program_status', 'motion_result')
"""Topics whose messages name the robot."""


def recorded_robot(bag: Bag, prefix: str, name: str = '') -> BaseRobotModel:
    """The robot that a bag was recorded with.

    Args:
        bag: The bag.
        prefix: What the topics of the recorded cell begin with.
        name: Of the robot; '' for the one that the bag names.

    Raises:
        RobotsError: nothing names it, or it is unknown.
    """
    return load_robot_model(name or _recorded_name(bag, prefix))


def _recorded_name(bag: Bag, prefix: str) -> str:
    for messages in bag.deserialized([prefix + topic for topic in NAMING]).values():
        for _, message in messages:
            if message.hardware_id:
                return str(message.hardware_id)
    raise InvalidInputError(
        f'{bag.path} does not say which robot it was recorded with; name it: --robot NAME'
    )
