"""What came out of a run of hours: lateness of loops, memory of processes, and which goals are met."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from robots_core.validation import Array

PERIOD: Final = 0.004  # s, of references and feedback
LATE: Final = 0.002  # s: a period is missed if its message is sent later than that
GAP: Final = 1.5  # periods between the stamps of two messages
PERCENTILES: Final = (50.0, 99.0, 99.9, 99.99)
WARM_UP: Final = 0.2  # part of the run after which memory is measured
MEANINGFUL: Final = 1200.0  # s of a run in which a slope of memory says something
LARGEST_SLOPE: Final = 2.0  # MB in an hour: a goal
# The index of a recording stays in memory until its end: 4.3 MB in an hour of 45 topics, a chunk a second.
RECORDER, RECORDING_SLOPE = 'cell', 6.0  # a process, MB in an hour: a goal
MOST_MISSED: Final = 1e-4  # of all periods: a goal


@dataclass(frozen=True, eq=False)
class LoopFigures:
    """How late a loop sent the messages of a robot that moves.

    Attributes:
        name: Its topic.
        due: (k,) s since the start, when they were due.
        late: (k,) s.
        gaps: Lengths of the gaps between messages that were due, s.
    """

    name: str
    due: Array
    late: Array
    gaps: Array

    @property
    def percentiles(self) -> tuple[float, ...]:
        """At `PERCENTILES`, s."""
        return tuple(np.percentile(self.late, PERCENTILES).tolist()) if self.late.size else (0.0,) * 4

    @property
    def worst(self) -> float:
        """Latest, s."""
        return float(self.late.max(initial=0.0))

    @property
    def missed(self) -> int:
        """Periods whose message came too late."""
        return int((self.late > LATE).sum())


@dataclass(frozen=True, eq=False)
class MemoryFigures:
    """Memory of a process that it shares with no file.

    Attributes:
        name: Of the process.
        time: (k,) s since the start.
        megabytes: (k,) MB.
    """

    name: str
    time: Array
    megabytes: Array

    @property
    def largest_slope(self) -> float:
        """The goal, MB in an hour."""
        return RECORDING_SLOPE if self.name == RECORDER else LARGEST_SLOPE

    @property
    def slope(self) -> float:
        """How fast it grows after the process has warmed up, MB in an hour; least squares."""
        late = self.time >= WARM_UP * self.time.max(initial=0.0)
        if late.sum() < 3:
            return 0.0
        return 3600.0 * float(np.polyfit(self.time[late], self.megabytes[late], 1)[0])


@dataclass(frozen=True, eq=False)
class SoakFigures:
    """A whole run.

    Attributes:
        duration: s.
        runs: Programs that came to their end.
        jogs: Times that the robot was jogged.
        inputs: Changes of inputs that the PLC sent.
        problems: What went wrong, a line each.
        loops: The loops.
        memory: The processes.
        recorded: Size of the recording, MB.
        machine: Where it ran.
    """

    duration: float
    runs: int
    jogs: int
    inputs: int
    problems: tuple[str, ...]
    loops: tuple[LoopFigures, ...]
    memory: tuple[MemoryFigures, ...]
    recorded: float
    machine: str

    @property
    def missed_goals(self) -> tuple[str, ...]:
        """A line for each goal that is not met."""
        late = [
            f'{loop.name}: {loop.missed} of {loop.late.size} messages came more than {1e3 * LATE:g} ms late, '
            f'the goal is {100.0 * MOST_MISSED:g} %'
            for loop in self.loops
            if loop.missed > MOST_MISSED * loop.late.size
        ]
        growing = [
            f'{one.name} grows by {one.slope:.2f} MB in an hour, the goal is {one.largest_slope:g} MB'
            for one in self.memory
            if self.duration >= MEANINGFUL and one.slope > one.largest_slope
        ]
        return (*self.problems, *late, *growing)


def loop_figures(name: str, due: Array, late: Array, moved: NDArray[np.bool_]) -> LoopFigures:
    """The figures of all messages of a topic.

    Messages that are the same as the one before come seldom, and one is sent again before a motion begins.

    Args:
        name: The topic.
        due: (m,) s since the start, when they were due.
        late: (m,) s.
        moved: (m,) whether a message differs from the one before.
    """
    steps = np.diff(due)
    gaps = steps[(steps > GAP * PERIOD) & moved[:-1]]
    return LoopFigures(name, due[moved], late[moved], gaps)


def memory_figures(samples: Sequence[tuple[float, Mapping[str, float]]]) -> tuple[MemoryFigures, ...]:
    """Samples (s, MB by process) as figures, the largest process first."""
    names = {name for _, sizes in samples for name in sizes}
    found = []
    for name in names:
        rows = np.array([(time, sizes[name]) for time, sizes in samples if name in sizes])
        found.append(MemoryFigures(name, rows[:, 0], rows[:, 1]))
    return tuple(sorted(found, key=lambda one: -one.megabytes[-1]))
