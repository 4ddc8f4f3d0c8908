"""FramesPanel: tools, bases and payloads are measured step by step, and saved by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final, Protocol

from nicegui import ui

from robots_controller.pendant.page.measuring.base_measuring import BaseMeasuring
from robots_controller.pendant.page.measuring.payload_measuring import PayloadMeasuring
from robots_controller.pendant.page.measuring.tool_measuring import ToolMeasuring
from robots_controller.pendant.page.viewer import RefusalLine, Viewer
from robots_controller.pendant.pendant_state import PendantState
from robots_controller.program.files.cell_frames import FRAMES_FILE


class Guide(Protocol):
    """A guide through one sequence."""

    element: ui.element

    def refresh(self, state: PendantState) -> None:
        """Show a state."""


GUIDES: Final[Mapping[str, Callable[..., Guide]]] = {
    'tool': ToolMeasuring,
    'base': BaseMeasuring,
    'payload': PayloadMeasuring,
}


class FramesPanel:
    """One guide at a time: of a tool, of a base, or of a payload.

    Args:
        viewer: Its page.
        folder: Of the robot programs; it has the frames file where no program is open.
    """

    def __init__(self, viewer: Viewer, folder: Path) -> None:
        self._viewer, self._folder = viewer, folder
        self._chosen = 'tool'
        with ui.element('div').classes('panel frames-panel'):
            ui.toggle(
                {name: viewer.texts(f'frames.{name}') for name in GUIDES},
                value=self._chosen,
                on_change=lambda event: self._choose(event.value),
            ).props('unelevated no-caps')
            line = RefusalLine()
            self._guides = {name: guide(viewer, line, self._file) for name, guide in GUIDES.items()}
        self._choose(self._chosen)

    def _file(self) -> Path:
        named = self._viewer.operator.state.program.frames_file
        return Path(named) if named else self._folder / FRAMES_FILE

    def _choose(self, name: str) -> None:
        self._chosen = name
        for key, guide in self._guides.items():
            guide.element.set_visibility(key == name)
        self.refresh(self._viewer.operator.state)

    def refresh(self, state: PendantState) -> None:
        """Show a state."""
        self._guides[self._chosen].refresh(state)
