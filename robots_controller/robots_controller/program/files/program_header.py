"""ProgramHeader: the cell of a robot program, from the comments at its top."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Final

from robots_controller.interpreter.lua_source import read_source
from robots_core.errors import ProgramError, RobotsError
from robots_core.files.user_file import exists, is_file
from robots_core.robot_choice import available_robot_models, load_robot_model
from robots_core.wording.nearest_name import nearest_name

KEYS: Final = ('Robot', 'Scene', 'IO', 'References', 'Contact', 'Orbit', 'Cabin')
HEADER_FILES: Final = tuple(key.lower() for key in KEYS[1:])
"""What a header may name beside the robot."""
_ENTRY: Final = re.compile(rf'({"|".join(KEYS)}): (\S+)\s*')
_LINE: Final = re.compile(rf'--\s*({_ENTRY.pattern})+')
_ENTRIES: Final = re.compile(r'--\s*(?:\w+\s*[:=]\s*\S+\s*)+')  # with any keys, and with = for the colon
_SPLIT: Final = re.compile(r'(\w+)\s*[:=]\s*(\S+)')


@dataclass(frozen=True)
class ProgramHeader:
    """The cell of a program, from lines of its first comment.

    `-- Robot: NAME  Scene: FILE  IO: FILE  References: BAG  Contact: FILE  Orbit: FILE  Cabin: FILE`, all or
    some, in one line or several.

    Attributes:
        robot: The robot's name; '' if the header has none.
        scene: As of `simulate`, and so are the five that follow; '' if the header has none.
        file: The program's file name.
        lines: Its lines, by what they name.
    """

    robot: str = ''
    scene: str = ''
    io: str = ''
    references: str = ''
    contact: str = ''
    orbit: str = ''
    cabin: str = ''
    file: str = field(default='', compare=False)
    lines: Mapping[str, int] = field(default_factory=lambda: MappingProxyType({}), compare=False)

    def replaced_by(self, **given: str) -> ProgramHeader:
        """The same with all that is given, and not '', in the place of its own."""
        return self._with({name: value for name, value in given.items() if value})

    def without(self, name: str) -> ProgramHeader:
        """The same without one of its files."""
        return self._with({name: ''})

    def _with(self, new: Mapping[str, str]) -> ProgramHeader:
        lines = {name: line for name, line in self.lines.items() if name not in new}
        return replace(self, lines=MappingProxyType(lines), **new)

    def check_files(self) -> None:
        """Refuse a file or a robot that the program names and that is not there.

        Raises:
            ProgramError: there is one.
        """
        self._check_robot()
        for key, line in self.lines.items():
            path = getattr(self, key)
            if key != 'robot' and not exists(path):
                raise ProgramError(
                    f'there is no {key} {path}, which the header names; it is looked for from the folder of '
                    f'the program, and --{key} takes another',
                    file=self.file,
                    line=line,
                )

    def _check_robot(self) -> None:
        plain = self.robot.partition('?')[0]
        file = plain.partition(':')[2]
        if 'robot' not in self.lines or plain in available_robot_models() or is_file(file):
            return
        try:
            load_robot_model(self.robot)
        except RobotsError as error:
            raise ProgramError(error.message, file=self.file, line=self.lines['robot']) from None

    def note(self, program: Path | str, robot: str) -> str:
        """A note for a person who runs the program on a robot; '' if it is the program's own."""
        if not self.robot or robot.partition('?')[0] == self.robot.partition('?')[0]:
            return ''
        return f'{Path(program).name} is written for {self.robot}'


def read_program_header(program: Path | str) -> ProgramHeader:
    """Read the cell of a program from its header.

    Args:
        program: Lua robot program; its header names files as seen from its folder.

    Raises:
        ProgramError: the program cannot be read, or an entry of its header is misspelled.
    """
    source = read_source(program)
    found: dict[str, str] = {}
    lines: dict[str, int] = {}
    for number, line in enumerate(source.text.splitlines(), 1):
        if not line.startswith('--'):
            break
        _refuse_misspelled(line, number, source.file)
        if _LINE.fullmatch(line):
            here = {key.lower(): value for key, value in _ENTRY.findall(line)}
            found |= here
            lines |= dict.fromkeys(here, number)
    folder = source.path.resolve().parent
    files = {key: str(folder / found[key]) for key in HEADER_FILES if key in found}
    return ProgramHeader(
        robot=found.get('robot', ''), file=source.file, lines=MappingProxyType(lines), **files
    )


def _refuse_misspelled(line: str, number: int, file: str) -> None:
    if _LINE.fullmatch(line) or not _ENTRIES.fullmatch(line):
        return
    for key, value in _SPLIT.findall(line):
        meant = nearest_name(key, KEYS)
        if meant is not None:
            raise ProgramError(
                f'{line!r} is no header; did you mean {f"-- {meant}: {value}"!r}?', file=file, line=number
            )
