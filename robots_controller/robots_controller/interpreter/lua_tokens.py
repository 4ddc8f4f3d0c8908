"""Tokens of a Lua text, for what must be known of a program without running it."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final, Literal

_TOKEN: Final = re.compile(
    r"""(?P<space>\s+|--\[(?P<c>=*)\[.*?\](?P=c)\]|--[^\n]*)
      | (?P<long>\[(?P<s>=*)\[.*?\](?P=s)\])
      | (?P<string>"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*')
      | (?P<keyword>(?:and|break|do|else|elseif|end|false|for|function|goto|if|in|local|nil|not|or|repeat
          |return|then|true|until|while)(?![A-Za-z0-9_]))
      | (?P<name>[A-Za-z_][A-Za-z0-9_]*)
      | (?P<number>0[xX][0-9a-fA-F.]+(?:[pP][+-]?\d+)?|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)
      | (?P<sign>\.\.\.|\.\.|==|~=|<=|>=|//|::|<<|>>|.)""",
    re.DOTALL | re.VERBOSE,
)

TokenKind = Literal['name', 'keyword', 'string', 'number', 'sign']


@dataclass(frozen=True)
class Token:
    """One piece of a Lua text.

    Attributes:
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
        kind: Any = piece.lastgroup
        found = piece.group()
        if kind == 'long':
            inner = found.split('[', 2)[2].rsplit(']', 2)[0].removeprefix('\n')
            yield Token('string', inner, line, piece.start())
        elif kind != 'space':
            yield Token(kind, found[1:-1] if kind == 'string' else found, line, piece.start())
        line += found.count('\n')
