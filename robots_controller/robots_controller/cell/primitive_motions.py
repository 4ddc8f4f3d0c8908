"""PrimitiveMotions: a program's motions as sequences of primitives for the robot's own controller."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from typing import Final, Protocol

from robots_controller.cell.path_switching import PathSwitching
from robots_controller.cell.ports import Configured, PlannerPort
from robots_controller.control.controller_request import ControllerRequest
from robots_controller.program.motions.modal_settings import motion_settings
from robots_controller.program.motions.motion_command import MotionCommand
from robots_controller.program.motions.planned_primitive import PlannedPrimitive, PrimitivePlanner
from robots_core.blocks.following.guide import Guide
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import PlanningError, ProgramError, RobotsError
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.commands.motion_primitives import MOST_PRIMITIVES, MotionPrimitive

CANCELED: Final = 'canceled'


class PrimitiveDriver(Protocol):
    """What executes sequences, one after the other. Reports come to `advanced` and `ended`."""

    @property
    def name(self) -> str:
        """For people."""

    @property
    def served(self) -> bool:
        """It takes sequences."""

    def send(self, primitives: Sequence[MotionPrimitive]) -> None:
        """Execute a sequence."""

    def cancel(self) -> None:
        """Stop the robot, and end the sequence."""

    def wake(self) -> None:
        """Call `step` soon, in the thread of the reports; from any thread."""


class PrimitiveMotions(PlannerPort):
    """The motions of one program.

    A motion that stops at its end is a sequence with those before it that blend into it. What other threads
    ask for is done in `step`; all else happens in the thread of the reports.

    Args:
        robot: The robot.
        driver: Executes the primitives.
        measured: Joint positions that the robot measures, (n,); None before the first.
    """

    def __init__(
        self, robot: BaseRobotModel, driver: PrimitiveDriver, measured: Callable[[], Array | None]
    ) -> None:
        self._robot, self._driver, self._measured = robot, driver, measured
        self._planner = PrimitivePlanner(robot, driver.name)
        self._asked: deque[Callable[[], None]] = deque()  # by other threads
        self._settings: dict[str, object] = {}
        self._last_id = 0
        self._waiting: deque[PlannedPrimitive] = deque()
        self._moving: list[PlannedPrimitive] = []  # the sequence that the driver has, from where it is
        self._passed = 0  # motions of that sequence that have ended
        self._flushed = False  # nothing follows the motions that wait
        self._interrupted = False  # the robot stands on the path of the first that waits
        self._paused = False
        self._canceled = ''  # why the sequence was canceled
        self._override = 1.0
        self._progress = 0.0  # of the motion under way
        self.on_result: Callable[[MotionResult], None] = lambda _: None
        """Gets the results of the motions."""
        self.switching: PathSwitching | None = None
        """Switches outputs on the path."""

    # -- the program's end, from any thread -----------------------------------------------------------

    @property
    def name(self) -> str:
        """See `PlannerPort`."""
        return self._driver.name

    def plans(self, command: MotionCommand) -> bool:  # noqa: ARG002
        """See `PlannerPort`: what is no primitive is refused with its reason."""
        return self._driver.served

    def differs(self, settings: Mapping[str, object]) -> bool:
        """See `PlannerPort`."""
        return dict(settings) != self._settings

    def configure(self, settings: Mapping[str, object], done: Configured, *, moving: bool) -> None:  # noqa: ARG002
        """See `PlannerPort`."""
        try:
            motion_settings(settings, self.name)
        except PlanningError as error:
            done(error)
            return
        self._settings = dict(settings)
        done(None)

    def flush(self, settings: Mapping[str, object]) -> None:  # noqa: ARG002
        """See `PlannerPort`."""
        self._ask(self._flush)

    def next_id(self) -> str:
        """See `PlannerPort`."""
        self._last_id += 1
        return f'{self._last_id}'

    def command(self, id_: str, command: MotionCommand) -> None:
        """See `PlannerPort`."""
        settings = self._settings
        self._ask(lambda: self._plan(id_, command, settings))

    def check_guide(self, guide: Guide) -> None:
        """Refuse a guide: the robot's own controller takes whole motions.

        Raises:
            ProgramError: a sensor or a person is to guide the robot.
        """
        if guide is not Guide.NONE:
            raise ProgramError(f'{self.name} takes motion primitives, and cannot be guided')

    def followers(self) -> Mapping[bytes, str]:
        """See `PlannerPort`."""
        return {self.name.encode(): self.name} if self._driver.served else {}

    def request(self, request: ControllerRequest) -> None:
        """See `ControllerPort`."""
        work = {'pause': self._pause, 'resume': self._resume, 'cancel': self._cancel}
        self._ask(work[request])

    def set_override(self, value: float) -> None:
        """See `ControllerPort`: for the sequences that follow; 0 stops the one that runs."""

        def change() -> None:
            self._override = value
            if value == 0.0:
                self._interrupt()

        self._ask(change)

    def _ask(self, work: Callable[[], None]) -> None:
        self._asked.append(work)
        self._driver.wake()

    # -- the driver's end -----------------------------------------------------------------------------

    def step(self) -> None:
        """Do what was asked for, and send what is due."""
        while self._asked:
            self._asked.popleft()()
        self._send()

    def check(self, now: float) -> None:
        """Switch outputs on the path of the motion under way, by where the robot is; now in s."""
        q = self._measured() if self._moving else None
        if q is not None and self.switching is not None:
            self._progress = self._moving[0].progress(q, self._progress)
            self.switching.progress(now, self._progress)

    def advanced(self, index: int) -> None:
        """The driver executes this primitive of its sequence: those before it have ended."""
        for _ in range(min(index - self._passed, len(self._moving) - 1)):
            self._finish('passed')

    def ended(self, error: str = '', *, canceled: bool = False) -> None:
        """The sequence has ended.

        Args:
            error: Why the robot is not at its end; '' if it is.
            canceled: It was canceled.
        """
        why, self._canceled = self._canceled, ''
        if not error and not canceled:
            while self._moving:
                self._finish('reached')
        elif canceled and why == 'pause':
            self._waiting.extendleft(reversed(self._moving))
            self._moving.clear()
            self._flushed = self._interrupted = True
        else:
            reason = CANCELED if why == CANCELED else error or f'{self.name} has canceled the motion'
            self._give_up(reason)
        self._send()

    # -- inside ---------------------------------------------------------------------------------------

    def _plan(self, id_: str, command: MotionCommand, settings: Mapping[str, object]) -> None:
        before = [*self._moving, *self._waiting]
        start = before[-1].trajectory.position[-1] if before else self._measured()
        try:
            if start is None:
                raise PlanningError('no joint_states received: is the driver running?')
            if len(before) >= MOST_PRIMITIVES:
                raise PlanningError(f'a sequence has at most {MOST_PRIMITIVES} primitives that blend')
            planned = self._planner.plan(id_, command, settings, start)
        except RobotsError as error:
            self.on_result(MotionResult.refused(id_, error))
            return
        self._waiting.append(planned)
        self._flushed = False
        if self.switching is not None:
            trajectory = planned.trajectory
            self.switching.planned(id_, {id_: trajectory.duration}, lambda: trajectory)

    def _flush(self) -> None:
        self._flushed = True

    def _send(self) -> None:
        if self._moving or self._paused or self._override == 0.0:
            return
        ends = [k for k, one in enumerate(self._waiting, 1) if not one.primitive.blend_radius]
        count = ends[0] if ends else len(self._waiting) if self._flushed else 0
        if not count:
            return
        group = [self._waiting.popleft() for _ in range(count)]
        q = self._measured()
        if self._interrupted and q is not None:
            group[0] = group[0].rest(self._robot, q)
        else:
            self._progress = 0.0
        self._interrupted, self._passed, self._moving = False, 0, group
        last = group[-1]
        self._driver.send([one.scaled(self._override, last=one is last) for one in group])

    def _finish(self, message: str) -> None:
        one = self._moving.pop(0)
        self._passed += 1
        self._progress = 0.0
        self.on_result(MotionResult(one.id, ok=True, message=message))

    def _pause(self) -> None:
        self._paused = True
        self._interrupt()

    def _interrupt(self) -> None:
        if self._moving and not self._canceled:
            self._canceled = 'pause'
            self._driver.cancel()

    def _resume(self) -> None:
        self._paused = False

    def _cancel(self) -> None:
        self._paused = False
        if not self._moving:
            self._give_up(CANCELED)
            return
        if not self._canceled:
            self._driver.cancel()
        self._canceled = CANCELED

    def _give_up(self, reason: str) -> None:
        left = [*self._moving, *self._waiting]
        self._moving.clear()
        self._waiting.clear()
        self._flushed = self._interrupted = False
        for one in left:
            self.on_result(MotionResult(one.id, ok=False, message=reason))


class PrimitiveControl:
    """The robot's own controller: `ControllerPort`. Nobody else commands the robot through this suite."""

    def __init__(self, motions: PrimitiveMotions) -> None:
        self.request, self.set_override = motions.request, motions.set_override

    def command(self, *, taken: bool) -> None:
        """See `ControllerPort`: the robot is the program's."""

    def wait_for_command(self) -> None:
        """See `ControllerPort`: there is no answer to wait for."""
