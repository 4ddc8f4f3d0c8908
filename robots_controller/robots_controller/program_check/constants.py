"""Numbers that a Lua text writes out: signed, and in radians by math.pi and math.rad."""

import math
import re
from collections.abc import Sequence
from typing import Final

from robots_controller.interpreter.lua_tokens import Token

_NUMBER: Final = r'((?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)'
_HEX: Final = re.compile(r'0[xX]')
_PI: Final = re.compile(rf'(?:{_NUMBER}\*)?math\.pi(?:\*{_NUMBER})?(?:/{_NUMBER})?')
_RAD: Final = re.compile(rf'math\.rad\((-?){_NUMBER}\)')


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
