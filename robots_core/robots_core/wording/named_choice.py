"""NamedChoice: an enumeration whose names come from users and messages."""

import re
from enum import StrEnum
from typing import NoReturn

from robots_core.errors import InvalidInputError


class NamedChoice(StrEnum):
    """Another name than those of its members is refused, with those that are valid."""

    @classmethod
    def _missing_(cls, value: object) -> NoReturn:
        words = re.sub(r'(?<!^)(?=[A-Z])', ' ', cls.__name__).lower()
        raise InvalidInputError(f'unknown {words} {value!r}; valid are {", ".join(cls)}')
