"""`pairs` goes through a table in the same order in every process."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from cell_double import CellDouble
from robots_controller.interpreter.lua_program import LuaProgram

RUN = (
    'import sys; from robots_controller.interpreter.lua_program import LuaProgram\n'
    'from cell_double import CellDouble\n'
    'program = LuaProgram(6, CellDouble(printed=lambda text, line: print(text)))\n'
    'program.open(sys.argv[1]); program.run(); program.join()'
)


def printed(tmp_path: Path, text: str) -> list[str]:
    lines: list[str] = []
    path = tmp_path / 'program.lua'
    path.write_text(text)
    program = LuaProgram(6, CellDouble(printed=lambda line, _: lines.append(line)))
    program.open(path)
    program.run()
    program.join()
    assert program.error is None, program.error
    return lines


def test_strings_come_in_the_same_order_in_every_process(tmp_path: Path):
    text = 'local t = {} for i = 1, 20 do t["key" .. i] = i end for k in pairs(t) do print(k) end'
    # Lua draws another order for each of its states with all but certainty: 20 keys have 20! orders.
    expected = sorted(f'key{i}' for i in range(1, 21))
    assert printed(tmp_path, text) == printed(tmp_path, text) == expected
    command = [sys.executable, '-c', RUN, str(tmp_path / 'program.lua')]
    path = {'PYTHONPATH': os.pathsep.join(sys.path)}
    other = subprocess.run(
        command, cwd=tmp_path, env=os.environ | path, capture_output=True, text=True, check=True
    )
    assert other.stdout.split() == expected


@pytest.mark.parametrize(
    ('text', 'expected'),
    [
        ('for k, v in pairs({10, 20, 30}) do print(k, v) end', ['1\t10', '2\t20', '3\t30']),
        (
            'for k, v in pairs({b = 1, a = 2, [true] = 3, [false] = 4, [2.5] = 5, 6}) do print(k, v) end',
            ['1\t6', '2.5\t5', 'a\t2', 'b\t1', 'false\t4', 'true\t3'],
        ),
        ('for k in pairs({}) do print(k) end', []),
        # A loop may change and remove what it walks over.
        (
            """local t = {a = 1, b = 2, c = 3}
            for k, v in pairs(t) do t.b = nil t[k] = v + 1 print(k, v) end
            print(t.a, t.b, t.c)""",
            ['a\t1', 'c\t3', '2\tnil\t4'],
        ),
        (
            """local own = setmetatable({x = 1}, {__pairs = function() return next, {y = 2} end})
            for k, v in pairs(own) do print(k, v) end""",
            ['y\t2'],
        ),
        (
            'local key = {} for k, v in pairs({[key] = 1, a = 2}) do print(k == key, v) end',
            ['false\t2', 'true\t1'],
        ),
        # Raw, as Lua's own.
        (
            'local t = setmetatable({a = 1}, {__index = {b = 2}}) for k in pairs(t) do print(k) end',
            ['a'],
        ),
    ],
)
def test_it_is_pairs_in_all_else(tmp_path: Path, text: str, expected: list[str]):
    assert printed(tmp_path, text) == expected


def test_a_wrong_argument_has_the_program_s_line(tmp_path: Path):
    path = tmp_path / 'program.lua'
    path.write_text('local x\nfor k in pairs(x) do print(k) end')
    program = LuaProgram(6, CellDouble())
    program.open(path)
    program.run()
    program.join()
    assert str(program.error).startswith('program.lua:2: bad argument #1')
