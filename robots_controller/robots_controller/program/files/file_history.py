"""FileHistory: changes of files that can be undone."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from robots_controller.program.files.atomic_file import write_text
from robots_core.errors import ProgramError
from robots_core.files.user_file import read_text

LONGEST: Final = 200
WHAT: Final = 'file'


@dataclass(frozen=True)
class _Change:
    """Texts of a file before and after; None where there was none."""

    path: Path
    before: str | None
    after: str


class FileHistory:
    """Writes files whole, and takes the newest changes back one after the other."""

    def __init__(self) -> None:
        self._changes: deque[tuple[_Change, ...]] = deque(maxlen=LONGEST)

    def __len__(self) -> int:
        return len(self._changes)

    def change(self, texts: Mapping[Path, str]) -> None:
        """Write files, as one change.

        Raises:
            ProgramError: one cannot be written; those that were are as before.
        """
        changes: list[_Change] = []
        try:
            for path, text in texts.items():
                change = _Change(path, _text(path), text)
                write_text(path, text, WHAT)
                changes.append(change)
        except ProgramError:
            for change in changes:
                _take_back(change)
            raise
        self._changes.append(tuple(changes))

    def undo(self) -> tuple[Path, ...]:
        """Take the newest change back; returns its files.

        Raises:
            ProgramError: there is none, or somebody else has changed a file since; nothing is changed then.
        """
        if not self._changes:
            raise ProgramError('there is nothing to undo', key='nothing_to_undo')
        changes = self._changes[-1]
        for change in changes:
            if _text(change.path) != change.after:
                raise ProgramError(
                    'changed since; it stays as it is', file=change.path.name, key='changed_since'
                )
        self._changes.pop()
        for change in changes:
            _take_back(change)
        return tuple(change.path for change in changes)


def _text(path: Path) -> str | None:
    return read_text(path, WHAT) if path.exists() else None


def _take_back(change: _Change) -> None:
    if change.before is None:
        change.path.unlink(missing_ok=True)
    else:
        write_text(change.path, change.before, WHAT)
