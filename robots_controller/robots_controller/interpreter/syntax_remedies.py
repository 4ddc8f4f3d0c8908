"""What to write instead: remedies for the syntax of other languages in a line that Lua cannot compile."""

import re
from typing import Final

_STRING: Final = re.compile(r'"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])*\'')
_COMMENT: Final = re.compile(r'--.*$')

# In the order in which they are tried: the first whose pattern is in the line explains it.
REMEDIES: Final = tuple(
    (re.compile(pattern), remedy)
    for pattern, remedy in (
        (r'!=', 'not equal is ~= in Lua'),
        (r'/\*', 'a comment is written --, or --[[ ... ]] over several lines'),
        (r'(?:^|[\s;)])#\s', 'a comment is written --'),
        (r'\bfor\b[^;]*;', 'a loop is written for i = 1, 3 do ... end'),
        (r'\bfor\b.*(?:\.\.|\brange\b)', 'a loop is written for i = 1, 3 do ... end'),
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
)
# By what Lua says, where nothing in the line explains it.
BY_REASON: Final = tuple(
    (re.compile(pattern), remedy)
    for pattern, remedy in (
        (r"'then' expected", 'write if ... then ... end'),
        (r"'do' expected", 'write do before the first statement of the loop, and end after the last'),
        (r"'end' expected", 'each then, do and function needs an end of its own'),
        (r'unfinished string', 'close it with the quotation mark that it begins with'),
        (r"'\)' expected", 'a parenthesis is not closed'),
        (r"'\}' expected", 'a brace is not closed'),
        (r"<eof> expected near '(?:end|else|elseif)'", 'there is no if, do or function that this belongs to'),
        (r'<eof> expected', 'nothing may follow return'),
    )
)


def remedy_of(reason: str, line: str) -> str:
    """What to write in the place of a line's mistake; '' where that is not known.

    Args:
        reason: Lua's own message.
        line: The text of the line.
    """
    code = _COMMENT.sub('', _STRING.sub("''", line))
    for pattern, remedy in REMEDIES:
        found = pattern.search(code)
        if found:
            return found.expand(remedy) if '\\' in remedy else remedy
    return next((remedy for pattern, remedy in BY_REASON if pattern.search(reason)), '')
