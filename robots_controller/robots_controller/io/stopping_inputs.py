"""Digital inputs that stop the robot. No certified safety function."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Final

from robots_controller.io.io_image import Channel
from robots_controller.io.io_signals import channel_at, parse_channel
from robots_core.errors import InvalidInputError
from robots_core.files.yaml_section import YamlSection

WORDS: Final = ('off', 'on')


Stopping = Mapping[int, int]
"""The values of digital inputs that stop the robot, 0 or 1, by the inputs' indices from 1 on."""


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
    found: dict[int, int] = {}
    for text in filter(None, texts):
        index, value = parse_input(
            text, f"{text!r} is no emergency stop; valid are 'digital_input.3=off' and 'digital_input.3=on'"
        )
        found[index] = value
    return found


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
