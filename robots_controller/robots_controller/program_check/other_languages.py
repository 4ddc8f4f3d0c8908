"""What programs in other languages have, which compiles as Lua but is none of its functions or values."""

from collections.abc import Iterator, Sequence
from typing import Final

from robots_controller.interpreter.lua_tokens import Token

VALUES: Final = {
    **dict.fromkeys(('null', 'NULL', 'None', 'undefined'), 'nil'),
    **dict.fromkeys(('True', 'TRUE'), 'true'),
    **dict.fromkeys(('False', 'FALSE'), 'false'),
}
"""Values by their names in other languages."""

_JOINT_MOTION: Final = 'ptpJointSpaceAngles(...), or ptpJointSpacePosition(...) to a pose'
FUNCTIONS: Final = {
    **dict.fromkeys(('sleep', 'delay', 'pause', 'waittime', 'waitsec'), 'wait(seconds)'),
    **dict.fromkeys(('range', 'xrange'), 'for i = 1, 3 do ... end'),
    **dict.fromkeys(('printf', 'println', 'echo', 'disp', 'textmsg', 'tpwrite', 'console'), 'print(...)'),
    **dict.fromkeys(('len', 'length', 'size', 'count'), '#table'),
    **dict.fromkeys(('int', 'floor', 'round'), 'math.floor(...)'),
    **dict.fromkeys(('float', 'double'), 'tonumber(...)'),
    **dict.fromkeys(('str', 'tostr'), 'tostring(...)'),
    **dict.fromkeys(('abs', 'sqrt', 'sin', 'cos', 'tan', 'min', 'max', 'pi'), 'math.sin(...), math.pi, ...'),
    **dict.fromkeys(('robot', 'self'), 'functions without a name before them: ptpCartesianSpace(...)'),
    **dict.fromkeys(('movej', 'movejoint', 'moveabsj', 'ptp', 'move_j'), _JOINT_MOTION),
    **dict.fromkeys(('movel', 'movelin', 'lin', 'movep', 'move_l', 'linear'), 'ptpCartesianSpace(...)'),
    **dict.fromkeys(('movec', 'circ', 'movecirc'), 'circCartesianSpace(...)'),
    **dict.fromkeys(
        ('set_digital_out', 'set_standard_digital_out', 'setdo', 'set_do', 'digitalwrite', 'setoutput'),
        'setDigitalOutput(index, value)',
    ),
    **dict.fromkeys(
        ('get_digital_in', 'get_standard_digital_in', 'getdi', 'get_di', 'digitalread', 'getinput'),
        'getDigitalInput(index)',
    ),
    **dict.fromkeys(('waitdi', 'wait_di', 'waituntil'), 'waitDigitalInput(index, value)'),
}
"""What robot programs have in the place of functions of other languages, by the name in lower case."""


INSTEAD: Final = {
    **dict.fromkeys(
        ('require', 'dofile', 'load', 'loadfile', 'loadstring', 'package'),
        "call('name') runs another program",
    ),
    'io': 'print(...) writes to the log',
    'os': 'getTime() returns the time',
}
"""What programs have in the place of libraries of Lua that they do not have."""


def foreign_idioms(tokens: Sequence[Token]) -> Iterator[tuple[int, str]]:
    """Line and remedy of what fails in every run: texts that are added, loops over a number."""
    for before, token, after in zip(tokens, tokens[1:], tokens[2:], strict=False):
        if token.text == '+' and token.kind == 'sign':
            for text in (before, after):
                if text.kind == 'string' and not text.text.strip().isdecimal():
                    yield token.line, f"texts are joined by .., not by +: '{text.text}'"
                    break
        if (before.text, token.text) == ('in', '=') or (token.text == 'in' and after.kind == 'number'):
            yield token.line, 'for ... in goes over a table; over numbers a loop is written for i = 1, 3 do'
