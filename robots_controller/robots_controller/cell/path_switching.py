"""PathSwitching: switches outputs at their places on the path, by the controller's progress."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

from robots_controller.program.motions.motion_command import MotionCommand, OutputChange, PathSwitch
from robots_controller.program.motions.path_switches import PathSwitches, switches_on_path
from robots_core.validation import Array

if TYPE_CHECKING:
    from robots_planning.trajectory import Trajectory

# Between two reports, a prediction further ahead than this waits for the next report.
FARTHEST_PREDICTION: Final = 0.08  # s


@dataclass(frozen=True, eq=False)
class _Plan:
    """A planned motion with its commands, by id."""

    commands: dict[str, MotionCommand]
    switches: PathSwitches

    def leave(self, ids: Iterable[str]) -> None:
        """Another plan carries these commands on."""
        left = [self.commands.pop(id_) for id_ in ids if id_ in self.commands]
        self.switches.leave(left)


class PathSwitching:
    """The switches of all motions on their way; safe from any thread.

    The planned motion comes with the commands in it and their ends; it gives the place of the tool at each
    progress. Where progress is reported in each period of the controller, outputs
    switch in the period in which their place is reached. Where it is reported less often, progress is
    extrapolated in between with the speed that it had (see `next_time`): at constant speed outputs switch
    within some milliseconds, while the robot accelerates or brakes within acceleration * (0.04 s)^2 / 2 of
    their place, 2 mm at 2 m/s^2.

    Args:
        direct_kinematics: Position (3,) and orientation (3, 3) of tool0 for joint positions.
        switch: Switches an output; from any thread.
    """

    def __init__(
        self,
        direct_kinematics: Callable[[Array], tuple[Array, Array]],
        switch: Callable[[OutputChange], None],
    ) -> None:
        self._direct_kinematics, self._switch = direct_kinematics, switch
        self._lock = threading.RLock()
        self._sent: dict[str, MotionCommand] = {}  # without a plan yet, oldest first
        self._commanded: dict[str, MotionCommand] = {}  # with and without
        self._planned: dict[str, _Plan] = {}  # oldest first: the controller follows the first
        self._at_targets: dict[MotionCommand, list[OutputChange]] = {}  # of motions without a plan yet
        self._next_time = math.inf

    @property
    def next_time(self) -> float:
        """When the next switch is due by extrapolation, s; infinite if unknown until the next report."""
        with self._lock:
            return self._next_time

    @property
    def pending(self) -> bool:
        """Outputs will be switched on the paths planned so far."""
        with self._lock:
            return any(plan.switches.next_progress < math.inf for plan in self._planned.values())

    @property
    def next_progress(self) -> float:
        """Progress of the motion under way at which the next switch is due, 0..1; infinite for none."""
        with self._lock:
            running = next(iter(self._planned.values()), None)
            return math.inf if running is None else running.switches.next_progress

    def sent(self, id_: str, command: MotionCommand) -> None:
        """A motion was sent to the planner."""
        with self._lock:
            self._commanded[id_] = command
            switches = tuple(replace(switch, line=command.line) for switch in command.switches)
            self._sent[id_] = replace(command, switches=switches) if switches else command

    def switch_at_target(self, command: MotionCommand, change: OutputChange) -> None:
        """Switch an output at the target of a motion under way; if it has its plan, `left` gives it back."""
        with self._lock:
            self._at_targets.setdefault(command, []).append(change)

    def left(self, command: MotionCommand) -> list[OutputChange]:
        """What is to be switched at the target of a motion and is on no plan, once."""
        with self._lock:
            return self._at_targets.pop(command, [])

    def waits_for(self, id_: str) -> bool:
        """A motion was sent, and no plan has its id yet."""
        with self._lock:
            carried = any(id_ in plan.commands for plan in self._planned.values())
            return id_ in self._sent or (carried and id_ not in self._planned)

    def planned(
        self, id_: str, ends: Mapping[str, float], trajectory: Callable[[], Trajectory | None]
    ) -> None:
        """A motion, or a chain of them, was planned: what an earlier plan shares with it is done by it.

        Args:
            id_: The plan's id.
            ends: When each of its commands ends, s of the plan, by id and in order.
            trajectory: Gives the plan, None if it is not valid; called only where outputs are switched.
        """
        with self._lock:
            on_their_way = dict(self._sent)
            for before in self._planned.values():
                on_their_way |= before.commands
            ids = [one for one in ends if one in on_their_way]
            if not ids:
                return
            commands = {one: self._with_targets(one, on_their_way[one]) for one in ids}
            for one in commands:
                self._sent.pop(one, None)
            for before in self._planned.values():
                before.leave(commands)
            plan = trajectory() if any(command.switches for command in commands.values()) else None
            switches = PathSwitches((), 0.0)
            if plan is not None:
                chain = [(ends[one], command) for one, command in commands.items()]
                switches = switches_on_path(chain, plan, self._direct_kinematics)
            self._planned[id_] = _Plan(commands, switches)

    def progress(self, now: float, progress: float) -> None:
        """The controller has done this part of the motion that it follows, 0..1; now in s."""
        with self._lock:
            self._next_time = math.inf
            running = next(iter(self._planned.values()), None)
            # A report of 1 may belong to the motion before: `finish` handles the end.
            if running is None or progress >= 1.0:
                return
            self._switch_all(running.switches.due(progress))
            delay = running.switches.delay(now, progress)
            if delay < FARTHEST_PREDICTION:
                self._next_time = now + delay

    def step(self, now: float) -> None:
        """Switch what is due by extrapolation at a time, s."""
        with self._lock:
            running = next(iter(self._planned.values()), None)
            if running is None or now < self._next_time:
                return
            self._next_time = math.inf
            self._switch_all(running.switches.due(running.switches.next_progress))

    def drop(self) -> None:
        """Switch nothing any more for the motions on their way."""
        with self._lock:
            for motions in (self._sent, self._commanded, self._planned, self._at_targets):
                motions.clear()
            self._next_time = math.inf

    def blocked(self, id_: str) -> None:
        """An obstacle has stopped a motion: what it has not switched waits for its next plan, or its end."""
        with self._lock:
            plan = self._planned.pop(id_, None)
            if plan is not None:
                waiting = {
                    one: replace(command, switches=plan.switches.waiting(command))
                    for one, command in plan.commands.items()
                    if one in self._commanded
                }
                self._sent = {**waiting, **self._sent}
            self._next_time = math.inf

    def finish(self, id_: str, *, ok: bool) -> None:
        """A motion has ended: what is left on a path that led to its end is switched now.

        One that fails takes those with it that were sent after it; motions before it continue to their ends.
        """
        with self._lock:
            if not ok:
                if id_ in self._planned:
                    self._sent.clear()
                for motions in (self._sent, self._commanded, self._planned):
                    _drop_from(motions, id_)
            command, plan = self._sent.pop(id_, None), self._planned.pop(id_, None)
            self._commanded.pop(id_, None)
            self._switch_all(() if command is None else command.switches)
            self._switch_all(() if plan is None else plan.switches.due(1.0))
            self._next_time = math.inf

    def _with_targets(self, id_: str, command: MotionCommand) -> MotionCommand:
        """A motion, maybe of an earlier plan with some, with its switches at its target."""
        changes = self.left(self._commanded.get(id_, command))
        added = [
            PathSwitch('time_before_end', 0.0, one.kind, one.index, one.value, one.line) for one in changes
        ]
        return replace(command, switches=(*command.switches, *added)) if added else command

    def _switch_all(self, due: Iterable[PathSwitch]) -> None:
        for switch in due:
            self._switch(OutputChange(switch.kind, switch.index, switch.value, switch.line))


def _drop_from(motions: dict[str, Any], id_: str) -> None:
    """Drop a motion and those after it."""
    ids = list(motions)
    for after in ids[ids.index(id_) :] if id_ in motions else ():
        del motions[after]
