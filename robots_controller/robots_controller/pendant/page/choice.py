"""Choice: a list on the page whose entries may change while a person chooses one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui import ui
from nicegui.events import GenericEventArguments


class Choice(ui.select):
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
