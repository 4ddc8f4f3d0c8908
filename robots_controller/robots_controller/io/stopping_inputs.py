"""Digital inputs that stop the robot or close the borders of zones. No certified safety function."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Final

from robots_controller.io.io_image import Channel
from robots_controller.io.io_signals import channel_at, parse_channel
from robots_core.blocks.zones.zone import Zone
from robots_core.errors import InvalidInputError
from robots_core.files.yaml_section import YamlSection

WORDS: Final = ('off', 'on')
BETWEEN: Final = '; '
AFTER_NAME: Final = ': '

Stopping = Mapping[int, int]
"""The values of digital inputs that stop the robot, 0 or 1, by the inputs' indices from 1 on."""
Closing = Mapping[str, Mapping[int, int]]
"""The values that close, 0 or 1, by the indices of inputs from 1 on, by zone."""


def emergency_reason(
    stopping: Stopping, image: Sequence[int], unknown: Mapping[int, str] = MappingProxyType({})
) -> str:
    """Which inputs stop the robot, for a person; '' if none does.

    Args:
        stopping: The inputs that do.
        image: The digital inputs from the first one on; one that is not in it stops the robot too, as its
            value is unknown.
        unknown: Why the values of inputs are not those of their PLC, by their indices.
    """
    named = []
    for index, value in stopping.items():
        why = 'digital_inputs is too short' if index > len(image) else unknown.get(index, '')
        if has_value(image, index, value):
            named.append(f'digital_input.{index} (unknown: {why})' if why else f'digital_input.{index}')
    return f'emergency stop by {", ".join(named)}' if named else ''


def has_value(image: Sequence[int], index: int, value: int) -> bool:
    """An input has a value that stops or closes, or none in the image, which counts as that."""
    return index > len(image) or int(image[index - 1]) == value


def read_emergency_stop(section: YamlSection, signals: Mapping[str, Channel]) -> dict[str, int]:
    """The section `emergency_stop` of a file: `{e_stop: off}`; the values that stop, by channel.

    Raises:
        InvalidInputError: no digital input, or another value; with its line.
    """
    found: dict[str, int] = {}
    for below, key in section.entries('emergency_stop'):
        channel = channel_at(below, key, below.line_of(key), signals)
        if channel.image != 'digital_inputs':
            raise below.error(f'{key} is no digital input; only these can be an emergency stop', key)
        found[channel.name] = int(below.switch(key))
    return found


def emergency_stop_texts(stopping: Mapping[str, int]) -> list[str]:
    """As a parameter of a node: 'digital_input.3=off'."""
    return [f'{name}={WORDS[value]}' for name, value in stopping.items()]


def parse_emergency_stop(texts: Iterable[str]) -> dict[int, int]:
    """The inputs in texts of `emergency_stop_texts`; empty texts are ignored.

    Raises:
        InvalidInputError: not of the form 'digital_input.3=off'.
    """
    valid = "valid are 'digital_input.3=off' and 'digital_input.3=on'"
    return dict(parse_input(text, f'{text!r} is no emergency stop; {valid}') for text in filter(None, texts))


def parse_input(text: str, wrong: str) -> tuple[int, int]:
    """Index and value of a digital input, of a text like 'digital_input.3=off'.

    Raises:
        InvalidInputError: `wrong`, if it is none.
    """
    name, _, word = text.partition('=')
    channel = parse_channel(name, {})
    if channel.image != 'digital_inputs' or word not in WORDS:
        raise InvalidInputError(wrong)
    return channel.index, WORDS.index(word)


def closed_zones(closing: Closing, image: Sequence[int]) -> frozenset[str]:
    """The zones that are closed by an image of the inputs.

    Args:
        closing: What closes each zone; one of its inputs is enough.
        image: The digital inputs from the first one on; one that is not in it closes.
    """
    return frozenset(
        name
        for name, inputs in closing.items()
        if any(has_value(image, index, value) for index, value in inputs.items())
    )


def closing_inputs(zones: Iterable[Zone], signals: Mapping[str, Channel]) -> Closing:
    """What closes each zone of a scene that can be opened.

    Raises:
        InvalidInputError: a zone names what is no digital input.
    """
    found: dict[str, dict[int, int]] = {}
    for zone in zones:
        for name, value in zone.closed_by.items():
            try:
                channel = parse_channel(name, signals)
            except InvalidInputError as error:
                raise InvalidInputError(f'zone {zone.name!r}: closed_by: {error.message}') from None
            if channel.image != 'digital_inputs':
                raise InvalidInputError(
                    f'zone {zone.name!r}: closed_by: {name} is no digital input; only these close a zone'
                )
            inputs = found.setdefault(zone.name, {})
            if channel.index in inputs:
                raise InvalidInputError(f'zone {zone.name!r}: closed_by names {channel.name} twice')
            inputs[channel.index] = int(value)
    return found


def closing_texts(closing: Closing) -> list[str]:
    """As a parameter of a node: 'digital_input.3=off press', an input's value and the zone it closes."""
    return [
        f'digital_input.{index}={WORDS[value]} {name}'
        for name, inputs in closing.items()
        for index, value in inputs.items()
    ]


def parse_closing(texts: Iterable[str]) -> Closing:
    """The inputs in texts of `closing_texts`; empty texts are ignored.

    Raises:
        InvalidInputError: not of the form 'digital_input.3=off press'.
    """
    found: dict[str, dict[int, int]] = {}
    for text in filter(None, texts):
        condition, _, zone = text.partition(' ')
        wrong = f"{text!r} closes no zone; valid is 'digital_input.3=off press', with the zone's name"
        index, value = parse_input(condition, wrong)
        if not zone:
            raise InvalidInputError(wrong)
        found.setdefault(zone, {})[index] = value
    return found


def unknown_label(unknown: Mapping[Channel, str]) -> str:
    """The label of an image, such as 'digital_input.2: plc/inputs has sent no value yet'."""
    return BETWEEN.join(f'{channel.name}{AFTER_NAME}{why}' for channel, why in unknown.items())


def unknown_inputs(labels: Iterable[str]) -> dict[int, str]:
    """Why values of digital inputs are not known, by their indices from 1 on, from the labels of an image."""
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
