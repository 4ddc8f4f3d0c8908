"""CarriedPayload: the payload that a program has set for its robot."""

from collections.abc import Callable, Sequence

from robots_core.blocks.multibody.payload import Payload, payload_of


class CarriedPayload:
    """Loads a model of the robot when the payload of the motion settings changes.

    Args:
        load: Makes the model carry a payload.
        values: What it carries at the start; unknown by default: then settings without a payload do not
            change it before there was one.
    """

    def __init__(self, load: Callable[[Payload], None], values: Sequence[float] = ()) -> None:
        self._load = load
        self._values = tuple(values)

    def carry(self, values: Sequence[float]) -> None:
        """Take the payload of the settings, by its numbers (see `payload_of`).

        Raises:
            InvalidInputError: numbers of no payload.
        """
        payload, wanted = payload_of(values), tuple(values)
        if wanted == self._values or (not self._values and payload.mass == 0.0):
            return
        self._values = wanted
        self._load(payload)
