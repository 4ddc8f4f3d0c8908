"""LuaFunction: one function of robot programs as the table has it, its arguments, and what serves it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Literal

from robots_controller.interpreter.argument_kinds import ArgumentKind
from robots_controller.interpreter.lua_sandbox import Result, Waiting
from robots_planning.motion_kinds import KIND_OF_FUNCTION

Options = Literal['', 'cartesian', 'joint']
Serve = Callable[..., Result | Waiting]

# What functions return, and the same for the Lua language server.
A_POSE: Final = ('a pose', 'Pose')
A_NUMBER: Final = ('a number', 'number')
JOINT_NUMBERS: Final = ('a table of n numbers', 'number[]')
TRUE_OR_FALSE: Final = ('true or false', 'boolean')


@dataclass(frozen=True)
class Argument:
    """One argument of a Lua function.

    Attributes:
        name: As in the paper.
        kind: Which values are valid.
        unit: '' for none.
        meaning: One line.
        per_axis: Comes once per axis, as name1, name2, ...
        repeated: Comes once or more, as name1, name2, ...
        optional: May be left out or nil.
    """

    name: str
    kind: ArgumentKind
    unit: str = ''
    meaning: str = ''
    per_axis: bool = False
    repeated: bool = False
    optional: bool = False


@dataclass(frozen=True)
class LuaFunction:
    """One function of robot programs.

    Attributes:
        name: The paper's name.
        doc: What it does, for the reference.
        arguments: In their order; those of a target or frame may come as one table.
        result: What it returns, '' for nothing.
        result_type: The same for the Lua language server.
        more: Further arguments of any kind may follow.
        by_name: A name that may come in the place of all arguments; None for none.
        serve: Serves a call: a function of a `Family` and the arguments, in SI; None for one left out.
    """

    name: str
    doc: str
    arguments: tuple[Argument, ...]
    result: str
    result_type: str
    more: bool
    serve: Serve
    by_name: Argument | None = None

    @property
    def options(self) -> Options:
        """Which table of options may follow the arguments: those of its kind of motion; '' for none."""
        kind = KIND_OF_FUNCTION.get(self.name)
        if kind is None:
            return ''
        return 'cartesian' if kind.cartesian else 'joint'

    @property
    def signature(self) -> str:
        """As in the reference: name(arguments), those in brackets optional."""
        names = []
        for argument in self.arguments:
            name = argument.name
            if argument.per_axis or argument.repeated:
                name = f'{name}1, ..., {name}n'
            names.append(f'[{name}]' if argument.optional else name)
        names += ['[options]'] * bool(self.options) + ['...'] * self.more
        return f'{self.name}({", ".join(names)})'


def lua_function(
    *arguments: Argument,
    returns: tuple[str, str] = ('', ''),
    more: bool = False,
    by_name: Argument | None = None,
) -> Callable[[Serve], LuaFunction]:
    """Make a method of a `Family` a function of robot programs: its name and docstring are the function's."""

    def made(serve: Serve) -> LuaFunction:
        doc = ' '.join((serve.__doc__ or '').split())
        return LuaFunction(serve.__name__, doc, arguments, *returns, more, serve, by_name)

    return made
