"""Texts: what the operator's page says, in one file for each language."""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import suppress
from functools import cache
from importlib.resources import files
from typing import Any, Final

import yaml

from robots_controller.pendant.permissions import NotPermittedError
from robots_core.errors import InvalidInputError, ProgramError, RobotsError

LANGUAGES: Final[Mapping[str, str]] = {'en': 'English', 'de': 'Deutsch'}
"""Names by code; each has its file in `texts`."""
DEFAULT: Final = 'en'
NAMED: Final = {'commander': 'commanders', 'state': 'states'}
"""Values of reasons that have texts of their own, with their section."""
SHOWN_UNITS: Final[Mapping[str, tuple[float, int]]] = {
    'mm': (1e3, 2),
    'kg': (1.0, 3),
    's': (1.0, 1),
    '%': (100.0, 0),
    '°': (math.degrees(1.0), 1),
}
"""Of quantities in SI: the factor, and digits behind the point."""


class Texts:
    """The texts of one language.

    Args:
        texts: By key; those of a section have its name before theirs, such as 'reasons.lost'.
    """

    def __init__(self, texts: Mapping[str, str]) -> None:
        self.texts: Final = texts

    def __call__(self, key: str, **values: Any) -> str:
        """The text of a key with its values."""
        return self.texts[key].format(**values)

    def fault(self, kind: str, fault: str) -> str:
        """Why the robot is stopped: the kind of fault in this language, and what the controller says."""
        named = self.texts.get(f'faults.{kind}')
        return fault if named is None else f'{named} ({fault})'

    def _reason(self, error: NotPermittedError) -> str:
        values = dict(error.details)
        for name, section in NAMED.items():
            values[name] = self.texts.get(f'{section}.{values.get(name)}', values.get(name, ''))
        values['fault'] = self.fault(str(values.get('fault_kind', '')), str(values.get('fault', '')))
        return self(f'reasons.{error.message}', **values)

    def error(self, error: RobotsError) -> str:
        """What an error says in this language; in English where there is no text for its key or code."""
        if isinstance(error, NotPermittedError):
            return self._reason(error)
        unit = error.details.get('unit', '')
        facts = {name: _Fact(value, unit) for name, value in error.details.items()}
        for key in (f'errors.{error.code}_{error.details.get("key")}', f'errors.{error.code}'):
            if (text := self.texts.get(key)) is not None:
                with suppress(KeyError):  # a node of another version may send other facts
                    return f'{_place(error)}{text.format(message=error.message, **facts)}'
        return str(error)


class _Fact:
    """A detail of an error, which a text shows in the unit that it names: `{residual:mm}`."""

    def __init__(self, value: str | float, unit: str | float) -> None:
        self._value, self._unit = value, unit

    def __format__(self, shown: str) -> str:
        if not shown:
            return str(self._value)
        if shown == 'axis':  # turns or slides
            shown = '°' if self._unit == 'rad' else 'mm'
        scale, digits = SHOWN_UNITS[shown]
        return f'{scale * float(self._value):.{digits}f}{"" if shown == "°" else " "}{shown}'


def _place(error: RobotsError) -> str:
    if not isinstance(error, ProgramError) or not error.file:
        return ''
    return f'{error.file}:{error.line}: ' if error.line else f'{error.file}: '


@cache
def read_texts(language: str) -> Texts:
    """The texts of a language.

    Raises:
        InvalidInputError: there are none.
    """
    if language not in LANGUAGES:
        raise InvalidInputError(f'language {language!r} is unknown; valid are {", ".join(LANGUAGES)}')
    path = files('robots_controller.pendant') / 'texts' / f'{language}.yaml'
    found: dict[str, str] = {}
    for section, texts in yaml.safe_load(path.read_text('utf-8')).items():
        found |= {f'{section}.{key}': text for key, text in texts.items()}
    return Texts(found)


def preferred_language(header: str) -> str:
    """The language that a browser prefers, by its header Accept-Language, among those that there are."""
    for part in header.split(','):
        code = part.partition(';')[0].strip().partition('-')[0].lower()
        if code in LANGUAGES:
            return code
    return DEFAULT
