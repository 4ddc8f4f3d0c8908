"""Files that programs keep beside them: whole at any time, whatever happens while they are written."""

import os
import shutil
import tempfile
from pathlib import Path
from typing import Any

import yaml

from robots_core.errors import InvalidInputError, ProgramError
from robots_core.files.yaml_section import read_yaml_data


def read_file(path: Path, key: str, what: str) -> dict[Any, Any]:
    """The entries below the one key of a YAML file; none if there is no file. Messages say what it is.

    Raises:
        ProgramError: the file cannot be read, or holds something else.
    """
    if not path.exists():
        return {}
    try:
        data = read_yaml_data(path, what)
    except InvalidInputError as error:
        raise ProgramError(f'the {what} cannot be read: {error}', file=path.name) from None
    entries = data.get(key) if isinstance(data, dict) else None
    if not isinstance(entries, dict):
        raise ProgramError(f"a {what} has one key '{key}' with an entry per name", file=path.name)
    return entries


def yaml_text(data: dict[str, Any], header: str) -> str:
    """The text of a YAML file, below a header of comments."""
    return header + yaml.safe_dump(data, sort_keys=False, default_flow_style=None, width=200)


def write_text(path: Path, text: str, what: str) -> None:
    """Write a text file: the whole new one or, whatever happens, the whole old one.

    Raises:
        ProgramError: it cannot be written.
    """
    try:
        with tempfile.NamedTemporaryFile(
            'w', encoding='utf-8', newline='', dir=path.parent, prefix=f'.{path.name}.', delete=False
        ) as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        if path.exists():
            shutil.copymode(path, file.name)
        Path(file.name).replace(path)
    except OSError as error:
        raise ProgramError(f'the {what} cannot be written: {error.strerror}', file=path.name) from None
