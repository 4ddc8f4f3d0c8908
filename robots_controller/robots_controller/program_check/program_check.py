"""check_program: what is wrong with a robot program, without running it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from robots_controller.interpreter.lua_arguments import Sizes, valid_text, wanted_arguments
from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS, LuaFunction
from robots_controller.interpreter.lua_sandbox import syntax_error
from robots_controller.interpreter.lua_source import LuaSource, check_syntax, read_source
from robots_controller.interpreter.lua_tokens import Token, lua_tokens
from robots_controller.interpreter.program_run import find_subprogram
from robots_core.errors import ProgramError

LUA_GLOBALS: Final = frozenset(
    [
        '_G',
        '_VERSION',
        'assert',
        'coroutine',
        'error',
        'getmetatable',
        'ipairs',
        'math',
        'next',
        'pairs',
        'pcall',
        'rawequal',
        'rawget',
        'rawlen',
        'rawset',
        'select',
        'setmetatable',
        'string',
        'table',
        'tonumber',
        'tostring',
        'type',
        'utf8',
        'xpcall',
    ]
)
"""What a program has of Lua's own."""

FORBIDDEN: Final = frozenset(
    [
        'collectgarbage',
        'debug',
        'dofile',
        'io',
        'load',
        'loadfile',
        'loadstring',
        'os',
        'package',
        'require',
        'warn',
    ]
)
_OPEN, _CLOSE = frozenset('([{'), frozenset(')]}')
_BLOCKS: Final = frozenset({'function', 'do', 'then', 'repeat'})


@dataclass(frozen=True)
class ProgramProblem:
    """Something that is wrong.

    Attributes:
        file: The program or subprogram.
        line: Counted from 1, 0 for the whole file.
        reason: What, and what would be valid.
    """

    file: str
    line: int
    reason: str

    def __str__(self) -> str:
        return f'{self.file}:{self.line}: {self.reason}' if self.line else f'{self.file}: {self.reason}'


@dataclass
class _Checked:
    sources: dict[str, tuple[LuaSource, list[Token]]] = field(default_factory=dict)
    problems: list[ProgramProblem] = field(default_factory=list)


def check_program(path: Path | str, sizes: Sizes) -> tuple[ProgramProblem, ...]:
    """Check a program and its subprograms.

    Found are errors of syntax, functions that do not exist, wrong numbers of arguments, indices and words
    that are not valid, and subprograms that are not there. What a program computes is not known: of such
    arguments nothing is said.

    Args:
        path: The program.
        sizes: The robot's axes and the numbers of inputs and outputs.

    Returns:
        What is wrong, by file and line; empty if nothing was found.
    """
    checked = _Checked()
    try:
        main = read_source(path)
        check_syntax(main, lambda text: syntax_error(main, text))
    except ProgramError as error:
        return (ProgramProblem(error.file, error.line, error.reason),)
    _collect(main, main, checked)
    declared = {name for _, tokens in checked.sources.values() for name in _declared(tokens)}
    for source, tokens in checked.sources.values():
        checked.problems += _unknown_names(source, tokens, declared)
        checked.problems += _wrong_calls(source, tokens, sizes, declared)
    return tuple(sorted(checked.problems, key=lambda problem: (problem.file, problem.line)))


def _collect(main: LuaSource, source: LuaSource, checked: _Checked) -> None:
    tokens = list(lua_tokens(source.text))
    checked.sources[source.file] = (source, tokens)
    for call in _calls(tokens):
        if call.name.text != 'call' or not call.arguments or len(call.arguments[0]) != 1:
            continue
        (token,) = call.arguments[0]
        if token.kind != 'string':
            continue
        try:
            subprogram = find_subprogram(main, token.text)
        except ProgramError as error:
            checked.problems.append(ProgramProblem(source.file, token.line, f'call: {error}'))
            continue
        if subprogram.file not in checked.sources:
            _collect(main, subprogram, checked)


# -- names --------------------------------------------------------------------------------------------


def _declared(tokens: list[Token]) -> Iterator[str]:
    """Names that the program gives a value somewhere: variables, parameters, functions."""
    braces = 0
    for i, token in enumerate(tokens):
        text, before = token.text, tokens[i - 1].text if i else ''
        braces += (text == '{') - (text == '}') if token.kind == 'sign' else 0
        if token.kind == 'keyword' and text in ('local', 'for', 'function'):
            yield from _names_after(tokens, i + 1)
        elif token.kind == 'name' and before not in ('.', ':'):
            after = tokens[i + 1].text if i + 1 < len(tokens) else ''
            # Inside braces `name =` is a field; functions in tables have their own statements.
            if (after == '=' and not braces) or (after == ',' and _is_assigned(tokens, i)):
                yield text


def _names_after(tokens: list[Token], i: int) -> Iterator[str]:
    # local a <const>, b = ... | for i, v in | function name.field(a, b, ...) | function(a, b)
    while i < len(tokens):
        token = tokens[i]
        if token.kind == 'name' and tokens[i - 1].text not in ('.', ':', '<'):
            yield token.text
        elif not (token.kind == 'name' or token.text in (',', '.', ':', '<', '>', '(', '...', 'function')):
            return
        i += 1


def _is_assigned(tokens: list[Token], i: int) -> bool:
    # A list of names before an assignment: `a, b =`.
    while i + 1 < len(tokens) and tokens[i].kind == 'name' and tokens[i + 1].text == ',':
        i += 2
    return i + 1 < len(tokens) and tokens[i].kind == 'name' and tokens[i + 1].text == '='


def _unknown_names(source: LuaSource, tokens: list[Token], declared: set[str]) -> Iterator[ProgramProblem]:
    for i, token in enumerate(tokens):
        if token.kind != 'name' or (i and tokens[i - 1].text in ('.', ':', 'goto', '::')):
            continue
        name, after = token.text, tokens[i + 1] if i + 1 < len(tokens) else None
        if name in declared or name in LUA_FUNCTIONS or name in LUA_GLOBALS:
            continue
        if name in FORBIDDEN:
            yield ProgramProblem(source.file, token.line, f'{name} is not available in robot programs')
        elif after is not None and (
            after.text == '(' or (after.kind == 'string' and after.line == token.line)
        ):
            similar = [one for one in LUA_FUNCTIONS if one.lower() == name.lower()]
            hint = f'; meant is {similar[0]}' if similar else ''
            yield ProgramProblem(source.file, token.line, f'there is no function {name}{hint}')


# -- calls --------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Call:
    name: Token
    arguments: list[list[Token]]


def _calls(tokens: list[Token]) -> Iterator[_Call]:
    for i, token in enumerate(tokens[:-1]):
        if token.kind != 'name' or (i and tokens[i - 1].text in ('.', ':', 'function')):
            continue
        after = tokens[i + 1]
        if after.kind == 'string':
            yield _Call(token, [[after]])
        elif after.text == '{':
            yield _Call(token, [tokens[i + 1 : _end(tokens, i + 1) + 1]])
        elif after.text == '(':
            yield _Call(token, _split(tokens[i + 2 : _end(tokens, i + 1)]))


def _end(tokens: list[Token], start: int) -> int:
    depth = 0
    for i in range(start, len(tokens)):
        if tokens[i].kind == 'sign':
            depth += (tokens[i].text in _OPEN) - (tokens[i].text in _CLOSE)
            if not depth:
                return i
    return len(tokens)


def _split(tokens: list[Token], separators: str = ',') -> list[list[Token]]:
    parts: list[list[Token]] = [[]]
    depth = 0
    for token in tokens:
        if token.kind == 'sign':
            depth += (token.text in _OPEN) - (token.text in _CLOSE)
        elif token.kind == 'keyword':
            depth += (token.text in _BLOCKS) - (token.text in ('end', 'until'))
            depth -= token.text == 'elseif'
        if token.kind == 'sign' and token.text in separators and not depth:
            parts.append([])
        else:
            parts[-1].append(token)
    return parts if any(parts) else []


def _wrong_calls(
    source: LuaSource, tokens: list[Token], sizes: Sizes, declared: set[str]
) -> Iterator[ProgramProblem]:
    for call in _calls(tokens):
        function = LUA_FUNCTIONS.get(call.name.text)
        if function is None or function.name in declared or function.name == 'print':
            continue
        for reason in _problems_of_call(function, call.arguments, sizes):
            yield ProgramProblem(source.file, call.name.line, f'{function.name}: {reason}')


def _problems_of_call(function: LuaFunction, arguments: Sequence[list[Token]], sizes: Sizes) -> Iterator[str]:
    arguments = list(arguments)
    if function.options and arguments and len(arguments) > 1 and arguments[-1][0].text == '{':
        arguments.pop()
    first = function.arguments[0] if function.arguments else None
    if (
        first is not None
        and first.kind == 'number'
        and arguments
        and arguments[0][0].text == '{'
        and _end(arguments[0], 0) == len(arguments[0]) - 1
    ):
        arguments = [*_split(arguments[0][1:-1], ',;'), *arguments[1:]]
    open_ended = bool(arguments) and not _single(arguments[-1])
    # A name alone may be a table with all values.
    if (
        first is not None
        and first.kind == 'number'
        and len(arguments) == 1
        and arguments[0][0].kind == 'name'
    ):
        return
    wanted = wanted_arguments(function, sizes.num_axes, len(arguments))
    needed = sum(not argument.optional for _, argument in wanted)
    most = len(wanted) if not function.more else len(arguments)
    if function.options and arguments and arguments[-1] and arguments[-1][0].kind == 'name':
        most += 1  # a table of options by its name
    if len(arguments) > most or (len(arguments) < needed and not open_ended):
        what = 'joint angles' if first is not None and first.per_axis else 'arguments'
        count = f'{needed}' if needed == len(wanted) else f'{needed} to {len(wanted)}'
        robot = f' for {sizes.num_axes} axes' if what == 'joint angles' else f': {function.signature}'
        yield f'{len(arguments)} {what}, needed are {count}{robot}'
        return
    for (label, argument), given in zip(wanted, arguments, strict=False):
        if len(given) == 1 and given[0].kind in ('number', 'string'):
            value: bytes | float = (
                given[0].text.encode() if given[0].kind == 'string' else _number(given[0].text)
            )
            if (valid := valid_text(argument, value, sizes)) is not None:
                shown = given[0].text if isinstance(value, float) else f"the string '{given[0].text}'"
                yield f'{label} = {shown}; valid is {valid}'


def _single(argument: list[Token]) -> bool:
    """One value: neither a call nor `...`, which may be several."""
    return (
        not argument
        or (argument[-1].text not in (')', '...') and argument[0].kind != 'keyword')
        or (argument[0].text == '(' and _end(argument, 0) == len(argument) - 1)
    )


def _number(text: str) -> float:
    try:
        return float.fromhex(text) if text.lower().startswith('0x') else float(text)
    except (ValueError, OverflowError):
        return float('inf')
