from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lupa.lua54 import LuaRuntime

from robots_controller.study.program_variant import Value, program_parameters, program_variant
from robots_core.errors import InvalidInputError

PROGRAM = """-- a program
local PARTS, PATIENCE = 2, 10 -- parts, s
SPEED = 0.25
local name = "left"; local other = 3
local function f() local inner = 4 end
local computed = 2 * PARTS
local fast = false
--[[
quoted = 1
]]
"""


def variant(**parameters: Value) -> str:
    return program_variant(PROGRAM, 'p.lua', override=1.0, parameters=parameters)


def test_parameters_begin_lines_and_have_plain_values():
    assert program_parameters(PROGRAM) == ('PARTS', 'PATIENCE', 'SPEED', 'name', 'fast')


def test_of_several_names_the_right_value_is_replaced():
    assert 'local PARTS, PATIENCE = 2, 0.5 -- parts, s' in variant(PATIENCE=0.5)


def test_texts_and_switches_are_written_as_lua():
    assert 'local name = "right \\"1\\"";' in variant(name='right "1"')
    assert 'local fast = true' in variant(fast=True)


def test_nothing_else_changes():
    assert variant() == PROGRAM
    assert variant(SPEED=0.25) == PROGRAM


def test_an_override_keeps_the_line_numbers():
    text = program_variant(PROGRAM, 'p.lua', override=0.5, parameters={})
    assert text.splitlines()[0] == 'setOverride(0.5) -- a program'
    assert text.count('\n') == PROGRAM.count('\n')


@pytest.mark.parametrize('name', ['inner', 'speed', 'quoted', 'nothing', 'f'])
def test_what_is_no_parameter_is_refused_with_those_there_are(name: str):
    with pytest.raises(InvalidInputError, match=rf'p\.lua has no parameter {name!r}.*(PARTS|SPEED)'):
        variant(**{name: 1.0})


@given(
    st.one_of(
        st.floats(allow_nan=False, allow_infinity=False),
        st.booleans(),
        st.text(st.characters(codec='utf-8', exclude_characters='\0'), max_size=20),
    )
)
@settings(max_examples=80)
def test_lua_reads_the_value_that_was_given(value: Value):
    lua = LuaRuntime(unpack_returned_tuples=True)
    found = lua.execute(program_variant('X = 1\nreturn X', 'p.lua', override=1.0, parameters={'X': value}))
    assert found == value
