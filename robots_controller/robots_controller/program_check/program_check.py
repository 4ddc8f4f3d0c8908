"""check_program: what is wrong with a robot program, without running it."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

from robots_controller.defaults import ANALOG_SIZE, DIGITAL_SIZE
from robots_controller.interpreter.argument_kinds import Sizes
from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS, TASK_FUNCTIONS
from robots_controller.interpreter.lua_source import LuaSource, check_syntax, find_subprogram, read_source
from robots_controller.interpreter.lua_tokens import Token, lua_tokens
from robots_controller.io.cell_io import read_cell_io
from robots_controller.io.io_image import IoImage
from robots_controller.program.files.cell_frames import FRAMES_FILE
from robots_controller.program_check.comparisons import comparisons_of_unlike_values
from robots_controller.program_check.lua_calls import lua_calls
from robots_controller.program_check.other_languages import foreign_idioms
from robots_controller.program_check.program_calls import wrong_calls
from robots_controller.program_check.program_names import declared_names, unknown_names
from robots_core.errors import ProgramError


@dataclass(frozen=True)
class ProgramProblem:
    """What is wrong in a line of a program or subprogram, counted from 1, or in the whole file, 0."""

    file: str
    line: int
    reason: str

    def __str__(self) -> str:
        return f'{self.file}:{self.line}: {self.reason}' if self.line else f'{self.file}: {self.reason}'


@dataclass
class _Checked:
    sources: dict[str, tuple[LuaSource, list[Token]]] = field(default_factory=dict)
    tasks: set[str] = field(default_factory=set)
    problems: list[ProgramProblem] = field(default_factory=list)


def check_program(path: Path | str, sizes: Sizes) -> tuple[ProgramProblem, ...]:
    """Check a program and its subprograms.

    Found are errors of syntax, functions that do not exist, variables without a value, wrong numbers of
    arguments, indices, words and options that are not valid, comparisons that are always false, and
    subprograms that are not there. Arguments that a program computes are not known, and not checked.

    Args:
        path: The program.
        sizes: The robot's axes, the numbers of inputs and outputs, and the frames file; without one, that
            beside the program.

    Returns:
        What is wrong, by file and line; empty if nothing was found.
    """
    checked = _Checked()
    if sizes.frames_file is None:
        sizes = replace(sizes, frames_file=Path(path).with_name(FRAMES_FILE))
    try:
        main = read_source(path)
        check_syntax(main)
    except ProgramError as error:
        return (ProgramProblem(error.file, error.line, error.reason),)
    _collect(main, main, checked)
    declared = {name for _, tokens in checked.sources.values() for name in declared_names(tokens)}
    for source, tokens in checked.sources.values():
        for line, reason in (
            *unknown_names(tokens, declared),
            *wrong_calls(tokens, sizes, declared),
            *comparisons_of_unlike_values(tokens, declared),
            *foreign_idioms(tokens),
            *(_not_in_tasks(tokens) if source.file in checked.tasks else ()),
        ):
            checked.problems.append(ProgramProblem(source.file, line, reason))
    return tuple(sorted(checked.problems, key=lambda problem: (problem.file, problem.line)))


def _not_in_tasks(tokens: list[Token]) -> Iterator[tuple[int, str]]:
    for call in lua_calls(tokens):
        name = call.name.text
        if name in LUA_FUNCTIONS and name not in TASK_FUNCTIONS:
            yield call.name.line, f'{name}: not in a task; the main program alone may call it'


def _collect(main: LuaSource, source: LuaSource, checked: _Checked) -> None:
    tokens = list(lua_tokens(source.text))
    checked.sources[source.file] = (source, tokens)
    for call in lua_calls(tokens):
        if call.name.text not in ('call', 'startTask') or not call.arguments or len(call.arguments[0]) != 1:
            continue
        (token,) = call.arguments[0]
        if token.kind != 'string':
            continue
        try:
            subprogram = find_subprogram(main, token.text)
        except ProgramError as error:
            checked.problems.append(ProgramProblem(source.file, token.line, f'{call.name.text}: {error}'))
            continue
        if call.name.text == 'startTask':
            checked.tasks.add(subprogram.file)
        if subprogram.file not in checked.sources:
            _collect(main, subprogram, checked)


def sizes_of(
    num_axes: int,
    io: str,
    io_map: str,
    frames: str,
    *,
    digital: int = DIGITAL_SIZE,
    analog: int = ANALOG_SIZE,
) -> Sizes:
    """What bounds the arguments of a program, from its robot's axes and the files of its cell, '' for none.

    Raises:
        RobotsError: a file that is not valid.
    """
    file = Path(frames) if frames else None
    if not (io or io_map):
        return Sizes(num_axes, digital, analog, frames_file=file)
    labels = read_cell_io(io, io_map).labels
    image = IoImage(digital=digital, analog=analog, labels=labels)
    return replace(Sizes.of(num_axes, image), frames_file=file)


def check_first(program: Path | str, sizes: Sizes) -> None:
    """Print what is wrong with a program, as `check_program` does.

    Raises:
        RobotsError: something is.
    """
    problems = check_program(program, sizes)
    for problem in problems:
        print(problem, file=sys.stderr)
    if problems:
        count = f'{len(problems)} problems' if len(problems) > 1 else 'a problem'
        raise ProgramError(
            f'{Path(program).name} has {count}, and nothing was started; --no-check runs it anyway'
        )
