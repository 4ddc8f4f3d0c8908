"""ForceGuide: force control guides the robot while its program permits it; problems stop the robot."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

from robots_controller.cell.contact_setup import ContactSetup
from robots_controller.io.io_image import Channel
from robots_core.blocks.following.following_methods import RATE
from robots_core.blocks.force_control.force_control import ForceControl
from robots_core.blocks.force_control.force_watch import ForceWatch
from robots_core.blocks.terramechanics.wheel_contact import LARGEST_SLIP
from robots_core.errors import InvalidInputError
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array

PERIOD: Final = 1.0 / RATE  # s


class ForceGuide:
    """Twists of the tool from measured forces and the outputs of the program, 250 times a second.

    After a problem there is no twist until the robot was taken back.

    Args:
        setup: Force control, and the outputs that command it.
        robot: The robot.
        on_problem: Gets what must stop the robot, once; '' when it is over.
        share: See `Watchdog`.
    """

    def __init__(
        self,
        setup: ContactSetup,
        robot: BaseRobotModel,
        on_problem: Callable[[str], None],
        *,
        share: Callable[[], float] = lambda: 1.0,
    ) -> None:
        self._setup, self._robot, self._on_problem = setup, robot, on_problem
        self._control = ForceControl(setup.control, PERIOD)
        self._watch = ForceWatch(setup.control, share=share)
        self._handed_over = False
        self._problem = ''

    def hand_over(self, *, handed_over: bool) -> None:
        """Let force control guide the robot, or not any more."""
        if handed_over and not self._handed_over:
            self._control.begin()
        self._handed_over = handed_over

    def measured(self, wrench: Array, q: Array) -> None:
        """Take what was measured.

        Args:
            wrench: On the tool, in tool0, (6,) N and N m.
            q: Joint positions, (n,), rad (m).

        Raises:
            InvalidInputError: another shape, or NaN or infinity.
        """
        _, T = self._robot.direct_kinematics(q)
        self._watch.measured(T @ wrench[:3])

    def step(self, now: float, outputs: Mapping[Channel, float]) -> Array | None:
        """Twist of the tool for the next period, (6,), m/s and rad/s, base frame; None for no guidance.

        Args:
            now: s.
            outputs: Values of the program's outputs.
        """
        problem = self._watch.problem(now, controlled=self._handed_over)
        twist = None
        if self._handed_over and not problem and not self._problem:
            try:
                twist = self._pressed(outputs)
            except InvalidInputError as error:
                problem = error.message
        if problem and not self._problem:
            self._problem = problem
            self._on_problem(problem)
        elif self._problem and not problem and not self._handed_over:
            self._problem = ''
            self._on_problem('')
        return twist

    def _pressed(self, outputs: Mapping[Channel, float]) -> Array:
        setup = self._setup
        slip = outputs[setup.slip]
        if not 0.0 <= slip <= LARGEST_SLIP:
            raise InvalidInputError(f'a slip of {slip:g} is commanded; valid is 0 to {LARGEST_SLIP:g}')
        force = self._watch.force
        assert force is not None
        return self._control.step(force, outputs[setup.load], outputs[setup.speed])
