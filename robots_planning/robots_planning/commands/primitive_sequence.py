"""PrimitiveSequence: the motions of a goal of ExecuteMotionPrimitiveSequence as commands to the planner."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import InvalidInputError, PlanningError, RobotsError
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_planning.commands.goal_outcome import INVALID_GOAL, SUCCESSFUL, Outcome
from robots_planning.commands.motion_planner import MotionPlanner
from robots_planning.commands.motion_primitives import MOST_PRIMITIVES, MotionPrimitive
from robots_planning.motion_settings import MotionSettings

Command: TypeAlias = tuple[MotionPrimitive, MotionSettings]


def checked_commands(
    messages: Sequence[Any],
    read: Callable[[Any], MotionPrimitive],
    robot: BaseRobotModel,
    modal: MotionSettings,
) -> list[Command]:
    """The primitives of a sequence, by what reads one, with their settings; `modal` as in `settings`.

    Raises:
        InvalidInputError: too few or too many, or one that is not valid; names it.
    """
    if not 0 < len(messages) <= MOST_PRIMITIVES:
        raise InvalidInputError(f'a sequence needs 1 to {MOST_PRIMITIVES} primitives, got {len(messages)}')
    found = []
    for index, message in enumerate(messages):
        try:
            primitive = read(message)
            settings = primitive.settings(robot, modal, last=index == len(messages) - 1)
        except RobotsError as error:
            raise InvalidInputError(f'primitive {index}: {error.message}') from error
        found.append((primitive, settings))
    return found


class PrimitiveSequence:
    """A sequence under way."""

    def __init__(self, planner: MotionPlanner) -> None:
        self._planner = planner
        self._ids: list[str] = []
        self._open: set[str] = set()  # of the commands that have not ended
        self._index = -1  # of the primitive that was reported last
        self.outcome = Outcome(SUCCESSFUL, 'reached')
        """What it is by the motions that have ended: the first one that fails counts."""

    @property
    def moves(self) -> bool:
        """It has begun, and some of its commands have not ended."""
        return bool(self._open)

    def begin(self, commands: Sequence[Command], ids: Sequence[str]) -> None:
        """Command all motions, with these ids.

        Raises:
            PlanningError: the robot moves.
        """
        if self._planner.moving:
            raise PlanningError('the robot is still moving; wait for its motion_result or stop it')
        self._ids, self._open = list(ids), set(ids)
        for id_, (primitive, settings) in zip(ids, commands, strict=True):
            self._planner.command(id_, primitive.kind, primitive.target, settings)

    def ended(self, result: MotionResult) -> bool:
        """One of its commands has ended; returns whether the sequence has."""
        self._open.discard(result.id)
        if not result.ok and self.outcome.code == SUCCESSFUL:
            text = f'primitive {self._ids.index(result.id)}: {result.message}'
            self.outcome = Outcome(INVALID_GOAL, text)
        return not self._open

    def advanced(self, progress: float) -> int | None:
        """The index of the primitive that is executed, once for each; None if it was returned before.

        Args:
            progress: Done part of the path that the controller follows, 0..1.
        """
        motions = self._planner.motions
        current = motions[0].left(progress)[0] if motions else ''
        if current not in self._open or (index := self._ids.index(current)) <= self._index:
            return None
        self._index = index
        return index

    def give_up(self) -> bool:
        """Give up what is not planned yet; returns whether the robot has to be stopped."""
        if self._open:
            self._planner.give_up('its goal was stopped')
        return self.moves
