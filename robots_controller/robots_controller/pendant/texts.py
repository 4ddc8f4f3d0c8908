"""Texts: what the operator's page says, in one file for each language."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import Any, Final

import yaml

from robots_controller.pendant.permissions import NotPermittedError
from robots_core.errors import InvalidInputError

LANGUAGES: Final[Mapping[str, str]] = {'en': 'English', 'de': 'Deutsch'}
"""Names by code; each has its file in `texts`."""
DEFAULT: Final = 'en'


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

    def error(self, error: Exception) -> str:
        """What an error says: reasons of the page in its language, those of nodes as they are."""
        if isinstance(error, NotPermittedError):
            return self(f'reasons.{error.reason.key}', **error.reason.values)
        return str(error)


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
