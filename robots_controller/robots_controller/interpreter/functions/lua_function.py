"""LuaFunction: one function of robot programs as the table has it, and its arguments."""

from dataclasses import dataclass
from typing import Final, Literal

from robots_planning.motion_kinds import KIND_OF_FUNCTION

Kind = Literal[
    'number',
    'time',
    'fraction',
    'scale',
    'positive',
    'switch',
    'text',
    'name',
    'frame',
    'comparison',
    'convention',
    'hold',
    'function',
    'pose',
    'joints',
    'condition',
    'value',
    'motion',
    'moment',
    'joint_planner',
    'cartesian_planner',
    'configuration',
    'count',
    'digital input',
    'digital output',
    'analog input',
    'analog output',
]
Options = Literal['', 'cartesian', 'joint']

FRAMES: Final = ('base', 'tool')
MOMENTS: Final = ('now', 'arrival')
COMPARISONS: Final = ('<', '<=', '>', '>=', '==', '~=')
ANCHORS: Final = ('distance_before_end', 'distance_after_start', 'time_before_end', 'time_after_start')


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
    kind: Kind
    unit: str
    meaning: str
    per_axis: bool = False
    repeated: bool = False
    optional: bool = False


@dataclass(frozen=True)
class LuaFunction:
    """One function of robot programs.

    Attributes:
        name: The paper's name.
        arguments: In their order; those of a target or frame may come as one table.
        doc: What it does, for the reference.
        result: What it returns, '' for nothing.
        result_type: The same for the Lua language server.
        more: Further arguments of any kind may follow.
    """

    name: str
    arguments: tuple[Argument, ...]
    doc: str
    result: str = ''
    result_type: str = ''
    more: bool = False

    @property
    def options(self) -> Options:
        """Which table of options may follow the arguments: those of its kind of motion; '' for none."""
        kind = KIND_OF_FUNCTION.get(self.name)
        if kind is None:
            return ''
        return 'cartesian' if kind.cartesian else 'joint'

    @property
    def signature(self) -> str:
        """As in a program: name(arguments), those in brackets optional."""
        names = []
        for argument in self.arguments:
            name = argument.name
            if argument.per_axis or argument.repeated:
                name = f'{name}1, ..., {name}n'
            names.append(f'[{name}]' if argument.optional else name)
        if self.options:
            names.append('[options]')
        if self.more:
            names.append('...')
        return f'{self.name}({", ".join(names)})'
