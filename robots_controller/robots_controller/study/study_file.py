"""Study: what shall be simulated, read from YAML."""

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Final

from robots_controller.program.files.program_header import read_program_header
from robots_controller.study.program_variant import Value, program_variant
from robots_controller.study.study_case import StudyCase, packed_files
from robots_core.blocks.drives.drive_levels import DRIVE_LEVELS
from robots_core.errors import InvalidInputError
from robots_core.files.user_file import is_file, read_text
from robots_core.files.yaml_section import YamlSection, located, read_yaml

MOST_CASES: Final = 1_000_000
LONGEST_TIME: Final = 3600.0  # s of simulated time


@dataclass(frozen=True)
class Study:
    """A grid of cases.

    Attributes:
        scene: YAML file of what stands around the robots; '' for that of each program's header.
        io: Script of the PLC; '' for that of each program's header.
        longest: Longest simulated time of a case, s.
    """

    programs: tuple[Path, ...]
    robots: tuple[str, ...]
    drives: tuple[str, ...] = ('ideal',)
    overrides: tuple[float, ...] = (1.0,)
    parameters: Mapping[str, tuple[Value, ...]] = field(default_factory=lambda: MappingProxyType({}))
    scene: str = ''
    io: str = ''
    longest: float = LONGEST_TIME

    def cases(self) -> tuple[StudyCase, ...]:
        """All combinations: programs, robots, drives, overrides, parameters, the last varies fastest.

        Raises:
            RobotsError: more than `MOST_CASES`, a file that cannot be read, or a program without a
                parameter.
        """
        choices = (self.programs, self.robots, self.drives, self.overrides, *self.parameters.values())
        count = math.prod(map(len, choices))
        if count > MOST_CASES:
            raise InvalidInputError(f'the study has {count} cases; at most {MOST_CASES} are possible')
        files = {program: self._files(program) for program in self.programs}
        grid = itertools.product(
            self.programs,
            self.robots,
            self.drives,
            self.overrides,
            itertools.product(*self.parameters.values()),
        )
        return tuple(
            StudyCase(
                program=program.name,
                robot=robot,
                drive=drive,
                override=override,
                parameters=tuple(zip(self.parameters, values, strict=True)),
                longest=self.longest,
                files=files[program],
            )
            for program, robot, drive, override, values in grid
        )

    def _files(self, program: Path) -> Mapping[str, str]:
        """What a program needs; scene and PLC script are those of its header where the study names none."""
        cell = read_program_header(program).replaced_by(scene=self.scene, io=self.io)
        cell.check_files()
        return packed_files(program, cell.scene, cell.io)


def read_study(path: Path | str) -> Study:
    """The study of a YAML file; its paths are seen from the file's folder.

    Raises:
        InvalidInputError: what is wrong, with file and line.
    """
    path = Path(path)
    section = read_yaml(path)
    programs = tuple(_file(section, path, text, line) for text, line in _texts(section, 'programs'))
    study = Study(
        programs=programs,
        robots=tuple(text for text, _ in _texts(section, 'robots')),
        drives=tuple(_among(section, *item) for item in section.texts('drives')) or ('ideal',),
        overrides=tuple(_override(section, *item) for item in section.texts('overrides')) or (1.0,),
        parameters=_parameters(section, programs),
        scene=_optional(section, path, 'scene'),
        io=_optional(section, path, 'io'),
        longest=section.number('longest', LONGEST_TIME, low=0.001),
    )
    section.finish()
    return study


def _texts(section: YamlSection, key: str) -> list[tuple[str, int]]:
    found = section.texts(key)
    if not found:
        raise section.missing(key, 'one or a list of them')
    return found


def _file(section: YamlSection, path: Path, text: str, line: int) -> Path:
    file = path.parent / text
    if not is_file(file):
        raise located(section.file, line, f'{text!r} is no file in {path.parent}')
    return file


def _optional(section: YamlSection, path: Path, key: str) -> str:
    text = section.text(key, '')
    return str(_file(section, path, text, section.line_of(key))) if text else ''


def _among(section: YamlSection, text: str, line: int) -> str:
    if text not in DRIVE_LEVELS:
        raise located(
            section.file, line, f'{text!r} is no level of drives; valid are {", ".join(DRIVE_LEVELS)}'
        )
    return text


def _override(section: YamlSection, text: str, line: int) -> float:
    value = _value(text)
    if isinstance(value, bool) or not isinstance(value, float) or not 0.0 < value <= 1.0:
        raise located(section.file, line, f'override {text!r} must be a number above 0, up to 1')
    return value


def _parameters(section: YamlSection, programs: tuple[Path, ...]) -> Mapping[str, tuple[Value, ...]]:
    found: dict[str, tuple[Value, ...]] = {}
    for inner, name in section.entries('parameters'):
        found[name] = tuple(_value(text) for text, _ in inner.texts(name))
        if not found[name]:
            raise inner.error(f'{name} has no values', name)
        for program in programs:
            try:
                program_variant(read_text(program), program.name, override=1.0, parameters={name: 0.0})
            except InvalidInputError as error:
                raise inner.error(error.message, name) from None
    return MappingProxyType(found)


def _value(text: str) -> Value:
    if text in ('true', 'false'):
        return text == 'true'
    try:
        return float(text)
    except ValueError:
        return text
