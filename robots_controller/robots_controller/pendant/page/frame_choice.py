"""FrameChoice: the taught frame to jog in."""

from __future__ import annotations

from collections.abc import Callable

from nicegui import ui

from robots_controller.pendant.page.viewer import Viewer, read_when_opened
from robots_core.errors import RobotsError
from robots_core.pose import Pose
from robots_planning.motion_settings import frame


class FrameChoice:
    """The base of the program, or one of its taught points; they are read when the list is opened.

    Args:
        viewer: Its page.
        refused: Gets why the points cannot be read.
    """

    def __init__(self, viewer: Viewer, refused: Callable[[str], None]) -> None:
        self._viewer, self._refused = viewer, refused
        self._poses: dict[str, Pose] = {}
        self._base = viewer.texts('jog.program_base')
        self.element = (
            ui.select({'': self._base}, value='')
            .props(f'dense outlined options-dense label="{viewer.texts("jog.frame")}"')
            .classes('frame')
        )
        read_when_opened(self.element, self._read)

    @property
    def pose(self) -> Pose:
        """The frame that is chosen, in the robot's base."""
        base = frame(self._viewer.operator.state.settings.base, 'base')
        return self._poses.get(str(self.element.value), base) if self.element.value else base

    def _read(self) -> None:
        try:
            self._poses = self._viewer.operator.jog_frames()
        except RobotsError as error:
            self._refused(self._viewer.texts.error(error))
            return
        self._refused('')
        chosen = self.element.value if self.element.value in self._poses else ''
        self.element.set_options({name: name or self._base for name in self._poses}, value=chosen)
