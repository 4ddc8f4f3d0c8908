"""MotionRecords: what became of each motion command of a simulated program."""

import math
from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any

from robots_controller.program.motions.motion_command import MotionCommand
from robots_controller.simulation.simulation_run import SimulatedMotion
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import RobotsError
from robots_planning.motion_settings import MotionSettings
from robots_planning.pathplanning import PlannedMotion


class MotionRecords:
    """Grows with each command; all times in s since the start of the program."""

    def __init__(self) -> None:
        self._motions: dict[str, SimulatedMotion] = {}
        self._open: set[str] = set()

    @property
    def all(self) -> tuple[SimulatedMotion, ...]:
        """In the order of their commands."""
        return tuple(self._motions.values())

    @property
    def any_open(self) -> bool:
        """A command has no result yet."""
        return bool(self._open)

    def commanded(self, id_: str, command: MotionCommand, file: str, now: float) -> None:
        """A motion of a program or subprogram was commanded."""
        self._motions[id_] = SimulatedMotion(id_, command, file, now)
        self._open.add(id_)

    def configured(self, id_: str, settings: MotionSettings) -> None:
        """The planner has these settings for a motion."""
        self._change(id_, settings=settings)

    def refused(self, command: MotionCommand, error: RobotsError, now: float) -> None:
        """A command was refused before it had an id."""
        id_ = f'refused {len(self._motions)}'
        self.commanded(id_, command, '', now)
        self.ended(MotionResult.refused(id_, error), now)

    def planned(self, ends: Mapping[str, float], plan: PlannedMotion) -> None:
        """A chain of commands was planned; each ends at a time of the plan, s, in order.

        Some of them may be in an earlier plan too, which this one carries on.
        """
        for id_, (start, end) in zip(ends, pairwise((0.0, *ends.values())), strict=True):
            places = {'start_on_plan': start, 'end_on_plan': end}
            self._change(id_, plan=plan, chain=tuple(ends), started=math.nan, **places)

    def started(self, id_: str, now: float) -> None:
        """The controller follows the plan with the id of this command."""
        first = self._motions[id_]
        if math.isnan(first.started):
            for member in first.chain:
                if self._motions[member].plan is first.plan:
                    self._change(member, started=now)

    def ended(self, result: MotionResult, now: float) -> None:
        """A motion has its result."""
        if result.id in self._open:
            self._open.remove(result.id)
            self._change(result.id, ended=now, ok=result.ok, message=result.message)

    def _change(self, id_: str, **changes: Any) -> None:
        self._motions[id_] = replace(self._motions[id_], **changes)
