"""Searches for the parts of a joint path on which the border of a zone is crossed; none is missed.

As in the search for collisions (`path_search`), the motion of the axes within an interval of time bounds the
change of a clearance, and an interval that this does not decide is halved.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from robots_core.blocks.collision.along_paths.joint_path import JointPath
from robots_core.blocks.zones.zone_clearance import ZoneClearance

MARGIN: Final = 1e-3  # m
"""What comes closer to a border counts as across it: a robot that stops there is not across."""
RESOLUTION: Final = 2.5e-4  # m of movement to which the ends of a passage are found
JOINED: Final = 0.05  # m of movement; what comes back within it counts as across all the time
ROUNDING: Final = 1e-5  # m
SAMPLES: Final = 32  # of a passage, for its smallest clearance


@dataclass(frozen=True)
class Passage:
    """A part of a path across the border of a zone.

    Attributes:
        start: Time at which it begins, s.
        end: Time at which it ends, s.
    """

    start: float
    end: float


def passages(
    clearance: ZoneClearance, path: JointPath, since: float | None = None, until: float | None = None
) -> tuple[Passage, ...]:
    """The passages of a path, or of a part of it between two times, s, across a border, in their order.

    A robot that is across the border at the start may come back: its first passage begins where it gets
    further across than it is.
    """
    low, high = path.start if since is None else since, path.end if until is None else until
    at_start, _ = clearance.closest(path.sample(low), MARGIN)
    found = _below(clearance, path, low, high, MARGIN)
    if at_start >= MARGIN or not found:
        return tuple(found)
    coming_back, *later = found
    further = _below(clearance, path, coming_back.start, coming_back.end, at_start - ROUNDING)
    return (*(Passage(part.start, coming_back.end) for part in further[:1]), *later)


def farthest_across(clearance: ZoneClearance, path: JointPath, passage: Passage) -> float:
    """The time within a passage at which the clearance is smallest, of `SAMPLES`, s."""
    times = np.linspace(passage.start, passage.end, SAMPLES)
    return float(times[np.argmin([clearance.closest(path.sample(time))[0] for time in times])])


def _below(clearance: ZoneClearance, path: JointPath, low: float, high: float, level: float) -> list[Passage]:
    """The parts between two times in which the clearance is below a level, m."""
    found: list[Passage] = []

    def value(time: float) -> float:
        return clearance.closest(path.sample(time), level)[0]

    waiting = [(low, value(low), high, value(high))]
    while waiting:
        start, at_start, end, at_end = waiting.pop()
        middle = 0.5 * (start + end)
        clearance.place(path.sample(middle))
        travels = clearance.travels(path.turn(start, middle, end))
        clearances = clearance.clearances(level + travels)
        near = clearances - travels < level
        if not near.any():
            continue
        at_middle, travel = float(clearances.min()), float(travels[near].max())
        values = (at_start, at_middle, at_end)
        if travel > RESOLUTION and not (travel <= JOINED and max(values) < level):
            waiting += [(middle, at_middle, end, at_end), (start, at_start, middle, at_middle)]
        elif min(values) < level:
            if found and found[-1].end >= start:
                start = found.pop().start
            found.append(Passage(start, end))
    return found
