"""Tokens of a Lua text, for what must be known of a program without running it."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Literal

_TOKEN: Final = re.compile(
    r"""(?P<space>\s+|--\[(?P<c>=*)\[.*?\](?P=c)\]|--[^\n]*)
      | (?P<long>\[(?P<s>=*)\[.*?\](?P=s)\])
      | (?P<string>"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*')
      | (?P<name>[A-Za-z_][A-Za-z0-9_]*)
      | (?P<number>0[xX][0-9a-fA-F.]+(?:[pP][+-]?\d+)?|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)
      | (?P<sign>\.\.\.|\.\.|==|~=|<=|>=|//|::|<<|>>|.)""",
    re.DOTALL | re.VERBOSE,
)
KEYWORDS: Final = frozenset(
    [
        'and',
        'break',
        'do',
        'else',
        'elseif',
        'end',
        'false',
        'for',
        'function',
        'goto',
        'if',
        'in',
        'local',
        'nil',
        'not',
        'or',
        'repeat',
        'return',
        'then',
        'true',
        'until',
        'while',
    ]
)

TokenKind = Literal['name', 'keyword', 'string', 'number', 'sign']


@dataclass(frozen=True)
class Token:
    """One piece of a Lua text.

    Attributes:
        kind: What it is.
        text: Its characters; of a string those between the quotes.
        line: Counted from 1.
        start: Where it begins in the text.
    """

    kind: TokenKind
    text: str
    line: int
    start: int = 0


def lua_tokens(text: str) -> Iterator[Token]:
    """The tokens of a text, without space and comments; behind a syntax error they are a guess."""
    line = 1
    for piece in _TOKEN.finditer(text):
        found = piece.group()
        if piece['long'] is not None:
            inner = found.split('[', 2)[2].rsplit(']', 2)[0].removeprefix('\n')
            yield Token('string', inner, line, piece.start())
        elif piece['string'] is not None:
            yield Token('string', found[1:-1], line, piece.start())
        elif piece['name'] is not None:
            yield Token('keyword' if found in KEYWORDS else 'name', found, line, piece.start())
        elif piece['space'] is None:
            yield Token('number' if piece['number'] is not None else 'sign', found, line, piece.start())
        line += found.count('\n')
