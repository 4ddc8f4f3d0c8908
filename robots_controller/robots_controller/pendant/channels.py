"""The channels of a cell, as the operator's page finds them."""

from __future__ import annotations

from robots_controller.io.io_image import Channel, Direction, Kind
from robots_controller.pendant.pendant_state import ShownIo


def found_channels(io: ShownIo, image: str, part: str) -> list[Channel]:
    """Channels of an image whose name or number contains a part; '' finds all.

    Args:
        io: Values and names.
        image: One of `IMAGES`.
        part: A number finds the channels with just that number or a name that contains it.
    """
    kind: Kind = 'digital' if image.startswith('digital') else 'analog'
    direction: Direction = 'input' if image.endswith('inputs') else 'output'
    labels, wanted = io.labels.get(image, ()), part.strip().casefold()
    channels = [
        Channel(kind, direction, index, labels[index - 1] if index <= len(labels) else '')
        for index in range(1, len(io.values.get(image, ())) + 1)
    ]
    return [one for one in channels if wanted in one.label.casefold() or wanted in ('', str(one.index))]


def channel_label(io: ShownIo, name: str) -> str:
    """The name that a channel such as 'digital_input.3' has in the cell; its own where it has none."""
    image, _, number = name.partition('.')
    labels = io.labels.get(f'{image}s', ())
    return (labels[int(number) - 1] if int(number) <= len(labels) else '') or name
