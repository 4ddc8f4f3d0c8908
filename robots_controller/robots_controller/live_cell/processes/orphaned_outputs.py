"""OrphanedOutputs: publishes fail-safe outputs from the death of the program's node to its restart."""

from collections.abc import Mapping
from typing import Any

from rclpy.node import Node

from robots_controller.io.fail_safe import FailSafe, fail_safe_texts, safe_value
from robots_controller.io.io_image import Channel, Kind
from robots_core.ros.qos import make_publisher


class OrphanedOutputs:
    """Writes the images of outputs while the node that owns them is dead, and never beside it.

    Args:
        node: Owner of the publishers.
        fail_safe: Values of outputs when no running program answers for them.
    """

    def __init__(self, node: Node, fail_safe: FailSafe) -> None:
        self._node, self._fail_safe = node, fail_safe
        self._publishers: list[Any] = []
        self._values: dict[str, float] = {}

    def take_over(self, images: Mapping[Kind, Any]) -> None:
        """The owner is dead: publish its last images with fail-safe values."""
        self._values = {}
        for kind, image in images.items():
            outputs = [Channel(kind, 'output', index) for index in range(1, len(image.data) + 1)]
            values = [
                safe_value(self._fail_safe, output, float(value))
                for output, value in zip(outputs, image.data, strict=True)
            ]
            self._values |= {output.name: value for output, value in zip(outputs, values, strict=True)}
            data = [int(value) for value in values] if kind == 'digital' else values
            publisher = make_publisher(self._node, type(image), f'{kind}_outputs')
            publisher.publish(type(image)(layout=image.layout, data=data))
            self._publishers.append(publisher)

    def hand_back(self) -> list[str]:
        """Publish no more; returns the values that are not 0, as a parameter of the owner's next process."""
        for publisher in self._publishers:
            self._node.destroy_publisher(publisher)
        self._publishers.clear()
        return fail_safe_texts({name: value for name, value in self._values.items() if value != 0.0})
