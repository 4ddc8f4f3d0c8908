"""IoPanel: inputs and outputs by name and number."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Final

from nicegui import ui

from robots_controller.io.io_image import IMAGES, Channel
from robots_controller.pendant.page.elements import Changes, icon_button, mark, show_text
from robots_controller.pendant.page.viewer import Part, RefusalLine, Viewer
from robots_controller.pendant.pendant_state import PendantState, ShownIo
from robots_controller.pendant.permissions import Action

MOST_ROWS: Final = 16  # of each image
MOST_PENDING: Final = 3  # changes by a scripted PLC
# The lamp that the person saw: the output may have changed since.
WAS_ON: Final = """(event) => emit(
    event.currentTarget.closest('.channel').querySelector('.lamp').classList.contains('on'))"""


@dataclass
class _Row:
    """A channel, and the elements that show it."""

    channel: Channel
    lamp: ui.element
    value: ui.label
    forced: ui.element | None
    shown: tuple[float, bool] | None = None

    def show(self, value: float, *, forced: bool) -> None:
        if (value, forced) == self.shown:
            return
        self.shown = value, forced
        digital = self.channel.kind == 'digital'
        self.value.set_text(f'{value:.0f}' if digital else f'{value:g}')
        mark(self.lamp, 'on', on=digital and bool(value))
        if self.forced is not None:
            self.forced.set_visibility(forced)


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
        for time, line, inputs in state.plc.pending[:MOST_PENDING]:
            left, what = f'{max(0.0, time - now):.1f}', _inputs(inputs, state.io)
            yield self.text('plc.pending', time=left, what=what, line=line)


def _shown(found: list[Channel], forced: Collection[str]) -> list[Channel]:
    """The first channels of those found, and the forced ones."""
    return found[:MOST_ROWS] + [channel for channel in found[MOST_ROWS:] if channel.name in forced]


def _inputs(values: Mapping[str, float], io: ShownIo) -> str:
    return ', '.join(f'{io.label(name)} = {value:g}' for name, value in values.items())


class IoPanel(Part):
    """All channels, or those that a search finds; outputs are switched, inputs forced."""

    def __init__(self, viewer: Viewer) -> None:
        super().__init__(viewer)
        text = viewer.texts
        self._rows: list[_Row] = []
        self._found: dict[str, list[Channel]] = {}
        self._searched, self._changed = Changes(), Changes()
        with ui.element('div').classes('panel io-panel'):
            self._search = (
                ui.input(text('io.search')).props('dense outlined clearable debounce=200').classes('search')
            )
            self.line = RefusalLine()
            self._hint = ui.label().classes('hint warned')
            self._plc = PlcLine(viewer)
            self._columns = ui.element('div').classes('columns')

    def refresh(self, state: PendantState) -> None:
        """Show a state."""
        io = state.io
        self._plc.refresh(state)
        sizes = {key: len(one) for key, one in io.values.items()}
        part = str(self._search.value or '')
        if self._searched(part, io.labels, sizes):
            self._found = {image: io.found(image, part) for image in IMAGES}
        shown = {image: _shown(found, io.forced) for image, found in self._found.items()}
        # Nothing is built anew while it shows the same channels: a person may have opened a menu.
        if self._changed(shown, self._found):
            self._build(shown)
        for row in self._rows:
            channel = row.channel
            row.show(io.values[channel.image][channel.index - 1], forced=channel.name in io.forced)
        reason = self.viewer.reason(Action.SWITCH)
        show_text(self._hint, reason)
        mark(self._columns, 'blocked', on=bool(reason))

    def _build(self, shown: Mapping[str, list[Channel]]) -> None:
        self._rows = []
        self._columns.clear()
        with self._columns:
            for direction in ('input', 'output'):
                with ui.element('div').classes('column'):
                    ui.label(self.text(f'io.{direction}s')).classes('caption')
                    for kind in ('digital', 'analog'):
                        self._build_image(kind, shown[f'{kind}_{direction}s'], f'{kind}_{direction}s')

    def _build_image(self, kind: str, shown: list[Channel], image: str) -> None:
        ui.label(self.text(f'io.{kind}')).classes('subtitle')
        self._rows += [self._build_row(channel) for channel in shown]
        if not shown:
            ui.label(self.text('io.none')).classes('hint')
        if (hidden := len(self._found[image]) - len(shown)) > 0:
            ui.label(self.text('io.more', count=hidden)).classes('hint')

    def _build_row(self, channel: Channel) -> _Row:
        with ui.element('div').classes('channel'):
            digital = channel.kind == 'digital'
            lamp = ui.element('span').classes('lamp' if digital else 'no-lamp')
            ui.label(str(channel.index)).classes('number index')
            ui.label(channel.label).classes('label')
            forced = (
                ui.label(self.text('io.forced')).classes('forced') if channel.direction == 'input' else None
            )
            value = ui.label().classes('number value')
            if channel.direction == 'output':
                self._build_switch(channel)
            else:
                self._build_force(channel)
        return _Row(channel, lamp, value, forced)

    def _build_switch(self, channel: Channel) -> None:
        if channel.kind == 'digital':
            icon_button('toggle_on', channel.name).classes('switch').on(
                'click',
                lambda event: self.do(self.operator.set_output, channel, 0.0 if event.args else 1.0),
                js_handler=WAS_ON,
            )
            return
        with icon_button('edit', channel.name), ui.menu() as menu:
            self._build_entry(channel, menu, self.operator.set_output)

    def _build_force(self, channel: Channel) -> None:
        force = self.operator.force_input
        with icon_button('bolt', channel.name), ui.menu() as menu:
            if channel.kind == 'digital':
                ui.menu_item(self.text('io.force_on'), partial(self.do, force, channel, 1.0))
                ui.menu_item(self.text('io.force_off'), partial(self.do, force, channel, 0.0))
            else:
                self._build_entry(channel, menu, force)
            ui.menu_item(self.text('io.release'), partial(self.do, force, channel, None))

    def _build_entry(self, channel: Channel, menu: ui.menu, give: Callable[..., object]) -> None:
        entry = ui.number(channel.name).props('dense outlined').classes('entry')

        async def press() -> None:
            if entry.value is not None or channel.direction == 'input':  # which is released
                await self.do(give, channel, entry.value)
                menu.close()

        ui.button(self.text('io.set'), on_click=press).props('flat no-caps')
