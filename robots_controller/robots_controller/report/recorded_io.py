"""IoChannel: what an input or output of a recorded run showed over time."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from robots_controller.io.io_image import IMAGES
from robots_controller.recording.motion_record import Messages
from robots_core.validation import Array, read_only

IO_TOPICS: Final = (*(f'lua_program_node/{image}' for image in IMAGES), *IMAGES)
IO_KINDS: Final = tuple(image.removesuffix('s') for image in IMAGES)


@dataclass(frozen=True, eq=False)
class IoChannel:
    """A channel that changed, or that is not 0.

    Attributes:
        name: As everywhere: digital_input.1.
        digital: It is 0 or 1.
        time: When it got its values, (k,) s, the first at 0 or before.
        value: (k,); each holds until the next.
        label: Its own name, '' for none.
    """

    name: str
    digital: bool
    time: Array
    value: Array
    label: str = ''


def io_channels(messages: Messages, labels: Mapping[str, str], end: float) -> tuple[IoChannel, ...]:
    """The channels of a bag.

    Args:
        messages: Those of `IO_TOPICS`.
        labels: Own names of channels, by name.
        end: End of the run, s; what comes later is left out.
    """
    channels: list[IoChannel] = []
    for image in IMAGES:
        # The inputs as the program saw them, forced ones too; as they came from outside in older bags.
        rows = messages.get(f'lua_program_node/{image}') or messages.get(image) or ()
        if not rows:
            continue
        size = max(len(message.data) for _, message in rows)
        values = np.zeros((len(rows), size))
        for row, (_, message) in enumerate(rows):
            values[row, : len(message.data)] = message.data
        time = np.array([time for time, _ in rows])
        keep = time <= end
        for index in range(size):
            channel = _channel(image, index, time[keep], values[keep, index], labels)
            if channel is not None:
                channels.append(channel)
    return tuple(channels)


def _channel(
    image: str, index: int, time: Array, values: Array, labels: Mapping[str, str]
) -> IoChannel | None:
    if not values.any():
        return None
    if time[0] > 0.0:  # before the first message nothing was on
        time, values = np.concatenate([[0.0], time]), np.concatenate([[0.0], values])
    changed = np.concatenate([[True], np.diff(values) != 0.0])
    time, values = time[changed], values[changed]
    name = f'{image.removesuffix("s")}.{index + 1}'
    return IoChannel(
        name,
        image.startswith('digital'),
        read_only(time),
        read_only(values),
        labels.get(name, ''),
    )
