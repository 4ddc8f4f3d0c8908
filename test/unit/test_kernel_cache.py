"""Kept machine code: used as long as all that it is made of is the same, and never longer."""

from __future__ import annotations

import shutil
import subprocess
import sys
from enum import Enum
from pathlib import Path

import pytest

from robots_core.kernels.compiled import compiled

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
RUN = """
from caller import apart, whole
results = [whole(10.0), apart(1.0)]
print(results[0], *(int(not f.stats.cache_hits) for f in (whole, apart)))
"""
NEW, KEPT = '1', '0'
NEW_LINE = 10


own_module = sys.modules[__name__]


def run(folder: Path, code: str = RUN) -> list[str]:
    """The result of `whole`, and for each function whether it was compiled."""
    return subprocess.run(
        # Python itself would not notice a change within a second that keeps the size of a file.
        [sys.executable, '-B', '-c', code],
        cwd=folder,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split()


@pytest.fixture(scope='module')
def compiled_once(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp('kernels')
    (folder / 'callee.py').write_text(CALLEE)
    (folder / 'caller.py').write_text(CALLER)
    assert run(folder) == ['21.0', NEW, NEW]
    return folder


@pytest.fixture
def folder(compiled_once: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(compiled_once, tmp_path / 'kernels'))


@pytest.mark.parametrize(
    ('file', 'old', 'new', 'expected'),
    [
        ('callee.py', '2.0', '3.0', ['31.0', NEW, KEPT]),
        ('caller.py', 'STEP = 1.0', 'STEP = 5.0', ['25.0', NEW, KEPT]),
        ('caller.py', '-x', '0 - x', ['21.0', KEPT, NEW]),
        ('caller.py', 'STEP = 1.0', '# A comment, and a line more.\n\nSTEP = 1.0', ['21.0', KEPT, KEPT]),
        ('callee.py', '(x):', '(x):\n    """What it does."""', ['21.0', KEPT, KEPT]),
    ],
    ids=['a function that is called', 'a constant', 'another function', 'comments', 'documentation'],
)
def test_an_edit_compiles_what_depends_on_it(
    folder: Path, file: str, old: str, new: str, expected: list[str]
):
    source = folder / file
    source.write_text(source.read_text().replace(old, new))
    assert run(folder) == expected


def test_a_function_that_moved_to_another_file_is_compiled(folder: Path):
    (folder / 'callee.py').rename(folder / 'moved.py')
    source = folder / 'caller.py'
    source.write_text(source.read_text().replace('from callee', 'from moved'))
    assert run(folder) == ['21.0', NEW, KEPT]


def test_a_function_whose_argument_has_another_type_is_compiled(tmp_path: Path):
    source = tmp_path / 'caller.py'
    text = """
from typing import NamedTuple
from robots_core.kernels.compiled import compiled

class Old(NamedTuple):
    value: float

@compiled()
def whole(x: Old):
    return x.value

@compiled()
def apart(x):
    return x
"""
    call = RUN.replace('whole(10.0)', 'whole(Old(10.0))').replace('import apart', 'import Old, apart')
    for name in ('Old', 'New'):
        source.write_text(text.replace('Old', name))
        assert run(tmp_path, call.replace('Old', name)) == ['10.0', NEW, NEW if name == 'Old' else KEPT]


class Side(Enum):
    LEFT = 1


def is_left(side: Side) -> bool:
    return side is Side.LEFT


def has_line_of(number: int) -> bool:
    return number == own_module.NEW_LINE


def test_a_module_of_ones_own_is_an_error():
    """Numba takes what it has as constants, and any of them may change."""
    with pytest.raises(TypeError, match='own_module is of module: compiled functions use numbers'):
        compiled()(has_line_of)(10)


def test_a_value_of_unknown_content_is_an_error():
    with pytest.raises(TypeError, match='Side is of EnumType: compiled functions use numbers'):
        compiled()(is_left)(Side.LEFT)
