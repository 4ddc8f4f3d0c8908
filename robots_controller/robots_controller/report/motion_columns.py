"""The figures of motions as the columns of a table, the same in the terminal and on the page."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from robots_controller.report.motion_figures import MotionFigures
from robots_controller.report.run_signals import QUANTITIES

NOTHING: Final = '-'


@dataclass(frozen=True)
class Column:
    """A column.

    Attributes:
        name: Its name, with unit.
        text: The cell of a motion.
        words: It holds words, not numbers.
        optional: A table in which it is empty does not have it.
    """

    name: str
    text: Callable[[MotionFigures], str]
    words: bool = False
    optional: bool = False


def number(value: float | None, digits: int) -> str:
    """A number for a table; '-' for what is not known."""
    return NOTHING if value is None or math.isnan(value) else f'{value:.{digits}f}'


def _missed(item: MotionFigures) -> str:
    if item.passing is not None:
        return f'({item.passing.describe()})'
    if item.motion.ended_early:
        return '(ended early)'
    if math.isnan(item.position_error):
        return NOTHING
    return f'{1e3 * item.position_error:.4f}, {math.degrees(item.orientation_error):.4f}'


def _use(quantity: str) -> Callable[[MotionFigures], str]:
    def text(item: MotionFigures) -> str:
        use = item.uses.get(quantity)
        return NOTHING if use is None else f'{use.joint} {100.0 * use.ratio:.0f}%'

    return text


PLANNED: Final = Column('planned s', lambda item: number(item.motion.planned, 2))
REAL: Final = Column('real s', lambda item: number(item.motion.duration, 2))
KIND: Final = Column('motion', lambda item: item.motion.kind.title, words=True)
MISSED: Final = Column('missed by mm, deg (passed in zone)', _missed)
OFF_LINE: Final = Column(
    'reference off line mm',
    lambda item: number(None if item.line_deviation is None else 1e3 * item.line_deviation, 4),
)
OFF_PATH: Final = Column('measured off path mm', lambda item: number(1e3 * item.path_deviation, 3))
LAG: Final = Column('lag mm', lambda item: number(1e3 * item.lag, 2))
LENGTH: Final = Column('path m', lambda item: number(item.length, 3))
CLOSEST: Final = Column('closest mm', lambda item: number(1e3 * item.closest, 1), optional=True)
FASTEST: Final = Column('top m/s', lambda item: number(item.fastest, 2))
ENERGY: Final = Column('energy kJ', lambda item: number(item.energy / 1e3, 2))
DECIDING: Final = Column(
    'decided by', lambda item: NOTHING if item.deciding is None else item.deciding.describe(), words=True
)
SHARE: Final = Column(
    'of its time', lambda item: NOTHING if item.deciding is None else f'{100.0 * item.deciding.share:.0f} %'
)
USES: Final = tuple(Column(quantity, _use(quantity)) for quantity in QUANTITIES)

VERDICT: Final = (KIND, PLANNED, REAL, MISSED, OFF_LINE, OFF_PATH, *USES)
"""Of `cell` and `simulate`."""
SUMMARY: Final = (PLANNED, REAL, MISSED, OFF_LINE, OFF_PATH, LAG, CLOSEST, LENGTH, ENERGY, DECIDING)
"""Of `report` in the terminal."""
PAGE: Final = (
    KIND, PLANNED, REAL, MISSED, OFF_LINE, OFF_PATH, LAG, CLOSEST, LENGTH, FASTEST, DECIDING, SHARE, *USES,
    ENERGY,
)  # fmt: skip
