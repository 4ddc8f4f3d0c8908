"""The robot's image topics from the other side: inputs are published, outputs are subscribed to."""

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

import numpy as np
from std_msgs.msg import Float64MultiArray, UInt8MultiArray

from robots_controller.io.io_image import Channel, image_sizes
from robots_core.ros.messages import doubles
from robots_core.ros.qos import STATE, subscribe_state
from robots_core.ros.timed_node import TimedNode
from robots_core.validation import Array, finite_vector


class InputImages:
    """Publishes `digital_inputs` and `analog_inputs` at every change, up to the last channel that is used.

    Args:
        node: Owner of the publishers.
        channels: The inputs that will be set; a kind that has none is not published.
    """

    def __init__(self, node: TimedNode, channels: Iterable[Channel]) -> None:
        self._values: dict[str, Array] = {}
        self._publishers: dict[str, Any] = {}
        self._published: dict[str, bytes] = {}
        for image, size in image_sizes(channels).items():
            self._values[image] = np.zeros(size)
            self._publishers[image] = node.create_publisher(_message(image), image, STATE)

    def set(self, channel: Channel, value: float) -> None:
        """Set a value; it is sent with the next `publish`."""
        self._values[channel.image][channel.index - 1] = value

    def publish(self) -> None:
        """Publish the images that changed since the last time."""
        for image, values in self._values.items():
            if self._published.get(image) != values.tobytes():
                self._published[image] = values.tobytes()
                message = _message(image)
                data = values.astype('u1').tobytes() if message is UInt8MultiArray else doubles(values)
                self._publishers[image].publish(message(data=data))


class OutputImages:
    """Subscribes to `digital_outputs` and `analog_outputs`.

    Args:
        node: Owner of the subscriptions.
        channels: The outputs that matter.
        on_change: An image came.
    """

    def __init__(self, node: TimedNode, channels: Iterable[Channel], on_change: Callable[[], None]) -> None:
        self._node = node
        self._on_change = on_change
        self._values: dict[str, Array] = {}
        self._seen: dict[str, float] = {}
        for image in image_sizes(channels):
            self._seen[image] = node.now()
            subscribe_state(node, _message(image), image, partial(self._on_message, image))

    def value(self, channel: Channel) -> float | None:
        """Value of an output; None before the first image, and 0 if the image is too short for it."""
        values = self._values.get(channel.image)
        if values is None:
            return None
        return float(values[channel.index - 1]) if channel.index <= values.size else 0.0

    def absent_for(self, channel: Channel, now: float) -> float:
        """Time since the newest image of the channel, s."""
        return now - self._seen[channel.image]

    def _on_message(self, image: str, message: Any) -> None:
        self._values[image] = finite_vector(message.data, len(message.data), image)
        self._seen[image] = self._node.now()
        self._on_change()


def _message(image: str) -> Any:
    return UInt8MultiArray if image.startswith('digital') else Float64MultiArray
