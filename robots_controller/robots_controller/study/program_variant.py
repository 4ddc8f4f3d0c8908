"""Program variants: a robot program with another speed and other values of its parameters."""

import re
from collections.abc import Mapping
from typing import Final

from robots_core.errors import InvalidInputError
from robots_core.wording.nearest_name import did_you_mean

Value = float | bool | str
"""What a parameter of a program can be."""

EXACT: Final = 2.0**53  # whole numbers below it are exact
_LITERAL: Final = r'-?\d[\w.]*|true|false|"[^"\n]*"|\'[^\'\n]*\''
_ASSIGNMENT: Final = re.compile(
    r'^(?P<head>(?:local[ \t]+)?)(?P<names>[A-Za-z_]\w*(?:[ \t]*,[ \t]*[A-Za-z_]\w*)*)[ \t]*=[ \t]*'
    rf'(?P<values>(?:{_LITERAL})(?:[ \t]*,[ \t]*(?:{_LITERAL}))*)'
    r'(?=[ \t\r]*(?:$|;|--))',
    re.MULTILINE,
)
# Comments and texts of several lines: what stands there is not run.
_LONG: Final = re.compile(r'(?:--)?\[(?P<s>=*)\[.*?\](?P=s)\]', re.DOTALL)
_VALUE: Final = re.compile(_LITERAL)


def program_parameters(text: str) -> tuple[str, ...]:
    """Parameters of a program: names that it gives a number, text or switch, at the beginning of a line."""
    names: dict[str, None] = {}
    for found in _ASSIGNMENT.finditer(_run(text)):
        names |= dict.fromkeys(_names(found)[: len(_VALUE.findall(found['values']))])
    return tuple(names)


def program_variant(text: str, file: str, *, override: float, parameters: Mapping[str, Value]) -> str:
    """The text of a program with its parameters replaced; lines keep their numbers.

    A parameter is replaced where the program first gives it a value. The override holds from the program's
    start until the program sets another one.

    Args:
        text: The program.
        file: Its name, for errors.
        override: Speed override, 0..1.
        parameters: New values by name.

    Raises:
        InvalidInputError: the program has no such parameter.
    """
    for name, value in parameters.items():
        text = _replaced(text, file, name, value)
    return text if override == 1.0 else f'setOverride({override!r}) {text}'


def _replaced(text: str, file: str, name: str, value: Value) -> str:
    for found in _ASSIGNMENT.finditer(_run(text)):
        values = list(_VALUE.finditer(found['values']))
        names = _names(found)
        if name in names and names.index(name) < len(values):
            old = values[names.index(name)]
            start = found.start('values') + old.start()
            return f'{text[:start]}{_lua(value)}{text[start + len(old.group()) :]}'
    there = program_parameters(text)
    hint = did_you_mean(name, there) or f'; it has {", ".join(there) or "none"}'
    raise InvalidInputError(
        f'{file} has no parameter {name!r}: no line begins with `{name} = value` or '
        f'`local {name} = value`{hint}'
    )


def _run(text: str) -> str:
    """The text with blanks where it is not run, of the same length."""
    return _LONG.sub(lambda found: re.sub(r'[^\n]', ' ', found.group()), text)


def _names(found: re.Match[str]) -> list[str]:
    return [name.strip() for name in found['names'].split(',')]


def _lua(value: Value) -> str:
    if isinstance(value, bool):
        return 'true' if value else 'false'
    if isinstance(value, str):
        return f'"{"".join(map(_character, value))}"'
    # 2 stays 2: a program may count with it, or print it.
    return str(int(value)) if value.is_integer() and abs(value) < EXACT else repr(value)


def _character(text: str) -> str:
    if text in '"\\':
        return f'\\{text}'
    return text if text.isprintable() else ''.join(f'\\{byte:03d}' for byte in text.encode())
