"""TrendPanel: chosen signals over the last minutes, recording, and the report of the last run."""

from __future__ import annotations

import time
from typing import Any, Final

from nicegui import ui

from robots_controller.pendant.page.elements import Choice, choices, mark, show_text
from robots_controller.pendant.page.viewer import Part, RefusalLine, Viewer
from robots_controller.pendant.pendant_state import PendantState
from robots_controller.pendant.trends import LONGEST, Signal

WINDOWS: Final = (30, 120, round(LONGEST))  # s
MOST_SIGNALS: Final = 8
DRAW_PERIOD: Final = 1.0  # s
REPORT: Final = '/report'
FIRST: Final = ('tool_speed',)
COLOURS: Final = (
    *('#00897b', '#d81b60', '#1e88e5', '#f4a300'),
    *('#8e24aa', '#6d8b00', '#e4572e', '#5c6bc0'),
)
DASHES: Final = ('solid', 'dashed')  # the second four have the colours of neighbours: dashes tell them apart
GREY: Final = '#8a979e'


class TrendPanel(Part):
    """A diagram for each unit, one below the other, on the same time axis."""

    def __init__(self, viewer: Viewer) -> None:
        super().__init__(viewer)
        text = viewer.texts
        self._drawn = 0.0
        self._known: tuple[Signal, ...] = ()
        self._recording = ''
        with ui.element('div').classes('panel trend-panel'):
            with ui.element('div').classes('row-of-buttons'):
                names = text('trends.signals')
                self._choice = Choice({}, label=names, multiple=True, with_input=True, on_change=self._limit)
                self._choice.props('use-chips').classes('signals')
            with ui.element('div').classes('row-of-buttons'):
                windows = {one: text('trends.window', seconds=one) for one in WINDOWS}
                self._window = choices(windows, WINDOWS[0], self._draw_soon).props('padding="4px 9px"')
                self._record = ui.button(text('trends.record'), on_click=self._toggle_record, color=None)
                self._record.props('unelevated no-caps icon=fiber_manual_record').classes('action record')
                ui.link(text('trends.report'), REPORT, new_tab=True).classes('report')
            self.line = RefusalLine()
            self._bag = ui.label().classes('hint')
            self._chart = ui.echart({'series': []}).classes('chart')

    def _draw_soon(self) -> None:
        self._drawn = 0.0

    def _limit(self) -> None:
        self._draw_soon()
        if len(self._choice.value) > MOST_SIGNALS:
            self.line.show(self.text('trends.too_many', most=MOST_SIGNALS))
            self._choice.set_value(self._choice.value[:MOST_SIGNALS])

    async def _toggle_record(self) -> None:
        recording = self.operator.recording
        # By what the button says: another page may have begun or ended a bag just now.
        change = recording.end if self._recording else recording.begin
        await self.do(lambda _: change())

    def refresh(self, _state: PendantState) -> None:
        """Draw the signals, once a second."""
        self._show_recording()
        now = time.monotonic()
        if now - self._drawn < DRAW_PERIOD:
            return
        self._drawn = now
        trends = self.operator.trends
        if trends.signals is not self._known:
            first = not self._known
            self._known = trends.signals
            names = {one.key: self._label(one) for one in self._known}
            chosen = FIRST if first else [key for key in self._choice.value if key in names]
            self._choice.set_options(names, value=[*chosen])
        self._chart.options.clear()
        self._chart.options.update(self._options())
        self._chart.update()

    def _show_recording(self) -> None:
        self._recording = self.operator.recording.bag
        on = bool(self._recording)
        self._record.set_text(self.text('trends.end' if on else 'trends.record'))
        mark(self._record, 'recording', on=on)
        show_text(self._bag, self.text('trends.recording', bag=self._recording) if on else '')

    def _label(self, signal: Signal) -> str:
        quantity = signal.key.split(' ')[0].split('.')[0]
        return f'{self.text(f"trends.{quantity}")} {signal.name}'.strip()

    def _options(self) -> dict[str, Any]:
        known = {one.key: one for one in self._known}
        chosen = [known[key] for key in self._choice.value if key in known]
        units = [*dict.fromkeys(one.unit for one in chosen)]
        height = 100.0 / max(1, len(units))
        grids, x_axes, y_axes, series = [], [], [], []
        for number, unit in enumerate(units):
            top = f'{number * height + 8.0:.1f}%'
            grids.append({'left': 62, 'right': 14, 'top': top, 'height': f'{height - 15.0:.1f}%'})
            last = number == len(units) - 1
            digital = all(one.key.startswith('digital') for one in chosen if one.unit == unit)
            x_axes.append(
                {
                    'type': 'value',
                    'gridIndex': number,
                    'min': -self._window.value,
                    'max': 0,
                    'axisLabel': {'show': last, 'formatter': '{value} s', 'color': GREY},
                    'axisLine': {'onZero': False},
                    'splitLine': {'show': False},
                }
            )
            y_axes.append(
                {
                    'type': 'value',
                    'gridIndex': number,
                    'name': unit,
                    'nameLocation': 'middle',
                    'nameGap': 42,
                    'scale': True,
                    'axisLine': {'onZero': False},  # time is 0 at the right end
                    'nameTextStyle': {'color': GREY},
                    'axisLabel': {'color': GREY},
                    'splitLine': {'lineStyle': {'color': GREY, 'opacity': 0.25}},
                    **({'min': 0, 'max': 1, 'interval': 1} if digital else {}),
                }
            )
        for number, one in enumerate(chosen):
            times, values = self.operator.trends.curve(one.key, self._window.value)
            series.append(
                {
                    'type': 'line',
                    'name': self._label(one),
                    'xAxisIndex': units.index(one.unit),
                    'yAxisIndex': units.index(one.unit),
                    'showSymbol': False,
                    'step': 'end' if one.key.startswith('digital') else False,
                    'lineStyle': {'width': 2, 'type': DASHES[number // 4]},
                    'color': COLOURS[number],
                    'data': [[round(t, 2), float(f'{v:.6g}')] for t, v in zip(times, values, strict=True)],
                }
            )
        return {
            'animation': False,
            'grid': grids,
            'xAxis': x_axes,
            'yAxis': y_axes,
            'series': series,
            'legend': {'top': 0, 'type': 'scroll', 'textStyle': {'color': GREY}},
            'tooltip': {'trigger': 'axis'},
        }
