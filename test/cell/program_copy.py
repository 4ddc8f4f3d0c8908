"""Programs of programs/ that do what they do fewer times."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path

from .conftest import PROGRAMS


def program_copy(folder: Path, program: str, shortened: Mapping[str, str]) -> tuple[Path, Path | None]:
    """Copy a program with all that it needs.

    Args:
        folder: Where to.
        program: File name.
        shortened: Text of the program and what stands in its place.

    Returns:
        The copy, and the script of its PLC if it works with one.
    """
    path = folder / 'programs' / program
    shutil.copytree(PROGRAMS, path.parent)
    text = path.read_text()
    for old, new in shortened.items():
        assert text.count(old) == 1
        text = text.replace(old, new)
    path.write_text(text)
    plc = path.parent / 'io' / f'{path.stem}.yaml'
    return path, plc if plc.is_file() else None
