"""Calls and values in the tokens of a Lua text."""

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from robots_controller.interpreter.lua_tokens import Token

_OPEN, _CLOSE = frozenset('([{'), frozenset(')]}')
_BLOCKS: Final = frozenset({'function', 'do', 'then', 'repeat'})
_NUMBER: Final = r'((?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)'
_HEX: Final = re.compile(r'0[xX]')
_PI: Final = re.compile(rf'(?:{_NUMBER}\*)?math\.pi(?:\*{_NUMBER})?(?:/{_NUMBER})?')
_RAD: Final = re.compile(rf'math\.rad\((-?){_NUMBER}\)')


@dataclass(frozen=True)
class Call:
    """A call of a function by its name: the tokens of each argument, and its place among all tokens."""

    name: Token
    arguments: list[list[Token]]
    start: int
    end: int


def lua_calls(tokens: Sequence[Token]) -> Iterator[Call]:
    """The calls of functions that are variables: not of fields, not definitions."""
    for i, token in enumerate(tokens[:-1]):
        if token.kind != 'name' or (i and tokens[i - 1].text in ('.', ':', 'function')):
            continue
        after = tokens[i + 1]
        end = closing(tokens, i + 1)
        if after.kind == 'string':
            yield Call(token, [[after]], i, i + 1)
        elif after.text == '{':
            yield Call(token, [list(tokens[i + 1 : end + 1])], i, end)
        elif after.text == '(':
            yield Call(token, split_values(tokens[i + 2 : end]), i, end)


def closing(tokens: Sequence[Token], start: int) -> int:
    """Place of the bracket that closes the one at `start`; the number of tokens if there is none."""
    depth = 0
    for i in range(start, len(tokens)):
        depth += nesting(tokens[i], blocks=False)
        if not depth:
            return i
    return len(tokens)


def split_values(tokens: Sequence[Token], separators: str = ',') -> list[list[Token]]:
    """A list of values in its parts; [] if there are none."""
    parts: list[list[Token]] = [[]]
    depth = 0
    for token in tokens:
        depth += nesting(token)
        if token.kind == 'sign' and token.text in separators and not depth:
            parts.append([])
        else:
            parts[-1].append(token)
    return parts if any(parts) else []


def nesting(token: Token, *, blocks: bool = True) -> int:
    """1 if a token opens a bracket (or a block), -1 if it closes one."""
    if token.kind == 'sign':
        return (token.text in _OPEN) - (token.text in _CLOSE)
    if token.kind == 'keyword' and blocks:
        return (token.text in _BLOCKS) - (token.text in ('end', 'until', 'elseif'))
    return 0


def table_fields(tokens: Sequence[Token]) -> dict[str, list[Token]]:
    """Fields `name = value` of a table that is written out, braces included; others are left out."""
    fields: dict[str, list[Token]] = {}
    for part in split_values(tokens[1:-1], ',;'):
        if len(part) > 2 and part[0].kind == 'name' and part[1].text == '=':
            fields[part[0].text] = part[2:]
    return fields


def is_table(tokens: Sequence[Token]) -> bool:
    """One table that is written out."""
    return bool(tokens) and tokens[0].text == '{' and closing(tokens, 0) == len(tokens) - 1


def constant(tokens: Sequence[Token]) -> float | None:
    """The number that tokens write out; None for what is computed otherwise."""
    text = ''.join(token.text for token in tokens if token.kind in ('number', 'name', 'sign'))
    if not text or len(text) < sum(len(token.text) for token in tokens):
        return None
    sign = -1.0 if text[0] == '-' else 1.0
    text = text.removeprefix('-')
    if len(tokens) <= 1 + (sign < 0.0) and tokens[-1].kind == 'number':
        return sign * _number(text)
    if found := _PI.fullmatch(text):
        times, more, parts = (1.0 if group is None else float(group) for group in found.groups())
        return sign * times * math.pi * more / parts if parts else None
    if found := _RAD.fullmatch(text):
        return sign * (-1.0 if found[1] else 1.0) * math.radians(float(found[2]))
    return None


def _number(text: str) -> float:
    try:
        return float.fromhex(text) if _HEX.match(text) else float(text)
    except (ValueError, OverflowError):
        return math.inf
