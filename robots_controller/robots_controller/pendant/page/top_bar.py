"""TopBar: what is always visible, and the stop button."""

from __future__ import annotations

from functools import partial
from typing import Final

from nicegui import ui

from robots_controller.pendant.page.elements import Choice, icon_button, mark, show_hint
from robots_controller.pendant.page.viewer import ActionButton, Part, RefusalLine, Viewer
from robots_controller.pendant.pendant_state import PendantState
from robots_controller.pendant.permissions import Action
from robots_controller.program.run_state import RunState
from robots_core.cell_interface.operating_modes import OperatingMode

STEP: Final = 5  # %, of the buttons beside the override
STATE_ICONS: Final = {
    'IDLE': 'radio_button_unchecked',
    'OPENED': 'task_alt',
    'RUNNING': 'play_arrow',
    'PAUSED': 'pause',
    'STOPPED': 'stop',
    'FINISHED': 'check',
    'FAILED': 'error',
}


class TopBar(Part):
    """Robot, mode, commander, program, override, speed, connection, who operates, and the stop button."""

    def __init__(self, viewer: Viewer) -> None:
        super().__init__(viewer)
        text = viewer.texts
        self._override = 100
        with ui.element('header').classes('bar'):
            with ui.element('div').classes('facts'):
                with ui.element('div').classes('fact robot'):
                    ui.label(viewer.operator.robot.name).classes('title')
                    with ui.element('span').classes('caption'):
                        self._link_icon = ui.icon('link')
                        self._link = ui.label()
                with ui.element('div').classes('fact'):
                    ui.label(text('bar.mode')).classes('caption')
                    self._mode = (
                        Choice([*OperatingMode])
                        .when_chosen(self._choose_mode)
                        .props(f'borderless aria-label="{text("bar.mode")}"', remove='outlined')
                        .classes('mode')
                    )
                self._commander = self._fact('bar.commander')
                with ui.element('div').classes('fact program'):
                    ui.label(text('bar.program')).classes('caption')
                    with ui.element('span').classes('value'):
                        self._program_icon = ui.icon('stop')
                        self._program = ui.label()
                self._speed = self._fact('bar.speed')
                self._build_override()
                self._build_tools()
            self._build_stop()
        with ui.element('div').classes('strip') as self._strip:
            ui.icon('report')
            self._fault = ui.label()
            ActionButton(
                viewer,
                Action.RESET,
                text('bar.reset'),
                'restart_alt',
                partial(self.do, viewer.operator.act, Action.RESET),
            )
        with ui.element('div').classes('strip forced-strip') as self._forced_strip:
            ui.icon('bolt')
            self._forced = ui.label()
        self.line = RefusalLine()

    def _fact(self, caption: str) -> ui.label:
        with ui.element('div').classes('fact'):
            ui.label(self.text(caption)).classes('caption')
            return ui.label().classes('value')

    def _build_override(self) -> None:
        with ui.element('div').classes('fact override'):
            with ui.element('span').classes('caption'):
                ui.label(self.text('bar.override'))
                self._override_value = ui.label('100 %').classes('number')
            with ui.element('div').classes('slider'):
                icon_button('remove', self.text('bar.slower'), partial(self._change_override, -STEP))
                self._slider = ui.slider(min=0, max=100, value=100).props(
                    f'aria-label="{self.text("bar.override")}"'
                )
                self._slider.on(
                    'update:model-value', lambda event: self._set_override(int(event.args)), throttle=0.05
                )
                icon_button('add', self.text('bar.faster'), partial(self._change_override, STEP))

    def _build_tools(self) -> None:
        with ui.element('div').classes('fact tools'):
            with ui.element('span').classes('caption'):
                self._control = ui.label()
            with ui.element('div').classes('row-of-buttons'):
                self._take = ui.button(
                    self.text('bar.take'), icon='front_hand', on_click=self._toggle_control, color=None
                )
                self._take.props('unelevated no-caps dense').classes('control')
                theme = icon_button('contrast', self.text('bar.theme'))
                theme.on('click', js_handler='() => pendant.switchTheme()')
                code = 'en' if self.text('bar.language') == 'English' else 'de'
                language = ui.button(self.text('bar.language'), color=None).props('flat dense no-caps')
                language.classes('language').on('click', js_handler=f"() => pendant.setLanguage('{code}')")
        with ui.dialog() as self._dialog, ui.card():
            ui.label(self.text('bar.confirm'))
            with ui.element('div').classes('row-of-buttons'):
                for key, result, style in (('yes', True, 'unelevated'), ('no', False, 'flat')):
                    submit = partial(self._dialog.submit, result)
                    ui.button(self.text(f'bar.confirm_{key}'), on_click=submit).props(f'{style} no-caps')

    def _build_stop(self) -> None:
        with ui.element('button').classes('stop').props('type=button') as stop:
            ui.label(self.text('bar.stop')).classes('word')
            ui.label('Esc').classes('key')
        stop.props(f'aria-label="{self.text("bar.stop")}"')
        show_hint(stop, self.text('bar.stop_hint'))
        # At the press, not at its end; and by the key, wherever the focus is.
        stop.on('pointerdown', self.operator.stop, args=[])
        ui.on('pendant_stop', self.operator.stop, args=[])

    # -- what is pressed ----------------------------------------------------------------------------------

    async def _choose_mode(self, mode: OperatingMode | None) -> None:
        operator = self.operator
        if mode not in (None, operator.state.mode):
            await self.do(operator.set_mode, mode)
            self._show_mode(operator.state)

    async def _change_override(self, step: int) -> None:
        await self._set_override(min(100, max(0, self._override + step)))

    async def _set_override(self, percent: int) -> None:
        operator = self.operator
        await self.do(operator.set_override, percent / 100.0)
        self._slider.value = round(100.0 * operator.state.override)

    async def _toggle_control(self) -> None:
        operator, viewer = self.operator, self.viewer
        if operator.desk.holder == viewer.id:
            operator.give_back_control(viewer.id)
        elif not operator.desk.holder or await self._dialog:
            await self.do(operator.take_control, address=viewer.address, from_other=True)

    # -- what is shown ------------------------------------------------------------------------------------

    def refresh(self, state: PendantState) -> None:
        """Show a state."""
        lost = bool(state.lost)
        self._link.set_text(
            self.text('bar.lost', lost=', '.join(state.lost)) if lost else self.text('bar.connected')
        )
        self._link_icon.set_name('link_off' if lost else 'link')
        mark(self._link_icon, 'bad', on=lost)
        mark(self._link_icon, 'good', on=not lost)
        self._show_mode(state)
        self._commander.set_text(self.text(f'commanders.{state.commander}'))
        program = state.program
        name = program.path.rpartition('/')[2]
        where = f', {self.text("bar.line", line=program.line)}' if program.line else ''
        open_ = program.state is not RunState.IDLE or not name
        doing = self.text(f'states.{program.state}' if open_ else 'bar.not_open')
        self._program.set_text(f'{name}{": " if name else ""}{doing}{where}')
        self._program_icon.set_name(STATE_ICONS[program.state])
        self._speed.set_text(f'{1e3 * state.tool_speed:.0f} mm/s')
        self._show_override(state)
        self._show_control()
        self._show_forced(state)
        self._strip.set_visibility(bool(state.fault))
        if state.fault:
            self._fault.set_text(self.text('bar.fault', fault=self.text.fault(state.fault_kind, state.fault)))

    def _show_forced(self, state: PendantState) -> None:
        """All forced inputs, whatever is in front."""
        names = (state.io.label(name) for name in sorted(state.io.forced))
        self._forced_strip.set_visibility(bool(state.io.forced))
        self._forced.set_text(self.text('bar.forced', inputs=', '.join(names)))

    def _show_mode(self, state: PendantState) -> None:
        if self._mode.value != state.mode:
            self._mode.set_value(state.mode)

    def _show_override(self, state: PendantState) -> None:
        percent = round(100.0 * state.override)
        if percent != self._override:
            self._override = percent
            self._override_value.set_text(f'{percent} %')
            self._slider.value = percent

    def _show_control(self) -> None:
        text, desk = self.text, self.operator.desk
        holder = desk.holder
        own = holder == self.viewer.id
        who = 'in_control' if own else 'others' if holder else 'nobody'
        self._control.set_text(text(f'bar.{who}', address=desk.address))
        self._take.set_text(text('bar.give_back' if own else 'bar.take'))
        mark(self._take, 'own', on=own)
