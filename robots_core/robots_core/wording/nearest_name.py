"""The name that was meant by one that does not exist."""

from collections.abc import Iterable
from difflib import get_close_matches
from typing import Final

SIMILAR: Final = 0.65  # of two names' letters, in order


def nearest_name(name: str, known: Iterable[str]) -> str | None:
    """The known name that is most like `name`, in letters of any case; None if none is similar."""
    by_lower = {one.lower(): one for one in known}
    found = get_close_matches(name.lower(), by_lower, n=1, cutoff=SIMILAR)
    return by_lower[found[0]] if found else None


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """`; did you mean 'x'?` for the end of a message; nothing if no known name is similar."""
    found = nearest_name(name, known)
    return '' if found is None else f'; did you mean {found!r}?'
