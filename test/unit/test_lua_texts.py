"""Texts of values are the same in every process: no address is ever seen."""

from __future__ import annotations

from pathlib import Path

import pytest

from .lua_host import LuaHost


@pytest.mark.parametrize(
    ('text', 'expected'),
    [
        # Numbered in the order in which they are asked for; the same value keeps its number.
        ('local a, b = {}, {} print(b) print(a, b)', ['table: 1', 'table: 2\ttable: 1']),
        ('print({}, print, coroutine.create(print))', ['table: 1\tfunction: 2\tthread: 3']),
        ('local t = {} print(tostring(t) == tostring(t), tostring({}) == tostring({}))', ['true\tfalse']),
        ("local t = {} print(('%s|%5.2f|%-9s|%%s'):format(t, 2, t))", ['table: 1| 2.00|table: 1 |%s']),
        # A metatable defines its own text or name.
        ("print(setmetatable({}, {__tostring = function() return 'door' end}))", ['door']),
        ("print(setmetatable({}, {__name = 'door'}))", ['door: 1']),
        ("print(setmetatable({}, {__metatable = false, __name = 'door'}))", ['door: 1']),
        ("print(('%s'):format(setmetatable({}, {__tostring = function() return 'seam' end})))", ['seam']),
        # All else is Lua's own.
        ("print(nil, true, 1, 1.0, -0.0, 1 / 0, 'x')", ['nil\ttrue\t1\t1.0\t-0.0\tinf\tx']),
        ("print(('%d of %s, %q'):format(3, nil, 'a'))", ['3 of nil, "a"']),
        (
            "print(pcall(string.format, '%d', {}))",
            ["false\tbad argument #2 to 'format' (number expected, got table)"],
        ),
        ("print(pcall(string.format, '%s'))", ["false\tbad argument #2 to 'format' (no value)"]),
        ('print(pcall(tostring))', ["false\tbad argument #1 to 'tostring' (value expected)"]),
    ],
)
def test_text(tmp_path: Path, text: str, expected: list[str]):
    host = LuaHost(tmp_path)
    assert host.run(text) is None
    assert host.printed == expected


def test_every_run_counts_from_one(tmp_path: Path):
    host = LuaHost(tmp_path)
    for _ in range(2):
        assert host.run('print({})') is None
    assert host.printed == ['table: 1', 'table: 1']


def test_an_address_is_refused(tmp_path: Path):
    for value in ("'text'", '{}'):
        error = LuaHost(tmp_path).fails(f"local x = {value}\nprint(('%5d %p'):format(1, x))")
        assert error.line == 2
        assert error.reason.startswith("string.format: '%p' is an address")
