"""Names of inputs and outputs in files: `signals: {press_ready: digital_input.1}`."""

import re
from collections.abc import Mapping
from functools import partial
from typing import Final

from robots_controller.io.io_image import IMAGES, Channel, IoImage
from robots_core.errors import InvalidInputError
from robots_core.files.yaml_section import YamlSection, located

LARGEST_INDEX: Final = 4096  # a typing error must not make an image of a billion channels

_NAME: Final = re.compile(rf'({"|".join(image.removesuffix("s") for image in IMAGES)})\.([1-9]\d*)')


def parse_channel(text: str, signals: Mapping[str, Channel]) -> Channel:
    """A channel by its name `digital_input.1`, or by its signal's name.

    Raises:
        InvalidInputError: neither.
    """
    if text in signals:
        return signals[text]
    match = _NAME.fullmatch(text)
    if match is None or int(match[2]) > LARGEST_INDEX:
        known = f', or a signal: {", ".join(signals)}' if signals else ''
        raise InvalidInputError(
            f'{text!r} is no channel; channels are digital_input.1, digital_output.1, analog_input.1, '
            f'analog_output.1 and so on, up to {LARGEST_INDEX}{known}'
        )
    return Channel.of(f'{match[1]}s', int(match[2]))


def channel_at(section: YamlSection, text: str, line: int, signals: Mapping[str, Channel]) -> Channel:
    """The channel of a file, by `parse_channel`.

    Raises:
        InvalidInputError: it is none; with file and line.
    """
    try:
        return parse_channel(text, signals)
    except InvalidInputError as error:
        raise located(section.file, line, error.message) from None


def value_at(section: YamlSection, key: str, channel: Channel) -> float:
    """A value that the channel can have.

    Raises:
        InvalidInputError: it is missing, or another one; with file and line.
    """
    return float(section.switch(key)) if channel.kind == 'digital' else section.number(key)


def read_signals(section: YamlSection) -> dict[str, Channel]:
    """The section `signals` of a file.

    Raises:
        InvalidInputError: a name or channel that is not valid, or a channel with two names; with its line.
    """
    signals: dict[str, Channel] = {}
    named: dict[str, str] = {}
    for below, label in section.entries('signals'):
        channel = below.checked(partial(parse_channel, below.text(label), {}), label)
        labelled = Channel.of(channel.image, channel.index, label)
        size, labels = channel.index, channel_labels([labelled])
        below.checked(partial(IoImage, digital=size, analog=size, labels=labels), label)
        if channel.name in named:
            raise below.error(f'{channel.name} has the name {named[channel.name]!r} already', label)
        named[channel.name] = label
        signals[label] = labelled
    return signals


def channel_labels(channels: list[Channel]) -> dict[str, list[str]]:
    """Labels per image, as `IoImage` takes them."""
    labels: dict[str, list[str]] = {}
    for image in IMAGES:
        members = {c.index: c.label for c in channels if c.image == image and c.label}
        if members:
            labels[image] = [members.get(index, '') for index in range(1, max(members) + 1)]
    return labels
