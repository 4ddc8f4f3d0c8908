"""The pattern matching in Lua gives what Lua's own gives."""

from __future__ import annotations

from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st
from lupa import lua54

from robots_controller.interpreter.lua_sandbox import PATTERNS

# Calls one function of both implementations and compares all results, or whether both fail.
COMPARE = rb"""
local patterns = load(...)(string)
local function collected(f, ...)
  local all = {}
  for a, b, c in f(...) do all[#all + 1] = table.concat({tostring(a), tostring(b), tostring(c)}, '|') end
  return table.concat(all, ';')
end
local function results(lib, name, ...)
  local r = name == 'gmatch' and table.pack(pcall(collected, lib.gmatch, ...))
    or table.pack(pcall(lib[name], ...))
  if not r[1] then return 'fails' end
  for i = 1, r.n do r[i] = math.type(r[i]) and 'number ' .. r[i] or tostring(r[i]) end
  return table.concat(r, ', ')
end
local replacements = {
  text = '<%0%%>', capture = '[%1]', number = 7, table = {a = 'A', b = false},
  ['function'] = function(first) return first ~= 'a' and '(' .. first .. ')' end,
}
return function(name, s, p, extra)
  if name == 'gsub' then extra = replacements[extra] end
  return results(string, name, s, p, extra), results(patterns, name, s, p, extra)
end
"""

SINGLES = st.sampled_from(
    ['a', 'b', 'c', '.', '%a', '%d', '%s', '%W', '%.', '[ab]', '[^a]', '[a-c%d]', '[]]', '[^%s]', '^', '%$']
)
REPEATED = st.tuples(SINGLES, st.sampled_from(['', '', '*', '+', '-', '?'])).map(''.join)
ITEMS = st.one_of(REPEATED, REPEATED, st.sampled_from(['()', '%bab', '%b()', '%f[b]', '%f[^%w]']))
GROUPS = st.lists(ITEMS, max_size=3).map(lambda items: f'({"".join(items)})')
WELL_FORMED = st.builds(
    lambda anchor, items, back, end: anchor + ''.join(items) + back + end,
    st.sampled_from(['', '', '^']),
    st.lists(st.one_of(ITEMS, GROUPS), max_size=5),
    st.sampled_from(['', '', '', '%1']),
    st.sampled_from(['', '', '$']),
)
SUBJECTS = st.text(alphabet='abc1 .()]^$\n', max_size=10)


def _comparison() -> Any:
    runtime = lua54.LuaRuntime(encoding=None, unpack_returned_tuples=True)
    return runtime.execute(COMPARE, PATTERNS)


compare = _comparison()


@settings(max_examples=750)
@given(subject=SUBJECTS, pattern=WELL_FORMED, init=st.one_of(st.none(), st.integers(-12, 12)))
def test_searches_and_substitutions_agree(subject: str, pattern: str, init: int | None):
    for name in (b'find', b'match', b'gmatch'):
        theirs, ours = compare(name, subject.encode(), pattern.encode(), init)
        assert ours == theirs, name
    for by in (b'text', b'capture', b'number', b'table', b'function'):
        theirs, ours = compare(b'gsub', subject.encode(), pattern.encode(), by)
        assert ours == theirs, by


@settings(max_examples=500)
@given(subject=st.text(alphabet='ab', max_size=3), pattern=st.text(alphabet='a%[](b)^$f1*-.', max_size=8))
def test_what_lua_refuses_is_refused(subject: str, pattern: str):
    theirs, ours = compare(b'match', subject.encode(), pattern.encode(), None)
    # Lua reads a pattern as far as it gets; ours reads it whole before it begins.
    assert ours in (theirs, b'fails')
