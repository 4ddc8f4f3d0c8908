"""PersistentValues: values of a program that outlast its run, in a YAML file beside it."""

import math
from pathlib import Path
from typing import Any, Final

from robots_controller.program.files.atomic_file import read_file, write_text, yaml_text
from robots_core.errors import ProgramError

SUFFIX: Final = '.values.yaml'
Value = bool | int | float | str | tuple[float, ...]
WHAT: Final = 'file of persistent values'
HEADER: Final = '# Values that the program keeps from one run to the next.\n'


class PersistentValues:
    """Read when the first one is asked for; written whenever one changes.

    Args:
        path: Their file.
        kept: Write changes; otherwise they last as long as this object.
    """

    def __init__(self, path: Path, *, kept: bool) -> None:
        self._path, self._kept = path, kept
        self._values: dict[str, Value] | None = None

    def get(self, name: str, default: Value | None = None) -> Value | None:
        """A value.

        Raises:
            ProgramError: the file cannot be read, or holds something else.
        """
        return self._read().get(name, default)

    def set(self, name: str, value: Value | None) -> None:
        """Change a value, or take it away.

        Raises:
            ProgramError: the file cannot be read or written.
        """
        values = dict(self._read())
        if value is None:
            values.pop(name, None)
        else:
            values[name] = value
        if self._kept:
            entries = {key: list(v) if isinstance(v, tuple) else v for key, v in sorted(values.items())}
            write_text(self._path, yaml_text({'values': entries}, HEADER), WHAT)
        self._values = values

    def _read(self) -> dict[str, Value]:
        if self._values is None:
            entries = read_file(self._path, 'values', WHAT)
            self._values = {str(name): self._value(name, entry) for name, entry in entries.items()}
        return self._values

    def _value(self, name: object, entry: Any) -> Value:
        if isinstance(entry, list) and all(_is_number(one) for one in entry):
            return tuple(entry)
        if isinstance(entry, (bool, str)) or _is_number(entry):
            return entry  # type: ignore[no-any-return]
        raise ProgramError(
            f'{name} = {entry!r}; valid are numbers, texts, true and false, and lists of numbers',
            file=self._path.name,
        )


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
