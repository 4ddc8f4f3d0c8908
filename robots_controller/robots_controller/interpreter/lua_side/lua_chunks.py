"""The Lua chunks of the sandbox, read from the files beside this one."""

from importlib.resources import files
from typing import Final

_PARTS: Final = ('stopping', 'snapshot', 'texts', 'calls', 'own_functions', 'library', 'run')


def _text(name: str) -> bytes:
    return (files(__package__) / f'{name}.lua').read_bytes()


PRELUDE: Final = b''.join(map(_text, _PARTS))
"""Builds the program's globals and runs the program in them: what a part declares, those behind it use."""

PATTERNS: Final = _text('patterns')
"""Pattern matching that can be stopped anywhere."""
