"""The robot programs of a folder."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from robots_core.files.user_file import read_text

MOST: Final = 1000
HELP_FOLDER: Final = 'library'
"""Holds the editor's help, which is no program."""


def program_files(folder: Path) -> list[str]:
    """The Lua files of a folder and those below it, sorted, those of the folder itself first."""
    found = [
        path.relative_to(folder)
        for path in folder.rglob('*.lua')
        if HELP_FOLDER not in path.relative_to(folder).parts
    ]
    return [str(path) for path in sorted(found, key=lambda path: (len(path.parts), path))[:MOST]]


def read_program(path: str, file: str) -> str:
    """The text of a program, or of a file of its folder that it loads, by its name.

    Raises:
        InvalidInputError: it cannot be read.
    """
    return read_text(program_file(Path(path), file), 'program')


def program_file(program: Path, file: str) -> Path:
    """The path of a program, or of a file of its folder that it loads, by its name."""
    return program if program.name == file else program.parent / Path(file).name
