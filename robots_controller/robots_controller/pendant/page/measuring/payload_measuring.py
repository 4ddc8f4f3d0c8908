"""PayloadMeasuring: the guide to identify a payload from the torques of a motion."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from nicegui import ui

from robots_controller.measuring.shown_numbers import millimetres
from robots_controller.pendant.page.measuring.saved_frame import SavedFrame
from robots_controller.pendant.page.viewer import ActionButton, RefusalLine, Viewer
from robots_controller.pendant.pendant_state import PendantState
from robots_controller.pendant.permissions import Action, NotPermittedError, Reason
from robots_core.blocks.calibration.payload_identification import IdentifiedPayload, identify_payload


class PayloadMeasuring:
    """The recording, what follows from it, and the name of the tool.

    Args:
        viewer: Its page.
        line: Says why something is refused.
        file: Gives the frames file.
    """

    def __init__(self, viewer: Viewer, line: RefusalLine, file: Callable[[], Path]) -> None:
        self._viewer, self._line, self._file, text = viewer, line, file, viewer.texts
        self._found: IdentifiedPayload | None = None
        with ui.element('div').classes('guide payload-guide') as self.element:
            ui.label(text('frames.payload_hint')).classes('hint')
            with ui.element('div').classes('row-of-buttons'):
                self._buttons = [
                    ActionButton(
                        viewer, Action.OVERRIDE, text('frames.record'), 'fiber_manual_record', self._record
                    ),
                    ActionButton(
                        viewer, Action.OVERRIDE, text('frames.evaluate'), 'functions', self._evaluate
                    ),
                ]
                self._duration = ui.label().classes('number')
            self._shown = ui.label().classes('found number')
            self._shown.set_visibility(False)
            self._saved = SavedFrame(viewer, 'tool', line, file, self._save)

    async def _record(self) -> None:
        viewer = self._viewer

        def work() -> None:
            viewer.operator.desk.check(viewer.id)
            if viewer.operator.state.torque is None:
                raise NotPermittedError(Reason('no_torque'))
            viewer.operator.motion.start()

        if await viewer.do(self._line, work):
            self._show(None)

    async def _evaluate(self) -> None:
        viewer, found = self._viewer, list[IdentifiedPayload]()

        def work() -> None:
            viewer.operator.desk.check(viewer.id)
            operator, motion = viewer.operator, viewer.operator.motion
            motion.stop()
            if not motion.duration:
                raise NotPermittedError(Reason('none_recorded'))
            found.append(identify_payload(operator.robot, motion.samples()))

        await viewer.do(self._line, work)
        self._show(found[0] if found else None)

    def _save(self, name: str) -> None:
        if self._found is None:
            raise NotPermittedError(Reason('none_recorded'))
        self._viewer.operator.measuring.save_payload(self._file(), name, self._found)

    def _show(self, found: IdentifiedPayload | None) -> None:
        self._found = found
        self._shown.set_visibility(found is not None)
        if found is not None:
            self._shown.set_text(
                self._viewer.texts(
                    'frames.mass',
                    mass=f'{found.payload.mass:.3f}',
                    mass_std=f'{found.mass_std:.3f}',
                    std=f'{1e3 * found.center_std.max():.1f}',
                    **millimetres(found.payload.center),
                )
            )

    def refresh(self, _state: PendantState) -> None:
        """Show a state."""
        for button in self._buttons:
            button.refresh()
        self._saved.refresh()
        recording, text = self._viewer.operator.motion, self._viewer.texts
        self._duration.set_text(text('frames.recorded', duration=f'{recording.duration:.0f}'))
        self._duration.classes(
            add='recording' if recording.running else '', remove='' if recording.running else 'recording'
        )
