"""CarriedPayload: what simulated drives carry while a program says so."""

from __future__ import annotations

from collections.abc import Sequence

from robots_core.blocks.drives.drive_train import DriveTrain
from robots_core.blocks.multibody.payload import NOTHING, Payload, payload_of


class CarriedPayload:
    """Loads drives when the payload of the motion settings changes.

    Args:
        drives: The drives.
        own: What they carry where the settings have no payload.
    """

    def __init__(self, drives: DriveTrain, own: Payload = NOTHING) -> None:
        self._drives, self._own = drives, own
        self._values: tuple[float, ...] = ()

    def carry(self, values: Sequence[float]) -> None:
        """Take the payload of the settings, by its numbers (see `payload_of`).

        Raises:
            InvalidInputError: numbers of no payload.
        """
        payload = payload_of(values)
        wanted = tuple(values) if payload.mass > 0.0 else ()
        if wanted != self._values:
            self._values = wanted
            self._drives.load(payload if wanted else self._own)
