"""StudyCase: one simulation of a study, with all files that it needs."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from robots_controller.program.files.cell_frames import FRAMES_FILE
from robots_controller.study.program_variant import Value, program_variant
from robots_core.errors import InvalidInputError
from robots_core.files.user_file import read_text

PROGRAM_SUFFIXES: Final = ('.lua', '.points.yaml', FRAMES_FILE)
MOST_FILES: Final = 1000
SCENE: Final = 'scene/'
IO: Final = 'io/'
PROGRAM: Final = 'program/'


@dataclass(frozen=True)
class StudyCase:
    """A case; it can be sent to another machine and run there.

    Attributes:
        program: File name of the program.
        longest: Longest simulated time, s.
        files: Texts by path: the program with its neighbours below 'program/', scene and PLC script.
    """

    program: str
    robot: str
    drive: str
    override: float
    parameters: tuple[tuple[str, Value], ...]
    longest: float
    files: Mapping[str, str] = field(repr=False)

    @property
    def key(self) -> str:
        """The same for cases with the same settings and files, and for no others."""
        inputs = [self.program, self.robot, self.drive, self.override, self.parameters, self.longest]
        text = json.dumps([inputs, sorted(self.files.items())])
        return hashlib.sha256(text.encode()).hexdigest()[:24]

    @property
    def settings(self) -> dict[str, Value]:
        """Columns of the results' table."""
        return {
            'program': self.program,
            'robot': self.robot,
            'drive': self.drive,
            'override': self.override,
            **dict(self.parameters),
        }

    def unpack(self, folder: Path) -> tuple[Path, str, str]:
        """Write the files with the program's variant; returns paths of program, scene and PLC script.

        Raises:
            InvalidInputError: the program has no such parameter.
        """
        paths: dict[str, str] = {SCENE: '', IO: ''}
        for name, text in self.files.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding='utf-8')
            paths |= {kind: str(path) for kind in (SCENE, IO) if name.startswith(kind)}
        program = folder / PROGRAM / self.program
        text = program_variant(
            self.files[PROGRAM + self.program],
            self.program,
            override=self.override,
            parameters=dict(self.parameters),
        )
        program.write_text(text, encoding='utf-8')
        return program, paths[SCENE], paths[IO]


def packed_files(program: Path, scene: str, io: str) -> Mapping[str, str]:
    """Texts of a program, of programs and taught points in its folder and below, of scene and PLC script.

    Raises:
        InvalidInputError: a file that cannot be read, or more than `MOST_FILES`.
    """
    folder = program.resolve().parent
    near = [
        path
        for suffix in PROGRAM_SUFFIXES
        for path in sorted(folder.rglob(f'*{suffix}'))
        if not any(part.startswith('.') for part in path.relative_to(folder).parts)
    ]
    if len(near) > MOST_FILES:
        raise InvalidInputError(
            f'{folder} has {len(near)} programs; for a study give {program.name} a folder of its own '
            f'(at most {MOST_FILES})'
        )
    files = {PROGRAM + path.relative_to(folder).as_posix(): read_text(path) for path in near}
    files[PROGRAM + program.name] = read_text(program)
    for kind, name in ((SCENE, scene), (IO, io)):
        if name:
            files[kind + Path(name).name] = read_text(name)
    return files
