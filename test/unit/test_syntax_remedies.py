"""Messages of beginners' mistakes: the line, the mistake, and what to write instead."""

from __future__ import annotations

from pathlib import Path

import pytest

from robots_controller.interpreter.argument_kinds import Sizes
from robots_controller.program_check.program_check import check_program


@pytest.mark.parametrize(
    ('line', 'remedy'),
    [
        ('if getDigitalInput(1) != true then wait(1) end', 'not equal is ~='),
        ('local i = 1; i++', 'write i = i + 1'),
        ('i = 1; i += 2', 'write i = i + ...'),
        ('if x = 3 then wait(1) end', 'compare with =='),
        ("if 'a' = 'b' then wait(1) end", 'compare with =='),
        ('x = 3 && 4', 'write and'),
        ('if a == 1 || b == 2 then end', 'write or'),
        ('x = !true', 'write not'),
        ('if true { wait(1) }', 'a block has no braces'),
        ('for i = 1, 3 {', 'a block has no braces'),
        ('wait(1) }', 'a block ends with end'),
        ('for i = 1; i < 3; i++ do end', 'for i = 1, 3 do'),
        ('for i in 1..3 do end', 'for i = 1, 3 do'),
        ('if true then wait(1) elif false then end', 'write elseif'),
        ('int x = 3', 'write local x = ...'),
        ('def f(): wait(1)', 'write function f(...) ... end'),
        ('if x == 3: wait(1)', 'without a colon'),
        ('import math', "call('name')"),
        ('try wait(1) end', 'pcall'),
        ('wait 1', 'arguments are in parentheses: wait(...)'),
        ('/* remark */ wait(1)', 'a comment is written --'),
        ('wait(1) # remark', 'a comment is written --'),
        ('if true wait(1) end', 'write if ... then ... end'),
        ('x = "abc', 'close it with the quotation mark'),
        ('wait(1', 'a parenthesis is not closed'),
        ('while true do wait(1)', 'needs an end of its own'),
        ('x = null', "did you mean 'nil'?"),
        ('x = True', "did you mean 'true'?"),
    ],
)
def test_the_message_has_line_mistake_and_remedy(tmp_path: Path, line: str, remedy: str):
    program = tmp_path / 'test.lua'
    program.write_text(f'wait(1)\n{line}\n')
    (problem,) = check_program(program, Sizes(6, 32, 8))
    assert problem.line == 2
    assert remedy in problem.reason


def test_what_no_remedy_explains_is_left_as_lua_says_it(tmp_path: Path):
    program = tmp_path / 'test.lua'
    program.write_text("'!= in a text'\n")
    (problem,) = check_program(program, Sizes(6, 32, 8))
    assert problem.reason.startswith('unexpected symbol near')
    assert ';' not in problem.reason
