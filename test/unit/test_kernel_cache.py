"""Kept machine code: used as long as all that it is made of is the same, and never longer."""

from __future__ import annotations

import inspect
import shutil
import subprocess
import sys
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from robots_core.kernels.compiled import compiled

if TYPE_CHECKING:
    from fractions import Fraction

CALLEE = """
from robots_core.kernels.compiled import compiled

@compiled()
def part(x):
    return 2.0 * x
"""
CALLER = """
from callee import part
from robots_core.kernels.compiled import compiled

STEP = 1.0

@compiled()
def whole(x):
    return part(x) + below(0.0)

@compiled()
def below(x):
    return x + STEP

@compiled()
def apart(x):
    return -x
"""
TYPED = """
from typing import NamedTuple
from robots_core.kernels.compiled import compiled

class Part(NamedTuple):
    value: float
    other: float

class Old(NamedTuple):
    first: Part
    second: Part

ARGUMENT = Old(first=Part(value=10.0, other=7.0), second=Part(value=2.0, other=1.0))

@compiled()
def whole(x: Old):
    return x.first.value

@compiled()
def apart(x):
    return x
"""
WITH_OPTIONS = """
from compiled import compiled

@compiled()
def whole(x):
    return scaled(x)

@compiled()
def scaled(x, factor=1.0):
    return factor * x

@compiled(counted=False)
def apart(x):
    return x
"""
DECORATOR = Path(inspect.getfile(compiled)).read_text()
SOURCES = {
    'plain': {'callee.py': CALLEE, 'caller.py': CALLER},
    'typed': {'caller.py': TYPED},
    'typed by text': {'caller.py': f'from __future__ import annotations\n{TYPED}'},
    'with options': {'compiled.py': DECORATOR, 'caller.py': WITH_OPTIONS},
}
RUN = """
import sys
for folder in sys.argv[1:]:
    sys.path.insert(0, folder)
    import caller
    results = [caller.whole(getattr(caller, 'ARGUMENT', 10.0)), caller.apart(1.0)]
    print(results[0], *(int(not f.stats.cache_hits) for f in (caller.whole, caller.apart)))
    sys.path.remove(folder)
    for name in {'caller', 'callee', 'moved', 'compiled'} & set(sys.modules):
        del sys.modules[name]
"""
NEW, KEPT = '1', '0'
NEW_LINE = 10


own_module = sys.modules[__name__]


@dataclass(frozen=True)
class Edit:
    """What is edited in a file after its functions were compiled, and what a new process finds then."""

    file: str
    old: str
    new: str
    expected: list[str]
    of: str = 'plain'


SWAPPED = 'value: float\n    other: float', 'other: float\n    value: float'
MOVED = 'a function that moved to another file'
EDITS = {
    'a function that is called': Edit('callee.py', '2.0', '3.0', ['31.0', NEW, KEPT]),
    'a constant': Edit('caller.py', 'STEP = 1.0', 'STEP = 5.0', ['25.0', NEW, KEPT]),
    'another function': Edit('caller.py', '-x', '0 - x', ['21.0', KEPT, NEW]),
    'comments': Edit(
        'caller.py',
        'STEP = 1.0',
        '# A comment, and a line more.\n\nSTEP = 1.0',
        ['21.0', KEPT, KEPT],
    ),
    'documentation': Edit('callee.py', '(x):', '(x):\n    """What it does."""', ['21.0', KEPT, KEPT]),
    MOVED: Edit('caller.py', 'from callee', 'from moved', ['21.0', NEW, KEPT]),
    'another type of argument': Edit('caller.py', 'Old', 'New', ['10.0', NEW, KEPT], of='typed'),
    'fields in another order': Edit(
        'caller.py',
        'first: Part\n    second: Part',
        'second: Part\n    first: Part',
        ['10.0', NEW, KEPT],
        of='typed',
    ),
    'fields of a field in another order': Edit('caller.py', *SWAPPED, ['10.0', NEW, KEPT], of='typed'),
    'fields of a type that is written as text': Edit(
        'caller.py', *SWAPPED, ['10.0', NEW, KEPT], of='typed by text'
    ),
    'a default value': Edit('caller.py', 'factor=1.0', 'factor=3.0', ['30.0', NEW, KEPT], of='with options'),
    'an option of all functions': Edit(
        'compiled.py', "'_nrt':", "'fastmath': True, '_nrt':", ['10.0', NEW, NEW], of='with options'
    ),
}


def run(*folders: Path) -> list[list[str]]:
    """For each folder the result of `whole`, and for each function whether it was compiled."""
    done = subprocess.run(
        # Python itself would not notice a change within a second that keeps the size of a file.
        [sys.executable, '-B', '-c', RUN, *map(str, folders)],
        capture_output=True,
        text=True,
        check=True,
    )
    return [line.split() for line in done.stdout.splitlines()]


@pytest.fixture(scope='module')
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[str]]:
    """What one process finds in a folder for each edit, after another has compiled what was there before."""
    before, after = tmp_path_factory.mktemp('before'), tmp_path_factory.mktemp('after')
    for folder, files in SOURCES.items():
        (before / folder).mkdir()
        for name, text in files.items():
            (before / folder / name).write_text(text)
    assert run(*(before / folder for folder in SOURCES)) == [['21.0', NEW, NEW], *[['10.0', NEW, NEW]] * 3]
    for name, edit in EDITS.items():
        shutil.copytree(before / edit.of, after / name)
        source = after / name / edit.file
        text = source.read_text()
        assert edit.old in text
        source.write_text(text.replace(edit.old, edit.new))
    (after / MOVED / 'callee.py').rename(after / MOVED / 'moved.py')
    return dict(zip(EDITS, run(*(after / name for name in EDITS)), strict=True))


@pytest.mark.parametrize('name', EDITS)
def test_an_edit_compiles_what_depends_on_it(found: dict[str, list[str]], name: str):
    assert found[name] == EDITS[name].expected


class Side(Enum):
    LEFT = 1


def is_left(side: Side) -> bool:
    return side is Side.LEFT


def has_line_of(number: int) -> bool:
    return number == own_module.NEW_LINE


def half(value: Fraction) -> Fraction:
    return value / 2


def first_of(values: tuple['int', 'int']) -> int:  # noqa: UP037  # what is an error
    return values[0]


def test_a_module_of_ones_own_is_an_error():
    """Numba takes what it has as constants, and any of them may change."""
    with pytest.raises(TypeError, match='own_module is of module: compiled functions use numbers'):
        compiled()(has_line_of)(10)


def test_a_value_of_unknown_content_is_an_error():
    with pytest.raises(TypeError, match='Side is of EnumType: compiled functions use numbers'):
        compiled()(is_left)(Side.LEFT)


def test_an_argument_of_a_type_for_type_checkers_alone_is_an_error():
    """Its fields cannot be found when the code runs."""
    with pytest.raises(TypeError, match=r"annotation 'Fraction' is not known: .*not for type checkers alone"):
        compiled()(half)


def test_text_within_an_annotation_is_an_error():
    with pytest.raises(TypeError, match=r'is text within an annotation'):
        compiled()(first_of)
