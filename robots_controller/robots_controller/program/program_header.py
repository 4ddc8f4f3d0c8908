"""ProgramHeader: what a robot program says at its top about the cell that it is for."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from robots_controller.interpreter.lua_source import read_source

_ENTRY: Final = re.compile(r'(Robot|Scene|IO|References|Contact|Orbit|Cabin): (\S+)\s*')
HEADER_FILES: Final = ('scene', 'io', 'references', 'contact', 'orbit', 'cabin')
"""What a header may name beside the robot."""
_LINE: Final = re.compile(rf'--\s*({_ENTRY.pattern})+')


@dataclass(frozen=True)
class ProgramHeader:
    """The cell of a program, from lines of its first comment.

    `-- Robot: NAME  Scene: FILE  IO: FILE  References: BAG  Contact: FILE  Orbit: FILE  Cabin: FILE`, all or
    some, in one line or several.

    Attributes:
        robot: The robot's name; '' where nothing is said.
        scene: What the robot keeps clear of (YAML); '' for nothing.
        io: Script of the PLC that the program works with (YAML); '' for none.
        references: Recording of what guides the robot (see `read_guide_recording`); '' for none.
        contact: What its tool touches, and force control there (see `read_contact`); '' for nothing.
        orbit: Orbit in which the robot's base floats (YAML); '' for a robot that stands.
        cabin: Cabin that the robot carries (YAML); '' for none.
    """

    robot: str = ''
    scene: str = ''
    io: str = ''
    references: str = ''
    contact: str = ''
    orbit: str = ''
    cabin: str = ''

    def replaced_by(self, **given: str) -> ProgramHeader:
        """The same with all that is given, and not '', in the place of its own."""
        return replace(self, **{name: value for name, value in given.items() if value})

    def note(self, program: Path | str, robot: str) -> str:
        """A note for a person who runs the program on a robot; '' if it is the program's own."""
        if not self.robot or robot.partition('?')[0] == self.robot.partition('?')[0]:
            return ''
        return f'{Path(program).name} is written for {self.robot}'


def read_program_header(program: Path | str) -> ProgramHeader:
    """Read what a program says about its cell.

    Args:
        program: Lua robot program; its header names files as seen from its folder.

    Raises:
        ProgramError: the program cannot be read.
    """
    source = read_source(program)
    found: dict[str, str] = {}
    for line in source.text.splitlines():
        if not line.startswith('--'):
            break
        if _LINE.fullmatch(line):
            found |= {key.lower(): value for key, value in _ENTRY.findall(line)}
    folder = source.path.resolve().parent
    files = {key: str(folder / found[key]) for key in HEADER_FILES if key in found}
    return ProgramHeader(robot=found.get('robot', ''), **files)
