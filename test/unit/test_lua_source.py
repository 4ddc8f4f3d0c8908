"""Reading programs: every file is a program or a reason why not."""

from __future__ import annotations

from pathlib import Path

import pytest

from robots_controller.interpreter.lua_source import MAX_PROGRAM_SIZE, check_syntax, read_source
from robots_core.errors import ProgramError


def opened(folder: Path, data: bytes | str) -> str:
    """'' if the program can be opened, or why not."""
    path = folder / 'p.lua'
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    try:
        check_syntax(read_source(path))
    except ProgramError as error:
        return str(error)
    return ''


@pytest.mark.parametrize(
    'text',
    [
        '',
        'wait(1)',
        '\ufeffwait(1)',
        '#!/usr/bin/lua\nwait(1)',
        'a = 1\r\nb = 2\r\n',
        'a = 7 // 2',
        "-- // a remark in a remark\ns = 'http://x' t = [[ // ]] --[[ // ]]",
        "print('Schweißen')",
    ],
)
def test_lua_is_opened(tmp_path: Path, text: str):
    assert opened(tmp_path, text) == ''


@pytest.mark.parametrize(
    ('text', 'line'),
    [
        ('setDigitalOutput(1,0); //deactivate\n  welding gun\nwait(1)', 1),
        ("// don't\nwait(1)", 1),
        ('wait(1)\n//\n', 2),
        ('a = 7 // 2\nwait(1); // wait for\n  completion', 2),
        ('x = 1 // set x\ny = 2', 1),
        ('s = "//"\nwait(1) // wait a second', 2),
    ],
)
def test_slashes_meant_as_comments_are_explained(tmp_path: Path, text: str, line: int):
    assert opened(tmp_path, text).startswith(
        f"p.lua:{line}: '//' does not start a comment in Lua; write '--'"
    )


@pytest.mark.parametrize(
    ('text', 'error'),
    [
        ('a = 8 // 2\nb = )', "p.lua:2: unexpected symbol near ')': b = ); a value is missing before it"),
        ('x = ', 'p.lua:1: unexpected symbol near <eof>: x =; a value is missing before it'),
        ('break', 'p.lua:1: break outside loop at line 1: break; break ends a loop from inside it'),
    ],
)
def test_other_syntax_errors_are_lua_s_own_with_a_remedy(tmp_path: Path, text: str, error: str):
    # Lua 5.4 writes <goto> or goto, depending on its release.
    assert opened(tmp_path, text).replace('<goto>', 'goto') == error


@pytest.mark.parametrize(
    ('data', 'error'),
    [
        (b'\x1bLua\x54', 'p.lua: this is compiled Lua; a program is Lua text'),
        (b'a = 1\nb = "\xff"', 'p.lua:2: byte 0xff is not UTF-8; save the program as UTF-8 text'),
        (b'a = 1\n\0', 'p.lua:2: null character; a program is Lua text'),
        (b'-' * (MAX_PROGRAM_SIZE + 1), f'at most {MAX_PROGRAM_SIZE}'),
    ],
)
def test_what_is_not_text_is_refused(tmp_path: Path, data: bytes, error: str):
    assert error in opened(tmp_path, data)


def test_missing_file_directory_and_null_character_are_named(tmp_path: Path):
    for path, reason in (
        (tmp_path / 'none.lua', 'there is no program'),
        (tmp_path, 'is a directory'),
        ('a\0b', 'cannot be read'),
    ):
        with pytest.raises(ProgramError, match=reason):
            read_source(path)


def test_lines_are_counted_from_one(tmp_path: Path):
    path = tmp_path / 'p.lua'
    path.write_text('first\n  second\n')
    source = read_source(path)
    assert [source.line(i) for i in range(5)] == ['', 'first', 'second', '', '']
