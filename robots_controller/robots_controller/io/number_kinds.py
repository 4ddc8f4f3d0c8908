"""Types of the numbers in messages and at a plant."""

from collections.abc import Mapping
from typing import Final

from robots_controller.io.io_image import Channel
from robots_core.files.yaml_section import YamlSection

INTEGERS: Final[Mapping[str, tuple[int, int]]] = {
    **{f'int{size}': (-(2 ** (size - 1)), 2 ** (size - 1) - 1) for size in (8, 16, 32, 64)},
    **{f'uint{size}': (0, 2**size - 1) for size in (8, 16, 32, 64)},
}
"""Ranges of the whole numbers that a field can be."""

KINDS: Final = {
    'bool': 'boolean',
    **{kind: kind for kind in INTEGERS},
    'float32': 'float',
    'float64': 'double',
}
"""By the names that maps have for them at a plant."""


def read_kind(item: YamlSection, channel: Channel) -> str:
    """The key `type` of a place, or what its channel needs: a bool, or a float64.

    Raises:
        InvalidInputError: no such type; with file and line.
    """
    default = 'bool' if channel.kind == 'digital' else 'float64'
    return KINDS[item.text('type', default, among=KINDS)]


def bits_of(kind: str) -> int:
    """Number of bits of a whole number."""
    low, high = INTEGERS[kind]
    return (high - low).bit_length()
