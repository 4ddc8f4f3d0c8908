"""Names in a robot program that nothing gives a value."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Final

from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS
from robots_controller.interpreter.lua_sandbox import lua_globals
from robots_controller.interpreter.lua_tokens import Token
from robots_controller.program_check.lua_calls import nesting
from robots_controller.program_check.other_languages import FUNCTIONS, INSTEAD, VALUES
from robots_core.wording.nearest_name import did_you_mean

FORBIDDEN: Final = frozenset({*INSTEAD, 'collectgarbage', 'debug', 'warn'})
"""Globals of Lua that programs do not have."""

LUA_GLOBALS: Final = frozenset({'_ENV', *lua_globals()}) - FORBIDDEN
"""What a program has of Lua's own."""

SHORTEST: Final = 3  # letters of a name that is compared with others
_GLOBAL_TABLES: Final = frozenset({'_ENV', '_G'})
_ATTRIBUTES: Final = frozenset({'const', 'close'})


def declared_names(tokens: Sequence[Token]) -> Iterator[str]:
    """Names that a program gives a value, once for each place: variables, parameters, functions."""
    open_brackets: list[str] = []
    behind = 0
    for i, token in enumerate(tokens):
        _follow(open_brackets, token)
        before = tokens[i - 1].text if i else ''
        if i < behind:
            continue
        if token.kind == 'keyword' and token.text in ('local', 'for', 'function'):
            behind = _behind_names(tokens, i + 1)
            yield from _names_among(tokens, i + 1, behind)
        elif token.kind == 'name' and (
            (before not in ('.', ':') and open_brackets[-1:] != ['{'])
            or (before == '.' and tokens[i - 2].text in _GLOBAL_TABLES)
        ):
            yield from _if_assigned(tokens, i)


def unknown_names(tokens: Sequence[Token], declared: Iterable[str]) -> Iterator[tuple[int, str]]:
    """Line and problem of each name that has no value, or that robot programs do not have."""
    known = {*declared, *LUA_FUNCTIONS, *LUA_GLOBALS}
    computed = any(_opens_globals(tokens, i) for i in range(len(tokens)))
    open_brackets: list[str] = []
    for i, token in enumerate(tokens):
        _follow(open_brackets, token)
        name = token.text
        if token.kind != 'name' or name in known or _is_no_variable(tokens, i, open_brackets):
            continue
        after = tokens[i + 1] if i + 1 < len(tokens) else Token('sign', '', token.line)
        if name in FORBIDDEN:
            instead = f'; {INSTEAD[name]}' if name in INSTEAD else ''
            yield token.line, f'{name} is not available in robot programs{instead}'
        elif after.text == '(' or (after.kind == 'string' and after.line == token.line):
            yield token.line, f'there is no function {name}{_meant(name, LUA_FUNCTIONS)}'
        elif not computed:
            yield token.line, f'{name} has no value: nothing gives it one{_meant(name, known)}'


def _follow(open_brackets: list[str], token: Token) -> None:
    change = nesting(token)
    if change > 0:
        open_brackets.append(token.text)
    elif change < 0 and open_brackets:
        open_brackets.pop()


def _behind_names(tokens: Sequence[Token], i: int) -> int:
    # local a <const>, b = ... | for i, v in | function name.field(a, b, ...) | function(a, b)
    signs = (',', '.', ':', '<', '>', '(', '...', 'function')
    while i < len(tokens) and (tokens[i].kind == 'name' or tokens[i].text in signs):
        i += 1
    return i


def _names_among(tokens: Sequence[Token], start: int, behind: int) -> Iterator[str]:
    for i in range(start, behind):
        if tokens[i].kind == 'name' and tokens[i - 1].text not in ('.', ':', '<'):
            yield tokens[i].text


def _if_assigned(tokens: Sequence[Token], i: int) -> Iterator[str]:
    # Alone or first in a list of names before an assignment: `a = `, `a, b =`.
    name = tokens[i].text
    while i + 2 < len(tokens) and tokens[i].kind == 'name' and tokens[i + 1].text == ',':
        i += 2
    if i + 1 < len(tokens) and tokens[i].kind == 'name' and tokens[i + 1].text == '=':
        yield name


def _is_no_variable(tokens: Sequence[Token], i: int, open_brackets: list[str]) -> bool:
    """A field, a label, or the attribute of a local variable."""
    before = tokens[i - 1].text if i else ''
    after = tokens[i + 1].text if i + 1 < len(tokens) else ''
    if before in ('.', ':', 'goto', '::'):
        return True
    if after == '=' and open_brackets[-1:] == ['{'] and before in ('{', ',', ';'):
        return True
    return before == '<' and after == '>' and tokens[i].text in _ATTRIBUTES


def _opens_globals(tokens: Sequence[Token], i: int) -> bool:
    """Variables may be given values by names that the program computes: `_G[name] = 1`."""
    after = tokens[i + 1].text if i + 1 < len(tokens) else ''
    return tokens[i].kind == 'name' and tokens[i].text in _GLOBAL_TABLES and after != '.'


def _meant(name: str, known: Iterable[str]) -> str:
    if name in VALUES:
        return f'; did you mean {VALUES[name]!r}?'
    if name.lower() in FUNCTIONS:
        return f'; robot programs have {FUNCTIONS[name.lower()]}'
    return did_you_mean(name, [] if len(name) < SHORTEST else known)
