"""PayloadMeasuring: the guide to identify a payload from the torques of a motion."""

from __future__ import annotations

from nicegui import ui

from robots_controller.measuring.shown_numbers import millimetres
from robots_controller.pendant.page.elements import mark, show_text
from robots_controller.pendant.page.measuring.guide import Guide
from robots_controller.pendant.page.viewer import ActionButton
from robots_controller.pendant.permissions import Action, NotPermittedError
from robots_core.blocks.calibration.payload_identification import IdentifiedPayload, identify_payload


class PayloadMeasuring(Guide):
    """The recording, and what follows from it; it is saved with a tool."""

    name = 'payload'
    kind = 'tool'

    def build(self) -> None:
        """See `Guide`."""
        text = self.text
        self._found: IdentifiedPayload | None = None
        with ui.element('div').classes('row-of-buttons'):
            viewer, may = self.viewer, Action.OVERRIDE
            ActionButton(viewer, may, text('frames.record'), 'fiber_manual_record', self._record)
            ActionButton(viewer, may, text('frames.evaluate'), 'functions', self._evaluate)
            self._duration = ui.label().classes('number')
        self._shown = ui.label().classes('found number')
        self._show(None)

    async def _record(self) -> None:
        if await self.do(self._start):
            self._show(None)

    def _start(self, viewer: str) -> None:
        operator = self.operator
        operator.desk.check(viewer)
        if operator.state.torque is None:
            raise NotPermittedError('no_torque')
        operator.motion.start()

    async def _evaluate(self) -> None:
        found = await self.do(self._identify)
        self._show(found[0] if found else None)

    def _identify(self, viewer: str) -> IdentifiedPayload:
        operator = self.operator
        operator.desk.check(viewer)
        operator.motion.stop()
        if not operator.motion.duration:
            raise NotPermittedError('none_recorded')
        return identify_payload(operator.robot, operator.motion.samples())

    def save(self, name: str) -> None:
        """See `Guide`."""
        if self._found is None:
            raise NotPermittedError('none_recorded')
        self.operator.measuring.save_payload(self.file(), name, self._found)

    def _show(self, found: IdentifiedPayload | None) -> None:
        self._found = found
        text = (
            ''
            if found is None
            else self.text(
                'frames.mass',
                mass=f'{found.payload.mass:.3f}',
                mass_std=f'{found.mass_std:.3f}',
                std=f'{1e3 * found.center_std.max():.1f}',
                **millimetres(found.payload.center),
            )
        )
        show_text(self._shown, text)

    def refresh(self) -> None:
        """See `Guide`."""
        super().refresh()
        recording = self.operator.motion
        self._duration.set_text(self.text('frames.recorded', duration=f'{recording.duration:.0f}'))
        mark(self._duration, 'recording', on=recording.running)
