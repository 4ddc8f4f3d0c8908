"""IoImage: digital and analog inputs and outputs by index from 1 or by name; inputs can be forced."""

from __future__ import annotations

import math
import re
import threading
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robots_core.errors import InvalidInputError
from robots_core.status import Level, Status
from robots_core.validation import Array, finite_vector

Kind = Literal['digital', 'analog']
Direction = Literal['input', 'output']

IMAGES: Final = ('digital_inputs', 'digital_outputs', 'analog_inputs', 'analog_outputs')
"""Names of the four images, as their topics have them."""

LABEL: Final = re.compile(r'[A-Za-z_][A-Za-z0-9_]*')
"""What can name a channel."""


@dataclass(frozen=True)
class Channel:
    """One input or output.

    Attributes:
        kind: 'digital' or 'analog'.
        direction: 'input' or 'output' of the robot program.
        index: Counted from 1.
        label: The name it was given, '' for none.
    """

    kind: Kind
    direction: Direction
    index: int
    label: str = ''

    @classmethod
    def of(cls, image: str, index: int, label: str = '') -> Channel:
        """A channel of an image, one of `IMAGES`."""
        kind, direction = image.removesuffix('s').split('_')
        return cls(cast(Kind, kind), cast(Direction, direction), index, label)

    @property
    def name(self) -> str:
        """As in services: digital_input.1."""
        return f'{self.kind}_{self.direction}.{self.index}'

    @property
    def image(self) -> str:
        """The image it belongs to: digital_inputs."""
        return f'{self.kind}_{self.direction}s'

    def checked(self, value: float) -> float:
        """The value, if the channel can have it: 0 or 1, or any finite number.

        Raises:
            InvalidInputError: it cannot.
        """
        valid = 'valid are 0 and 1' if self.kind == 'digital' else 'valid is a finite number'
        if not (value in (0, 1) if self.kind == 'digital' else math.isfinite(value)):
            raise InvalidInputError(f'{self.kind} {self.direction} {self.index} is {value:g}; {valid}')
        return float(value)

    @property
    def title(self) -> str:
        """For people: digital_input.1 (gripper)."""
        return f'{self.name} ({self.label})' if self.label else self.name

    def text(self, value: float) -> str:
        """A value of it, for people."""
        return str(bool(value)).lower() if self.kind == 'digital' else f'{value:g}'


def forced_status(forced: Mapping[Channel, float]) -> Status:
    """The forced inputs and their values, as they travel on `forced_inputs`."""
    values = {channel.title: channel.text(value) for channel, value in forced.items()}
    if not values:
        return Status('forced inputs', 'no input is forced')
    return Status('forced inputs', f'{len(values)} forced: {", ".join(values)}', Level.WARN, values)


class IoImage:
    """Values of all inputs and outputs, safe from any thread.

    An input has a value from outside; a forced one shows the forced value instead, and the one from
    outside again once it is released.

    Args:
        digital: Number of digital inputs, and of digital outputs.
        analog: Number of analog inputs, and of analog outputs.
        labels: Names of the channels of an image (`IMAGES`), from its first on; '' names none.
        condition: Guards the values, and is notified at every change; an own one by default.

    Raises:
        InvalidInputError: sizes that are not at least 1, or labels that are too many, not unique or not
            made of letters, digits and underscores.
    """

    def __init__(
        self,
        *,
        digital: int,
        analog: int,
        labels: Mapping[str, Sequence[str]] = MappingProxyType({}),
        condition: threading.Condition | None = None,
    ) -> None:
        check_count(digital, 'digital')
        check_count(analog, 'analog')
        self.condition = condition or threading.Condition()
        sizes = {image: digital if image.startswith('digital') else analog for image in IMAGES}
        self.channels: tuple[Channel, ...] = _channels(sizes, labels)
        """All channels, image after image."""
        self._by_name = {channel.name: channel for channel in self.channels}
        for channel in self.channels:
            if channel.label:
                self._by_name |= {
                    channel.label: channel,
                    f'{channel.kind}_{channel.direction}.{channel.label}': channel,
                }
        self._values = {image: np.zeros(size) for image, size in sizes.items()}
        self._outside = {image: values.copy() for image, values in self._values.items()}
        self._forced: dict[Channel, float] = {}

    # -- looking ----------------------------------------------------------------------------------

    def find(self, name: str) -> Channel:
        """A channel by its name `digital_input.1`, or by its label, alone or as `digital_input.label`.

        Raises:
            InvalidInputError: there is none.
        """
        channel = self._by_name.get(name)
        if channel is None:
            raise InvalidInputError(self._unknown(name))
        return channel

    def channel(self, kind: Kind, direction: Direction, index: int) -> Channel:
        """A channel by its index, counted from 1.

        Raises:
            InvalidInputError: there is none.
        """
        return self.find(f'{kind}_{direction}.{index}')

    def size(self, image: str) -> int:
        """Number of channels of an image."""
        return self._values[image].size

    def bits(self, image: str) -> NDArray[np.bool_]:
        """Values of a digital image, a copy; the first is channel 1."""
        return self.numbers(image).astype(np.bool_)

    def numbers(self, image: str) -> Array:
        """Values of an image, a copy; the first is channel 1."""
        with self.condition:
            return self._values[image].copy()

    def value(self, channel: Channel) -> float:
        """Value of a channel."""
        with self.condition:
            return float(self._values[channel.image][channel.index - 1])

    def forced(self) -> dict[Channel, float]:
        """The forced inputs and their values, a copy."""
        with self.condition:
            return dict(self._forced)

    # -- changing ---------------------------------------------------------------------------------

    def set_inputs(self, kind: Kind, values: ArrayLike) -> bool:
        """Set inputs 1..k to the k values from outside; further inputs keep theirs.

        Returns:
            True if an input changed.

        Raises:
            InvalidInputError: more values than inputs, or one that an input cannot have; nothing changes.
        """
        image = f'{kind}_inputs'
        array = _vector(values, self.size(image), image)
        if kind == 'digital' and (wrong := np.flatnonzero((array != 0.0) & (array != 1.0)).tolist()):
            raise InvalidInputError(f'digital input {wrong[0] + 1} is {array[wrong[0]]:g}; valid are 0 and 1')
        with self.condition:
            self._outside[image][: array.size] = array
            return self._update(image)

    def set_value(self, channel: Channel, value: float) -> bool:
        """Switch an output, or set the value of an input from outside.

        Returns:
            True if the channel changed; a forced input does not.

        Raises:
            InvalidInputError: a value that the channel cannot have.
        """
        value = channel.checked(value)
        with self.condition:
            self._outside[channel.image][channel.index - 1] = value
            return self._update(channel.image)

    def set_outputs(self, value: Callable[[Channel, float], float]) -> list[Channel]:
        """Switch all outputs at once, each to `value(output, the value that it has)`.

        Returns:
            The outputs that changed.
        """
        with self.condition:
            outputs = [channel for channel in self.channels if channel.direction == 'output']
            before = {channel: self.value(channel) for channel in outputs}
            for channel in outputs:
                self.set_value(channel, value(channel, before[channel]))
            return [channel for channel in outputs if self.value(channel) != before[channel]]

    def force(self, channel: Channel, value: float) -> None:
        """Let an input show this value, whatever comes from outside.

        Raises:
            InvalidInputError: an output, or a value that the input cannot have.
        """
        value = self._input(channel).checked(value)
        with self.condition:
            self._forced[channel] = value
            self._update(channel.image)

    def release(self, channel: Channel) -> None:
        """Let an input show the value from outside again; one that is not forced stays as it is.

        Raises:
            InvalidInputError: an output.
        """
        self._input(channel)
        with self.condition:
            self._forced.pop(channel, None)
            self._update(channel.image)

    # -- locked -----------------------------------------------------------------------------------

    def _update(self, image: str) -> bool:
        values = self._outside[image].copy()
        for channel, value in self._forced.items():
            if channel.image == image:
                values[channel.index - 1] = value
        if np.array_equal(values, self._values[image]):
            return False
        self._values[image] = values
        self.condition.notify_all()
        return True

    @staticmethod
    def _input(channel: Channel) -> Channel:
        if channel.direction == 'output':
            raise InvalidInputError(f'{channel.name} is an output; only inputs can be forced')
        return channel

    def _unknown(self, name: str) -> str:
        images = ', '.join(f'{image[:-1]}.1..{self.size(image)}' for image in IMAGES)
        labels = ', '.join(channel.label for channel in self.channels if channel.label)
        return f'no channel is named {name!r}; channels are {images}' + (f' and {labels}' if labels else '')


def image_sizes(channels: Iterable[Channel]) -> dict[str, int]:
    """Images of the channels, and the highest index in each."""
    sizes: dict[str, int] = {}
    for channel in channels:
        sizes[channel.image] = max(sizes.get(channel.image, 0), channel.index)
    return sizes


def check_count(size: int, name: str) -> None:
    """Check a number of axes, inputs or outputs.

    Raises:
        InvalidInputError: not a whole number, or below 1.
    """
    if isinstance(size, bool) or not isinstance(size, int) or size < 1:
        raise InvalidInputError(f'{name} = {size!r} must be a whole number of at least 1')


def _channels(sizes: Mapping[str, int], labels: Mapping[str, Sequence[str]]) -> tuple[Channel, ...]:
    if unknown := sorted(set(labels) - set(IMAGES)):
        raise InvalidInputError(f'{unknown[0]!r} is no image; images are {", ".join(IMAGES)}')
    channels: list[Channel] = []
    taken: dict[str, Channel] = {}
    for image, size in sizes.items():
        given = list(labels.get(image, ()))
        if len(given) > size:
            raise InvalidInputError(
                f'{len(given)} names for {size} {image.replace("_", " ")}: {", ".join(given)}'
            )
        given += [''] * (size - len(given))
        for index, label in enumerate(given, 1):
            channel = Channel.of(image, index, label)
            if label and not LABEL.fullmatch(label):
                raise InvalidInputError(
                    f'{label!r} cannot name {channel.name}: a name has letters, digits and '
                    f'underscores, and begins with no digit'
                )
            if label and label in taken:
                raise InvalidInputError(
                    f'{label!r} names both {taken[label].name} and {channel.name}; every channel '
                    f'needs a name of its own'
                )
            taken[label] = channel
            channels.append(channel)
    return tuple(channels)


def _vector(values: ArrayLike, size: int, name: str) -> Array:
    try:
        count = len(values)  # type: ignore[arg-type]
    except TypeError:
        raise InvalidInputError(f'{name} must be a list of up to {size} values, got {values!r}') from None
    if count > size:
        raise InvalidInputError(f'{name} has {count} values; the program has {size}')
    return finite_vector(values, count, name)
