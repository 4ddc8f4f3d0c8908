"""Elements that several panels of the page are made of."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui import ui


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


def show_text(label: ui.label | ui.tooltip, text: str) -> None:
    """Show a text; a label without one is hidden."""
    label.set_text(text)
    label.set_visibility(bool(text))


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
