"""The robot's image topics from the other side: inputs are published, outputs are subscribed to."""

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np
from rclpy.node import Node
from std_msgs.msg import Float64MultiArray, UInt8MultiArray

from robots_controller.io.io_image import Channel, image_sizes
from robots_controller.io.stopping_inputs import unknown_label
from robots_core.ros.messages import BUILD
from robots_core.ros.qos import make_publisher, subscribe
from robots_core.ros.timed_node import TimedNode
from robots_core.validation import Array, finite_vector


class ImagePublisher:
    """Publishes an image at every change.

    Args:
        image: One of `IMAGES`.
        topic: The topic; that of the image by default.
        labelled: The messages name the channels.
    """

    def __init__(self, node: Node, image: str, topic: str = '', *, labelled: bool = False) -> None:
        self._image, self._labelled = image, labelled
        self.publisher: Any = make_publisher(node, image_message(image), topic or image)
        self._published: tuple[bytes, str] | None = None

    def publish(self, values: Array, label: str = '') -> None:
        """Publish the values if they are others than before.

        Args:
            values: From the first channel on.
            label: Of the message, in the place of the names of the channels; another one is published too.
        """
        if self._published != (values.tobytes(), label):
            self._published = values.tobytes(), label
            self.publisher.publish(BUILD.image(self._image, values, labelled=self._labelled, label=label))

    def repeat(self) -> None:
        """Publish the next values, whatever they are."""
        self._published = None


class InputImages:
    """Publishes `digital_inputs` and `analog_inputs` at every change, up to the last channel that is used.

    Args:
        channels: The inputs that will be set; a kind that has none is not published.
    """

    def __init__(self, node: TimedNode, channels: Iterable[Channel]) -> None:
        sizes = image_sizes(channels)
        self._values: dict[str, Array] = {image: np.zeros(size) for image, size in sizes.items()}
        self._publishers = {image: ImagePublisher(node, image) for image in sizes}

    def set(self, channel: Channel, value: float) -> None:
        """Set a value; it is sent with the next `publish`."""
        self._values[channel.image][channel.index - 1] = value

    def publish(self, unknown: Mapping[Channel, str] = MappingProxyType({})) -> None:
        """Publish the images that changed since the last time.

        Args:
            unknown: Inputs whose values are not those of a PLC, and why, for a person.
        """
        for image, values in self._values.items():
            label = unknown_label({one: why for one, why in unknown.items() if one.image == image})
            self._publishers[image].publish(values, label)


class OutputImages:
    """Subscribes to `digital_outputs` and `analog_outputs`.

    Args:
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
            subscribe(node, image_message(image), image, partial(self._on_message, image))

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


def image_message(image: str) -> Any:
    """The type of an image's messages."""
    return UInt8MultiArray if image.startswith('digital') else Float64MultiArray
