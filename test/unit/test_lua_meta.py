"""The editor's help is that of the functions."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from lupa import lua54

from robots_controller.commands.command_table import LUA_META
from robots_controller.editor.lua_meta import meta_file
from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS

PROGRAMS = Path(__file__).parents[2] / 'programs'
FILE = PROGRAMS / 'library' / 'robot_functions.lua'


def test_the_file_is_current():
    assert FILE.read_text() == meta_file(), 'run: python -m robots_controller.live_cell.describe_nodes'


def test_the_language_server_finds_it():
    settings = json.loads((PROGRAMS / '.luarc.json').read_text())
    folders = [PROGRAMS / folder for folder in settings['workspace.library']]
    assert FILE.parent in folders
    assert settings['runtime.version'] == lua54.LuaRuntime().eval('_VERSION')


@pytest.mark.parametrize('num_axes', [None, 1, 6, 7])
def test_every_function_and_argument_is_there_and_it_is_lua(num_axes: int | None):
    text = meta_file(num_axes)
    lua54.LuaRuntime().compile(text)
    blocks = {
        re.search(r'^function (\w+)\(', block, re.MULTILINE)[1]: block
        for block in text.split('\n\n')
        if '\nfunction ' in block
    }
    assert list(blocks) == list(LUA_FUNCTIONS)
    for name, function in LUA_FUNCTIONS.items():
        for argument in function.arguments:
            name_there = r'\.\.\.' if argument.repeated else rf'{argument.name}\d*\??'
            lines = re.findall(rf'^---@param {name_there} .*$', blocks[name], re.MULTILINE)
            count = (num_axes or 6) if argument.per_axis else 1
            assert len(lines) == count, (name, argument.name)
            assert all(argument.unit in line for line in lines)
        assert function.doc in blocks[name]


def test_robots_have_their_number_of_axes(capsys: pytest.CaptureFixture[str]):
    assert LUA_META.run(['--robot', 'bello_bot']) == 0
    text = capsys.readouterr().out
    assert 'function ptpJointSpaceAngles(q1, q2, q3, q4, q5, q6, q7, options) end' in text
    assert '---@overload fun(q1: number, q2: number, q3: number' not in text
    assert LUA_META.run(['--robot', 'nobody']) == 2
