"""FrameChoice: the taught frame to jog in."""

from __future__ import annotations

from collections.abc import Callable

from robots_controller.pendant.page.choice import Choice
from robots_controller.pendant.page.elements import Changes
from robots_controller.pendant.page.viewer import Part, Viewer
from robots_core.errors import RobotsError
from robots_core.files.user_file import when_written
from robots_core.pose import Pose
from robots_planning.motion_settings import frame


class FrameChoice(Part):
    """The base of the program, or one of its taught points, as its points file has them now.

    Args:
        viewer: Its page.
        refused: Gets why the points cannot be read.
    """

    def __init__(self, viewer: Viewer, refused: Callable[[str], None]) -> None:
        super().__init__(viewer)
        self._refused = refused
        self._poses: dict[str, Pose] = {}
        self._changed = Changes()
        self._base = viewer.texts('jog.program_base')
        self.element = (
            Choice({'': self._base}, value='')
            .when_opened(self._read)
            .props(f'dense outlined options-dense label="{viewer.texts("jog.frame")}"')
            .classes('frame')
        )

    @property
    def pose(self) -> Pose:
        """The frame that is chosen, in the robot's base."""
        if self.element.value and self._changed(*self._state()):
            self.element.show(self._read())
        base = frame(self.operator.state.settings.base, 'base')
        return self._poses.get(str(self.element.value), base) if self.element.value else base

    def _state(self) -> tuple[object, ...]:
        """Another one after each change of the points."""
        file = self.operator.state.program.points_file
        return file, when_written(file)

    def _read(self) -> dict[str, str]:
        self._refused('')
        self._changed(*self._state())
        try:
            self._poses = self.operator.jog_frames()
        except RobotsError as error:
            self._refused(self.text.error(error))
            self._poses = {}
        return {'': self._base, **{name: name for name in self._poses if name}}
