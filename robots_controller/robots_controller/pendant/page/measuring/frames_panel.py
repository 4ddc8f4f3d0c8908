"""FramesPanel: tools, bases and payloads are measured step by step, and saved by name."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from nicegui import ui

from robots_controller.pendant.page.elements import choices
from robots_controller.pendant.page.measuring.payload_measuring import PayloadMeasuring
from robots_controller.pendant.page.measuring.touching_guides import BaseMeasuring, ToolMeasuring
from robots_controller.pendant.page.viewer import Part, RefusalLine, Viewer
from robots_controller.pendant.pendant_state import PendantState
from robots_controller.program.files.cell_frames import FRAMES_FILE

GUIDES: Final = (ToolMeasuring, BaseMeasuring, PayloadMeasuring)


class FramesPanel(Part):
    """One guide at a time: of a tool, of a base, or of a payload."""

    def __init__(self, viewer: Viewer) -> None:
        super().__init__(viewer)
        with ui.element('div').classes('panel frames-panel'):
            names = {one.name: viewer.texts(f'frames.{one.name}') for one in GUIDES}
            self._chosen = choices(names, GUIDES[0].name, viewer.refresh)
            line = RefusalLine()
            self._guides = [guide(viewer, line, self._file) for guide in GUIDES]

    def _file(self) -> Path:
        """Of the program that is open; without one, that of the folder."""
        named = self.operator.state.program.frames_file
        return Path(named) if named else self.viewer.folder / FRAMES_FILE

    def refresh(self, _state: PendantState) -> None:
        """Show the guide that is chosen."""
        for guide in self._guides:
            guide.element.set_visibility(guide.name == self._chosen.value)
            if guide.name == self._chosen.value:
                guide.refresh()
