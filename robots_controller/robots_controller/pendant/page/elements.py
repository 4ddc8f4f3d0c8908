"""Elements that several panels of the page are made of."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui import ui
from nicegui.events import GenericEventArguments


class Changes:
    """Notices whether values are others than the last time."""

    def __init__(self) -> None:
        self._last: tuple[object, ...] | None = None

    def __call__(self, *values: object) -> bool:
        """The values are others than those of the last call, or the first ones."""
        changed, self._last = values != self._last, values
        return changed

    def forget(self) -> None:
        """Take the next values for others."""
        self._last = None


def mark(element: ui.element, name: str, *, on: bool) -> None:
    """Give an element a class of the style sheet, or take it away."""
    element.classes(add=name if on else '', remove='' if on else name)


def show_text(label: ui.label, text: str) -> None:
    """Show a text; a label without one is hidden."""
    label.set_text(text)
    label.set_visibility(bool(text))


def show_hint(element: ui.element, text: str) -> None:
    """Show a text beside an element while the mouse points to it; '' for none.

    The browser shows it. While a tooltip of Quasar opens, Quasar delays giving the focus back to a list that
    was just used, and then takes it from the text field in which a person has begun to type.
    """
    element.props['title'] = text


def text_button(text: str, icon: str, press: Callable[[], object]) -> ui.button:
    """A button with an icon and a text; what is called when it is pressed may be a coroutine."""
    button = ui.button(text, icon=icon, on_click=press, color=None)
    return button.props('unelevated no-caps').classes('action')


def icon_button(icon: str, label: str, press: Callable[[], object] | None = None) -> ui.button:
    """A round button with an icon, and a label for those who do not see it."""
    button = ui.button(icon=icon, on_click=press, color=None)
    return button.props(f'flat dense round aria-label="{label}"')


def held_button(key: str, icon: str, text: str) -> ui.element:
    """A button that acts while it is held; see `HeldButton`."""
    with ui.element('button').classes('hold').props(f'type=button data-press="{key}"') as button:
        ui.icon(icon)
        ui.label(text)
    return button


def choices(options: dict[Any, str], first: object, chosen: Callable[[], object] | None = None) -> ui.toggle:
    """Buttons of which one is chosen, at first this; calls when another one is."""
    return ui.toggle(options, value=first, on_change=chosen).props('unelevated no-caps')


class Choice(ui.select, default_props='dense outlined options-dense'):
    """A list in which a person chooses the entry that the browser has shown.

    The browser sends the index of an entry and its text. The index is that of another entry if the list has
    changed since it was shown: the text counts. An entry that is gone is not chosen.
    """

    def _event_args_to_value(self, event: GenericEventArguments) -> Any:
        chosen = event.args if self.multiple else [event.args]
        labels = [*self.options.values()] if isinstance(self.options, dict) else self.options
        found = [
            one | {'value': labels.index(one['label'])} if isinstance(one, dict) else one
            for one in chosen or ()
            if not isinstance(one, dict) or one['label'] in labels
        ]
        event.args = found if self.multiple else (found or [None])[0]
        return super()._event_args_to_value(event)

    def when_chosen(self, act: Callable[[Any], object]) -> Choice:
        """Call this with what a person chooses, but not with what the page shows; it may be a coroutine."""
        return self.on('update:model-value', lambda event: act(self._event_args_to_value(event)))

    def when_opened(self, read: Callable[[], list[str] | dict[str, str]]) -> Choice:
        """Show the entries that this reads whenever the list is opened."""
        for event in ('click', 'popup-show'):  # one without entries opens no popup
            self.on(event, lambda: self.show(read()), args=[])
        return self

    def show(self, options: list[str] | dict[str, str]) -> None:
        """Show other entries.

        What was chosen stays if it is among them; otherwise the entry '' is chosen, if there is one.
        """
        if options != self.options:  # a list that is sent again may lose a click on it
            kept = self.value if self.value in options else ''
            self.set_options(options, value=kept if kept in options else None)
