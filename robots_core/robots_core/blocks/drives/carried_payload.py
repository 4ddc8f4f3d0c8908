"""CarriedPayload: what simulated drives carry while a program says so."""

from __future__ import annotations

from collections.abc import Sequence

from robots_core.blocks.drives.drive_train import DriveTrain
from robots_core.blocks.multibody.payload import payload_of


class CarriedPayload:
    """Loads drives when the payload of the motion settings changes.

    Args:
        drives: The drives.
        values: What they carry at the start; unknown by default: then settings without a payload do not
            change it before there was one.
    """

    def __init__(self, drives: DriveTrain, values: Sequence[float] = ()) -> None:
        self._drives = drives
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
        self._drives.load(payload)
