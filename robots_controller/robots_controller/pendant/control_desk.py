"""ControlDesk: many may look, one operates."""

from __future__ import annotations

from collections.abc import Callable

from robots_controller.pendant.permissions import NotPermittedError


class ControlDesk:
    """Which viewer of the page operates the cell."""

    def __init__(self) -> None:
        self.holder = ''
        """The viewer in control; '' for none."""
        self.address = ''
        """Of its browser."""
        self.log: Callable[[str], object] = str
        """Gets who has taken control, for a log."""

    def take(self, viewer: str, *, address: str = '', from_other: bool = False) -> None:
        """Take control, with `from_other` also from a viewer that has it.

        Raises:
            NotPermittedError: another one has it.
        """
        if self.holder not in ('', viewer) and not from_other:
            raise NotPermittedError('controlled')
        if viewer != self.holder:
            self.log(f'the page at {address} operates the robot')
        self.holder, self.address = viewer, address

    def give_back(self, viewer: str) -> None:
        """Give control back, if the viewer has it."""
        if self.holder == viewer:
            self.holder = ''

    def check(self, viewer: str) -> None:
        """Check that a viewer is in control.

        Raises:
            NotPermittedError: it is not.
        """
        if self.holder != viewer:
            raise NotPermittedError('controlled' if self.holder else 'not_in_control')
