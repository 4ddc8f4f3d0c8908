"""PlcLine: what a scripted PLC does, beside the inputs that it sets."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

from nicegui import ui

from robots_controller.pendant.channels import channel_label
from robots_controller.pendant.page.elements import mark
from robots_controller.pendant.page.viewer import Part, Viewer
from robots_controller.pendant.pendant_state import PendantState, ShownIo

MOST: Final = 3
"""Changes that are shown."""


class PlcLine(Part):
    """The file of the PLC, its state, and what it will do next; nothing where none is played."""

    def __init__(self, viewer: Viewer) -> None:
        super().__init__(viewer)
        self._label = ui.label().classes('plc number')

    def refresh(self, state: PendantState) -> None:
        """Show a state."""
        plc = state.plc
        self._label.set_visibility(bool(plc.script))
        if not plc.script:
            return
        if plc.lost:
            does = self.text('plc.lost')
        elif plc.error:
            does = self.text('plc.error', error=plc.error)
        else:
            does = '; '.join(self._pending(state)) or self.text('plc.waits')
        self._label.set_text(f'{self.text("plc.name", script=plc.script)}: {does}')
        mark(self._label, 'wrong', on=plc.lost or bool(plc.error))

    def _pending(self, state: PendantState) -> Iterator[str]:
        now = self.operator.now()
        for time, line, inputs in state.plc.pending[:MOST]:
            left, what = f'{max(0.0, time - now):.1f}', _inputs(inputs, state.io)
            yield self.text('plc.pending', time=left, what=what, line=line)


def _inputs(values: Mapping[str, float], io: ShownIo) -> str:
    return ', '.join(f'{channel_label(io, name)} = {value:g}' for name, value in values.items())
