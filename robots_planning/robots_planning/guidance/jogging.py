"""Jogging: a stream of references from a `TeachBox` while somebody jogs."""

from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robots_core.errors import InvalidInputError, PlanningError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.guidance.jog_axes import JogAxes
from robots_planning.guidance.teach_box import JOG_DEVIATION, JOG_RATE, TeachBox, TeachStep

NOT_FOLLOWING = 'a controller that does not follow'


class Jogging:
    """Jogs a robot that stands and has no motion; the stream ends when it stands again.

    A command holds for `timeout` from when it was given: a pendant keeps sending, and lets go by
    sending nothing. Commands and steps may come from two threads.

    Args:
        robot: The robot.
        standing: Where the robot's reference stands, (n,); raises a PlanningError if it moves.
        busy: A motion is planned or runs: no jogging.
        reference: The newest joint positions (n,) of the controller's reference; None for none since the
            last call.
        options: Speeds and timeout; see `TeachBox`.

    Raises:
        InvalidInputError: an option out of its range.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        *,
        standing: Callable[[], Array],
        busy: Callable[[], bool],
        reference: Callable[[], Array | None],
        **options: Any,
    ) -> None:
        self._standing, self._busy, self._reference = standing, busy, reference
        self._make_box = partial(TeachBox, robot, 1.0 / JOG_RATE, **options)
        self._tool, self._hold = Pose.identity(), ''
        # Made at the start, so that jogging does not wait for it.
        self._next_box: TeachBox | None = self._make_box(q=robot.home)
        self._box = self._next_box
        self._commands: deque[Callable[[TeachBox], None]] = deque()
        self._over = False
        self.active = False
        """The robot is jogged, or brakes from it."""
        self.limits: tuple[str, ...] = ()
        """What stops or slows it, as in `TeachStep`."""

    def use_tool(self, tool: Pose, hold: str = '') -> None:
        """From the next jog on, jog this tool centre point, a pose in tool0, with `held_by` of `hold`."""
        if self._tool.distance_to(tool) != (0.0, 0.0) or self._hold != hold:
            self._tool, self._hold, self._next_box = tool, hold, None

    def jog_axes(self, velocity: ArrayLike, age: float, now: float) -> bool:
        """Take a command for the axes.

        Args:
            velocity: (n,), rad/s (m/s).
            age: Time since it was given, s.
            now: On the same clock as `step`, s.

        Returns:
            A stream begins: `step` is to be called from now on.

        Raises:
            InvalidInputError: a value that is not finite.
            PlanningError: the command is stale, or the robot moves otherwise.
        """
        values = np.asarray(velocity, dtype=np.float64)
        return self._jog(values, age, lambda box: box.jog_axes(values, now - max(age, 0.0)))

    def jog_tool(self, twist: ArrayLike, axes: JogAxes, age: float, now: float) -> bool:
        """Take a command for the tool, (6,) in m/s and rad/s, along and about these axes; see `jog_axes`."""
        values = np.asarray(twist, dtype=np.float64)
        return self._jog(values, age, lambda box: box.jog_tool(values, now - max(age, 0.0), axes))

    def step(self, now: float) -> TeachStep | None:
        """Motion of the next period, now in s; None when the stream is over, and `end` is to be called."""
        if self._over and not self._commands:
            return None
        box = self._box
        while self._commands:
            self._commands.popleft()(box)
        reference = self._reference()
        if reference is not None and np.abs(reference - box.q).max() > JOG_DEVIATION:
            self.limits = (NOT_FOLLOWING,)
            return None
        step = box.step(now)
        self.limits = step.limits
        # The last point has no acceleration that the controller could extrapolate.
        self._over = step.standing and not step.q_ddot.any() and not step.jogging
        return step

    def end(self) -> None:
        """End the stream; the next command starts another one."""
        self.active = False

    def _jog(self, command: Array, age: float, put: Callable[[TeachBox], None]) -> bool:
        timeout = self._box.timeout
        if age > timeout:
            raise PlanningError(
                f'the command is {age:.3g} s old, allowed is {timeout:g} s: are the clocks the same?',
                age=age,
            )
        if not np.isfinite(command).all():
            raise InvalidInputError(f'the command is {command.tolist()}, every value must be a finite number')
        if self.active:
            self._commands.append(put)
            return False
        if not command.any():
            return False
        self._start(put)
        return True

    def _start(self, put: Callable[[TeachBox], None]) -> None:
        if self._busy():
            raise PlanningError('a motion runs; the robot can be jogged when it has ended')
        q = self._standing()
        if self._next_box is None:
            self._next_box = self._make_box(q=q, tool=self._tool, hold=self._hold)
        self._box = self._next_box
        self._box.place(q)
        self._reference()  # older than this jog
        self._commands.clear()
        self._commands.append(put)
        self._over, self.active = False, True
