"""Digital inputs that close the borders of zones. No certified safety function."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from robots_controller.io.emergency_inputs import WORDS, has_value, parse_input
from robots_controller.io.io_image import Channel
from robots_controller.io.io_signals import parse_channel
from robots_core.blocks.zones.zone import Zone
from robots_core.errors import InvalidInputError

Closing = Mapping[str, Mapping[int, int]]
"""The values that close, 0 or 1, by the indices of inputs from 1 on, by zone."""


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
    """What closes each zone that can be opened.

    Args:
        zones: Of a scene.
        signals: Names of channels.

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
