"""What to write instead: remedies for the syntax of other languages, and for what Lua says of a line."""

import re
from collections.abc import Iterable
from typing import Final

_STRING: Final = re.compile(r'"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])*\'')
_DECREASED: Final = re.compile(r'(?:^|\s)(\w+)--;?$')
_COMMENT: Final = re.compile(r'--.*$')

# In the order in which they are tried: the first whose pattern is in the line explains it.
REMEDIES: Final = (
    (r'!=|<>', 'not equal is ~= in Lua'),
    (
        r'^\s*(?:IF|WHILE|FOR|ELSE|ELSEIF|THEN|END|REPEAT|UNTIL|LOCAL|RETURN)\b',
        'words of Lua are in lower case: if ... then ... end',
    ),
    (
        r'^\s*(?:PTP|MoveJ)\b',
        'a joint motion is ptpJointSpaceAngles(...), to a pose ptpJointSpacePosition(...)',
    ),
    (r'^\s*(?:LIN|MoveL|MoveLin)\b', 'a straight motion is ptpCartesianSpace(x, y, z, phi1, phi2, phi3)'),
    (r'^\s*(?:CIRC|MoveC)\b', 'an arc is circCartesianSpace({via}, {target})'),
    (r'/\*', 'a comment is written --, or --[[ ... ]] over several lines'),
    (r'(?:^|[\s;)])#\s', 'a comment is written --'),
    (r'\bfor\b[^;]*;', 'a loop is written for i = 1, 3 do ... end'),
    (r'\bfor\b.*(?:\.\.|\brange\b|\bto\b|:=)', 'a loop is written for i = 1, 3 do ... end'),
    (r'\?[^:]*:', 'a choice is written condition and a or b'),
    (r'(?:[=(,{]|\breturn)\s*\[', 'a list is written with braces: {1, 2, 3}'),
    (r'\{\s*[\w\']+\s*:[^:]', 'fields are written with =: {x = 1, y = 2}'),
    (r'\bfunction\b[^(]*\([^)]*\b\w+\s+\w+[^)]*\)', 'parameters have no types: function f(a, b)'),
    (r':=', 'a value is given with ='),
    (r'(\w+)\s*(?:\.\.)=', r'write \1 = \1 .. ...'),
    (r'(\w+)\s*\+\+', r'write \1 = \1 + 1'),
    (r'(\w+)\s*([-+*/])=', r'write \1 = \1 \2 ...'),
    (r'&&', 'write and'),
    (r'\|\|', 'write or'),
    (r'!\s*[\w(]', 'write not'),
    (r'\b(?:elif|elsif|else\s+if)\b', 'write elseif, in one word'),
    (r'\b(?:if|elseif|while|until)\b[^=]*[^=<>~]=[^=]', '= assigns a value; compare with =='),
    (
        r'\b(?:if|elseif|while|for|else|function)\b.*\{',
        'a block has no braces: then ... end, do ... end',
    ),
    (r'\b(?:if|elseif)\b.*:\s*(?!:)', 'write if ... then ... end, without a colon'),
    (r'\b(?:while|for)\b.*:\s*(?!:)', 'write do ... end, without a colon'),
    (r'^\s*\}', 'a block ends with end'),
    (r'^[^{]*\}\s*$', 'a block ends with end, not with a brace'),
    (
        r'^\s*(?:int|float|double|bool|boolean|string|var|let|const|auto)\s+(\w+)',
        r'write local \1 = ...',
    ),
    (r'^\s*(?:def|func|fn|void|sub|proc)\s+(\w+)', r'write function \1(...) ... end'),
    (r'^\s*(?:import|include|from|using)\b', "another program is run by call('name')"),
    (r'\b(?:switch|case)\b', 'write if ... then ... elseif ... end'),
    (r'\b(?:try|catch|except)\b', 'errors are caught by pcall(function() ... end)'),
    (r'\bcontinue\b', 'write goto next, and ::next:: before the end of the loop'),
    (r'^\s*(?!return|goto|and|or|not)(\w+)\s+-?\d', r'arguments are in parentheses: \1(...)'),
)
# By what Lua says, where nothing in the line explains it.
BY_REASON: Final = (
    (r"'then' expected", 'write if ... then ... end'),
    (r"'do' expected", 'write do before the first statement of the loop, and end after the last'),
    (r"unexpected symbol near (?:'(?:then|do|end|else|,|\))'|<eof>)", 'a value is missing before it'),
    (r"<name> expected near '\d", 'a name begins with a letter'),
    (r"no visible label '(\w+)'", 'a place to go to is written ::name::'),
    (r'break outside', 'break ends a loop from inside it'),
    (r"'end' expected", 'each then, do and function needs an end of its own'),
    (r'unfinished string', 'close it with the quotation mark that it begins with'),
    (r"'\)' expected", 'a parenthesis is not closed'),
    (r"'\}' expected", 'a brace is not closed'),
    (r"<eof> expected near '(?:end|else|elseif)'", 'there is no if, do or function that this belongs to'),
    (r'<eof> expected', 'nothing may follow return'),
    (r'syntax error near', 'a statement is a call, name(...), or gives a value, name = ...'),
)
# By what Lua says of a run.
OF_A_RUN: Final = (
    (
        r"'for iterator'",
        'a loop is written for i = 1, 3 do, and over the values of a table for i, value in ipairs(t) do',
    ),
    (
        r"attempt to (?:add|sub|mul|div|mod|pow|unm|idiv) .*'string'|arithmetic on a string",
        'texts are joined by .., and tonumber(text) makes a number of one',
    ),
    (r'attempt to concatenate', 'tostring(value) makes a text of it'),
    (r'attempt to compare', 'only numbers are compared with numbers, and texts with texts'),
    (
        r'attempt to index a nil value|(?:arithmetic|length) (?:on|of) a nil value',
        'nothing gives it a value before, or it is an index that is not there: the first is 1',
    ),
    (r'attempt to index', 'only tables have fields and indices'),
    (r'attempt to call a nil value', 'there is no function of this name here'),
    (r'attempt to call', 'it is no function; a name that the program gives a value hides the function'),
    (r'attempt to get length', '# counts the entries of a table or the letters of a text'),
    (r'assertion failed!$', "assert(value, 'why') says why"),
)


def remedy_of(reason: str, line: str) -> str:
    """What to write in the place of a line's mistake; '' where that is not known.

    Args:
        reason: Lua's own message.
        line: The text of the line.
    """
    if decreased := _DECREASED.search(line):
        return f'write {decreased[1]} = {decreased[1]} - 1; -- begins a comment'
    code = _COMMENT.sub('', _STRING.sub("''", line))
    return _first(REMEDIES, code) or _first(BY_REASON, reason)


def with_remedy(reason: str) -> str:
    """What Lua says of a run that failed, with what to do about it where that is known."""
    remedy = _first(OF_A_RUN, reason)
    return f'{reason}; {remedy}' if remedy else reason


def _first(remedies: Iterable[tuple[str, str]], text: str) -> str:
    """The remedy of the first pattern in a text, with what its groups have found; '' if there is none."""
    matches = ((re.search(pattern, text), remedy) for pattern, remedy in remedies)
    return next((found.expand(remedy) for found, remedy in matches if found), '')
