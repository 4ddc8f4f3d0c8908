"""Inputs whose values are not those of a PLC, in the label of the image that has them."""

from collections.abc import Iterable, Mapping
from typing import Final

from robots_controller.io.io_image import Channel
from robots_controller.io.io_signals import parse_channel
from robots_core.errors import InvalidInputError

BETWEEN: Final = '; '
AFTER_NAME: Final = ': '


def unknown_label(unknown: Mapping[Channel, str]) -> str:
    """The label of an image, such as 'digital_input.2: plc/inputs has sent no value yet'.

    Args:
        unknown: Why the values of inputs are not known, for a person.
    """
    return BETWEEN.join(f'{channel.name}{AFTER_NAME}{why}' for channel, why in unknown.items())


def unknown_inputs(labels: Iterable[str]) -> dict[int, str]:
    """Why the values of digital inputs are not known, by their indices from 1 on; other labels are ignored.

    Args:
        labels: Of the dimensions of an image.
    """
    found: dict[int, str] = {}
    for label in labels:
        for text in label.split(BETWEEN):
            name, _, why = text.partition(AFTER_NAME)
            try:
                channel = parse_channel(name, {}) if why else None
            except InvalidInputError:
                continue
            if channel is not None and channel.image == 'digital_inputs':
                found[channel.index] = why
    return found
