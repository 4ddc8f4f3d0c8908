"""LuaSource: the text of a robot program, read from its file or explained why not."""

import re
from dataclasses import dataclass
from functools import partial
from itertools import islice
from pathlib import Path, PurePosixPath
from typing import Final

from robots_controller.interpreter.lua_sandbox import syntax_error
from robots_controller.interpreter.lua_tokens import lua_tokens
from robots_controller.interpreter.syntax_remedies import remedy_of
from robots_core.errors import InvalidInputError, ProgramError
from robots_core.files.user_file import read_bytes, when_written

MAX_PROGRAM_SIZE = 1_000_000  # bytes; the interpreter's memory is bounded too
# Lua shortens longer chunk names in its messages.
MAX_CHUNK_NAME = 50
# A comment explains the first syntax error; further candidates are not worth their compilation.
MAX_REMARK_CANDIDATES = 50
# Lua itself names the line: of what is not closed, of a goto, of a break.
OPENED: Final = re.compile(r'to close .* at line (\d+)\)|(?:<goto>|outside loop) at line (\d+)')
NEAR: Final = re.compile(r"near '?(.+?)'?$")
GOES_ON: Final = re.compile(r'(?:[-=+*/%,(<>~.]|\b(?:and|or|not))$')
BLOCK: Final = re.compile(r'\b(?:if|elseif|while|for)\b')


@dataclass(frozen=True)
class LuaSource:
    """A program's text.

    Attributes:
        label: Name of a subprogram as it is called; '' for the file's.
        written: When the file was written, ns since 1970; 0 where that is not known.
    """

    path: Path
    text: str
    label: str = ''
    written: int = 0

    @property
    def file(self) -> str:
        """The file's name, as messages show it."""
        return self.label or self.path.name

    @property
    def chunk_name(self) -> str:
        """The program's name in Lua."""
        return chunk_name(self.file)

    def line(self, number: int) -> str:
        """A line's text without its indent, '' where there is none; lines are counted from 1."""
        lines = self.text.split('\n')
        return lines[number - 1].strip() if 1 <= number <= len(lines) else ''


def chunk_name(file: str) -> str:
    """A program file's name in Lua."""
    printable = ''.join(c if c.isprintable() else '?' for c in file)
    return printable[-MAX_CHUNK_NAME:]


def read_source(path: Path | str) -> LuaSource:
    """Read a program.

    Raises:
        ProgramError: no such file, a directory, unreadable, too large, compiled Lua or not UTF-8.
    """
    file = Path(path)
    name = file.name or str(file)
    written = when_written(file)
    try:
        data = read_bytes(file, 'program', largest=MAX_PROGRAM_SIZE)
    except InvalidInputError as error:
        raise ProgramError(error.message, file=name) from None
    if data.startswith(b'\x1b'):
        raise ProgramError('this is compiled Lua; a program is Lua text', file=name)
    try:
        text = data.decode('utf-8-sig')
    except UnicodeDecodeError as error:
        line = data.count(b'\n', 0, error.start) + 1
        raise ProgramError(
            f'byte 0x{data[error.start]:02x} is not UTF-8; save the program as UTF-8 text',
            file=name,
            line=line,
        ) from None
    text = text.replace('\r\n', '\n')
    if '\0' in text:
        line = text.count('\n', 0, text.index('\0')) + 1
        raise ProgramError('null character; a program is Lua text', file=name, line=line)
    if text.startswith('#'):  # Lua skips a first line that names the interpreter
        text = '--' + text
    return LuaSource(file, text, written=written)


def find_subprogram(main: LuaSource, name: str) -> LuaSource:
    """Read a subprogram and check that it is Lua.

    Args:
        main: The main program; subprograms stand in its folder or below.
        name: Seen from there; '.lua' may be left out.

    Raises:
        ProgramError: it leads elsewhere, cannot be read, or is not Lua.
    """
    if '\0' in name:
        raise ProgramError(f'{name!r} has a null character; a subprogram is a file')
    path = PurePosixPath(name if name.endswith('.lua') else f'{name}.lua')
    folder = main.path.resolve().parent
    file = (folder / path).resolve()
    if path.is_absolute() or not file.is_relative_to(folder):
        raise ProgramError(
            f'{name!r} leads out of the folder of {main.file}; subprograms stand in it or below'
        )
    source = LuaSource(file, read_source(file).text, label=str(path))
    check_syntax(source)
    return source


def check_syntax(source: LuaSource) -> None:
    """Check that Lua can compile a program.

    `//` is integer division in Lua. It is taken for a comment where reading it as one moves the syntax
    error further down or makes it disappear.

    Raises:
        ProgramError: it cannot; with the line and its text.
    """
    check = partial(syntax_error, source.chunk_name)
    problem = check(source.text)
    if problem is None:
        return
    line, reason = problem
    divisions = (token for token in lua_tokens(source.text) if (token.kind, token.text) == ('sign', '//'))
    for token in islice(divisions, MAX_REMARK_CANDIDATES):
        if token.line > line:
            break
        better = check(f'{source.text[: token.start]}--{source.text[token.start + 2 :]}')
        if better is None or better[0] > line:
            line = token.line
            raise ProgramError(
                f"'//' does not start a comment in Lua; write '--': {source.line(line)}",
                file=source.file,
                line=line,
                source=source.line(line),
            )
    opened = OPENED.search(reason)
    line = int(opened[1] or opened[2]) if opened else _line_of_the_mistake(source, line, reason)
    text = source.line(line)
    remedy = remedy_of(reason, text)
    message = f'{reason}: {text}' if text else reason
    raise ProgramError(
        f'{message}; {remedy}' if remedy else message, file=source.file, line=line, source=text
    )


def _line_of_the_mistake(source: LuaSource, line: int, reason: str) -> int:
    """The line whose end is the mistake, where Lua only notices at the beginning of the next one."""
    near = NEAR.search(reason)
    before = next((k for k in range(line - 1, 0, -1) if source.line(k)), 0)
    if near is None or not before:
        return line
    text = source.line(line)
    if near[1] == '<eof>':
        before = before if not text else line
    elif not text.startswith(near[1]) or reason.startswith('<eof>'):
        return line
    if reason.startswith(("'then' expected", "'do' expected")):
        return next((k for k in range(before, 0, -1) if BLOCK.search(source.line(k))), before)
    ended = near[1] == '<eof>' or reason.startswith('syntax error') or GOES_ON.search(source.line(before))
    return before if ended else line
