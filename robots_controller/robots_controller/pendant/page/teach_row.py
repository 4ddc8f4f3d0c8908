"""TeachRow: points and motions are taught where the robot stands, and changes are undone."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Final

from nicegui import ui

from robots_controller.pendant.page.elements import Changes, Choice, show_text
from robots_controller.pendant.page.viewer import ActionButton, Part, RefusalLine, Viewer
from robots_controller.pendant.pendant_state import PendantState
from robots_controller.pendant.permissions import Action
from robots_controller.program.teaching import MOTIONS, Motion, free_name
from robots_core.errors import RobotsError
from robots_core.files.user_file import when_written

ICONS: Final = {'ptp': 'timeline', 'line': 'trending_flat', 'arc': 'roundabout_right'}


class TeachRow(Part):
    """A field for a point's name, and buttons that teach it and insert a motion to it.

    `cursor` gives the file and the line after which motions are inserted; `inserted` gets the line of one.
    """

    def __init__(
        self,
        viewer: Viewer,
        line: RefusalLine,
        cursor: Callable[[], tuple[str, int]],
        inserted: Callable[[int], None],
    ) -> None:
        super().__init__(viewer, line)
        self._cursor, self._inserted = cursor, inserted
        self._via = ''  # the point that an arc passes
        self._changed = Changes()
        with ui.element('div').classes('row-of-buttons teach'):
            label = self.text('teach.point')
            self._name = Choice([], label=label, with_input=True, new_value_mode='add-unique')
            self._name.classes('point')
            self._build_button(Action.TEACH, 'here', 'add_location', self._teach)
            for motion in MOTIONS:
                self._build_button(Action.EDIT, motion, ICONS[motion], partial(self._insert, motion))
            self._build_button(Action.EDIT, 'undo', 'undo', self._undo)
        self._hint = ui.label().classes('hint')
        show_text(self._hint, '')

    def _build_button(self, action: Action, key: str, icon: str, press: Callable[[], object]) -> None:
        ActionButton(self.viewer, action, self.text(f'teach.{key}'), icon, press)

    async def _teach(self) -> None:
        name = str(self._name.value or '') or self._free()
        if await self.do(self.operator.teach, name):
            self._say('taught', name=name)
            self._show_points(name)

    async def _insert(self, motion: Motion) -> None:
        operator, given = self.operator, str(self._name.value or '')
        name = self._free() if not given or given in self._name.options else given
        if motion == 'arc' and not self._via:
            if await self.do(operator.teach, name):
                self._via = name
                self._say('via', name=name)
                self._show_points('')
            return
        names = [self._via, name] if motion == 'arc' else [name]
        if new := await self.do(operator.insert_motion, *self._cursor(), motion, names):
            self._via = ''
            self._say('inserted', name=name, line=new[0])
            self._show_points('')
            self._inserted(new[0])

    async def _undo(self) -> None:
        if await self.do(self.operator.undo):
            self._via = ''
            self._say('undone')
            self._show_points('')

    def _say(self, key: str, **values: object) -> None:
        show_text(self._hint, self.text(f'teach.{key}', **values))

    def _free(self) -> str:
        try:
            return free_name(self.operator.points())
        except RobotsError:  # which teaching will say
            return 'P1'

    def _show_points(self, chosen: str) -> None:
        names = sorted(self.read(self.operator.points) or {})
        self._name.set_options(names, value=chosen if chosen in names else None)

    def refresh(self, state: PendantState) -> None:
        """Show a state."""
        file = state.program.points_file
        if self._changed(file, when_written(file)):
            self._show_points(str(self._name.value or ''))
