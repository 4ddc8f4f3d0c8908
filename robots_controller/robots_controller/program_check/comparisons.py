"""Comparisons of a robot function's result with a value that it never has."""

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Final

from robots_controller.interpreter.functions.lua_function import LuaFunction
from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS
from robots_controller.interpreter.lua_tokens import Token
from robots_controller.program_check.lua_calls import Call, lua_calls
from robots_controller.program_check.program_names import declared_names

_RESULTS: Final = {'boolean': 'true or false', 'number': 'a number', 'number[]': 'a table', 'Pose': 'a pose'}
_COMPARISONS: Final = {'==': 'false', '~=': 'true'}
_UNARY: Final = frozenset({'#', '-', '~', 'not'})
_ENDS: Final = frozenset({'==', '~=', '<', '>', '<=', '>=', '..', '[', '.', ':', '(', '{'})


def comparisons_of_unlike_values(
    tokens: Sequence[Token], declared: Collection[str]
) -> Iterator[tuple[int, str]]:
    """Line and problem of each comparison that has one outcome, whatever the robot's function returns.

    As `getDigitalInput(1) == 1`: true and 1 are different values in Lua. A variable counts as its function
    where `local name = getDigitalInput(1)` is all that gives it a value. A function whose name the program
    declares is none of the robot's.
    """
    calls = [
        call
        for call in lua_calls(tokens)
        if call.name.text in LUA_FUNCTIONS and call.name.text not in declared
    ]
    for call in calls:
        yield from _wrong(tokens, call.start, call.end, LUA_FUNCTIONS[call.name.text], call.name.text)
    variables = dict(_variables(tokens, calls))
    for i, token in enumerate(tokens):
        if token.kind == 'name' and token.text in variables and _text(tokens, i - 1) not in ('.', ':'):
            function = variables[token.text]
            yield from _wrong(tokens, i, i, function, f'{token.text}, from {function.name},')


def _variables(tokens: Sequence[Token], calls: Sequence[Call]) -> Iterator[tuple[str, LuaFunction]]:
    times: Mapping[str, int] = Counter(declared_names(tokens))
    for call in calls:
        if [_text(tokens, call.start - 1), _text(tokens, call.start - 3)] != ['=', 'local']:
            continue
        name, after = _text(tokens, call.start - 2), tokens[call.end + 1 : call.end + 2]
        # The value is the call's alone where a new statement begins behind it.
        if times[name] == 1 and (not after or after[0].kind == 'name' or _begins(after[0])):
            yield name, LUA_FUNCTIONS[call.name.text]


def _begins(token: Token) -> bool:
    return token.text == ';' or (token.kind == 'keyword' and token.text not in ('and', 'or'))


def _wrong(
    tokens: Sequence[Token], start: int, end: int, function: LuaFunction, what: str
) -> Iterator[tuple[int, str]]:
    result = _RESULTS.get(function.result_type)
    if result is None:
        return
    left, right = _text(tokens, start - 1), _text(tokens, end + 1)
    if left in _UNARY:  # another value is compared
        return
    if right in _COMPARISONS:
        other, operator = tokens[end + 2 : end + 3], right
    elif left in _COMPARISONS and right not in _ENDS and _text(tokens, start - 3) not in _COMPARISONS:
        other, operator = tokens[start - 2 : start - 1], left
    else:
        return
    if not other or (kind := _kind(other[0])) is None or kind == function.result_type:
        return
    shown = f"'{other[0].text}'" if other[0].kind == 'string' else other[0].text
    yield (
        other[0].line,
        f'{what} {operator} {shown} is always {_COMPARISONS[operator]}: {function.name} returns {result}',
    )


def _kind(token: Token) -> str | None:
    if token.kind in ('number', 'string'):
        return token.kind
    return 'boolean' if token.kind == 'keyword' and token.text in ('true', 'false') else None


def _text(tokens: Sequence[Token], i: int) -> str:
    return tokens[i].text if 0 <= i < len(tokens) else ''
