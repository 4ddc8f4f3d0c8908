"""InProcessCell: the cell in one process, except for its drives and its PLC."""

import math
from collections import deque
from collections.abc import Callable, Mapping, Sequence

from robots_controller.cell.program_host import ProgramHost
from robots_controller.control.controller import NO_FEEDBACK, Controller
from robots_controller.control.controller_rates import cycles
from robots_controller.control.span import Span
from robots_controller.control.stops.watched_inputs import WatchedInputs
from robots_controller.io.io_image import Channel, image_sizes
from robots_controller.program.joint_feedback import JointFeedback
from robots_controller.program.run_state import RunState
from robots_controller.program.turn_clock import NANOSECONDS
from robots_controller.simulation.cell_parts import CellParts
from robots_controller.simulation.cost import Cost
from robots_controller.simulation.in_process_controller import InProcessController
from robots_controller.simulation.in_process_planner import InProcessPlanner
from robots_controller.simulation.record.cell_log import CellLog
from robots_controller.simulation.record.simulated_bag import SimulatedBag
from robots_controller.simulation.simulated_clock import START, SimulatedClock
from robots_controller.simulation.simulated_contact import SimulatedContact
from robots_controller.simulation.simulated_guide import GuideSource, SimulatedGuide, guide_of_cell
from robots_core.blocks.collision.along_paths.joint_path import JointPath
from robots_core.blocks.collision.collision_guard import CHECK_RATE, CollisionGuard
from robots_core.blocks.following.guide import Guide
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import NotNowError, ProgramError, RobotsError
from robots_core.validation import Array
from robots_planning.commands.motion_plan import MotionPlan
from robots_planning.motion_settings import MotionSettings

WATCH_PERIOD = 0.1  # s between checks of motions that nothing would end


class InProcessCell:
    """Program, planner and controller of a cell for one run of one program, on a simulated clock.

    After `begin`, what has the drives and the PLC calls `measure`, `take_inputs`, `work` and `step` for each
    period, in this order, and no `work` before the first `step`. In `step` what guides the robot acts first,
    then the controller. Then the drives move the robot, and the PLC sets inputs. After that time stands
    still: the program works until it waits, and the planner plans. The program's own waits end between two
    periods, too. A lock-step run of the nodes goes through the same phases.

    Args:
        parts: Robot, program and blocks.
        bag: Takes the messages of a live cell; None for none.
        on_settings: Called with the modal settings whenever they are set.
        camera: Measures what guides the robot, and records that itself; None for none.
    """

    def __init__(
        self,
        parts: CellParts,
        *,
        bag: SimulatedBag | None = None,
        on_settings: Callable[[MotionSettings], None] = lambda _: None,
        camera: GuideSource | None = None,
    ) -> None:
        self._parts, self._on_settings = parts, on_settings
        self._period_ns = round(parts.period * NANOSECONDS)
        self.clock = SimulatedClock()
        self.cost = Cost()
        self.log = CellLog(parts, bag, self.clock, self.cost)
        self.mail: deque[Callable[[], None]] = deque()
        """What was sent and is not delivered yet, in the order in which it was sent."""
        self.controller: Controller = parts.controller
        self.control = InProcessController(self)
        loop = self.control.loop
        link = InProcessPlanner(self, parts.planning, parts.setup.payload)
        self._planner = link.planner
        self._host = ProgramHost(
            parts.robot,
            clock=self.clock,
            robot_port=self,
            planner=link,
            controller=self.control,
            observer=self.log,
            io_labels=parts.cell_io.labels,
            fail_safe=parts.cell_io.fail_safe,
            payload=parts.setup.payload,
            simulated=True,
        )
        self.program = self._host.program
        self.contact: SimulatedContact | None = None
        if parts.contact is not None:
            self.contact = SimulatedContact(parts.contact, parts.robot, self.program.io, loop, self.log)
        self.guide_player = SimulatedGuide(
            camera or self.contact or guide_of_cell(parts),
            parts.robot,
            loop,
            self._planner,
            self.log,
            method=parts.setup.guided,
        )
        self.guide_player.carry(parts.setup.payload)
        self._guard = None
        if parts.setup.scene and not parts.walked and parts.planning.collision is not None:
            self._guard = CollisionGuard(parts.planning.collision, self._stop_before_collision)
        self._check_every = cycles(1.0 / parts.period, CHECK_RATE)
        self._watch_every = cycles(1.0 / parts.period, 1.0 / WATCH_PERIOD)
        self._watched = WatchedInputs(loop, parts.emergency_stop, parts.zone_inputs)
        self._inputs: dict[str, int] = {}  # images of the inputs that were set, and their sizes
        self._feedback: JointFeedback | None = None  # the newest
        self._started = False
        self.running = False
        """The program has not ended."""
        self.changed = False
        """Something has happened that the program may wait for."""

    # -- the phases -------------------------------------------------------------------------------

    def begin(self, inputs: Mapping[Channel, float]) -> None:
        """Open the program, with the values of its inputs at the start.

        Raises:
            RobotsError: the program cannot be opened or is not Lua.
        """
        io, mode = self.program.io, self.controller.speed.authority.mode
        for channel, value in inputs.items():
            io.set_value(io.find(channel.name), value)
        self._inputs = image_sizes(inputs)
        self.log.begin(io, self._inputs, mode)
        setup = self._parts.setup
        self._host.open(setup.program, setup.points_file, setup.frames)
        self._host.mode_changed(mode)
        self._watch_inputs()

    def step(self) -> Array | None:
        """Go on to the next period, and let the controller make its step.

        Returns:
            The reference at the end of the period, (3, n): position, velocity, acceleration; None before the
            first feedback.
        """
        self.clock.nanoseconds = (self.cycle + 1) * self._period_ns
        before = self.cost.switch('controller')
        self.guide_player.step(self.clock.stamp)
        reference = self.control.step()
        self.cost.switch(before)
        return reference

    def measure(self, feedback: JointFeedback | None) -> None:
        """Take what the robot measures at the end of the period, None if nothing came."""
        self.control.position = None
        if feedback is not None:
            self._feedback, self.control.position = feedback, feedback.position
            if self.contact is not None:
                self.contact.measure(feedback)
            if self._guard is not None and self.cycle >= 0 and self.cycle % self._check_every == 0:
                seen = self._guard.check(feedback.position, feedback.velocity)
                self.log.value('min_distance', seen.distance)
                self.log.report('collision_status', seen.status)
        self._deliver()

    def take_inputs(self, changes: Sequence[tuple[Channel, float]]) -> None:
        """Take what the PLC has set, in its order, and do what is due regularly."""
        for channel, value in changes:
            self._inputs[channel.image] = max(self._inputs.get(channel.image, 0), channel.index)
            if self.program.io.set_value(channel, value):
                self.log.input(channel, value, self._inputs[channel.image])
                self.changed = True
        if changes:
            self._watch_inputs()
        if self.cycle % self._watch_every == 0 and self.log.motions.any_open:
            self._host.motions.watch()
        if self._host.reporter.due:
            self._host.reporter.report_in_time()
        self._deliver()

    def work(self) -> None:
        """Let the program work and the planner plan, until only time lets them continue.

        The program starts with the first call: it finds a robot that stands, and its position.
        """
        if not self._started:
            self._start()
        clock = self.clock
        while True:
            self._deliver()
            if self.running and not clock.waiting:
                self._end_program()
            if not self.changed:
                if self.wait >= START + (self.cycle + 1) * self._period_ns:
                    return
                clock.nanoseconds = max(clock.nanoseconds, int(self.wait) - START)
            self.changed = False
            if clock.waiting:
                self.cost.switch('program')
                clock.yield_to_program()
                self.cost.switch('other')

    def pass_over(self, until: float) -> int:
        """Leave out periods of a robot that stands; returns how many, 0 if there are too few.

        Args:
            until: Time of the next event outside of this cell, s since the start; finite.
        """
        # A line is reported some periods after it was reached, not after its wait.
        if self._host.reporter.due or self.control.loop.pending:
            return 0
        until = min(until, (self.wait - START) / NANOSECONDS)
        last = math.floor(until / self._parts.period) - 1
        # Time without feedback ends with a period that has it: it must not seem to be lost.
        every = self.control.rates.holding_every
        last -= last % every + 1
        count = last - self.cycle
        if count < every:
            return 0
        self.control.loop.pass_over(count)
        self.clock.nanoseconds = last * self._period_ns
        return count

    def ahead(self, until: float, periods: int) -> Span:
        """The next periods in which the controller continues as before, and nothing else happens.

        Args:
            until: Time of the next event outside of this cell, s since the start; infinite for none.
            periods: At most so many.
        """
        event = min(until * NANOSECONDS, self.wait - START)
        if event < math.inf:
            periods = min(periods, int(event) // self._period_ns - 1 - self.cycle)
        elif self.control.holding:  # nothing may ever happen
            periods = 0
        if self._guard is not None:
            until_check = self._check_every - 1 - self.cycle % self._check_every
            periods = 0 if self._guard.endangered else min(periods, until_check)
        if self.guide_player.started or self._host.reporter.due or self._host.motions.timed:
            periods = 0
        span = self.control.loop.ahead(self.clock.now(), periods)
        # A switch on the path is due in the period in which its place is reached.
        return span.first(int(span.progress.searchsorted(self._host.switching.next_progress)))

    def close(self) -> None:
        """End the program, if it still runs."""
        self.program.stop()
        self.clock.end()
        if self.running:
            self._end_program()

    # -- what there is ----------------------------------------------------------------------------

    @property
    def cycle(self) -> int:
        """Number of the last period; -1 before the first one."""
        return self.control.cycle

    @property
    def error(self) -> ProgramError | None:
        """Why the program has failed; None if it has not."""
        return self.log.given_up or self.program.error

    @property
    def run_state(self) -> RunState:
        """What the program does, or how it has ended."""
        return RunState.FAILED if self.error is not None else self.program.run_state

    @property
    def wait(self) -> float:
        """Until when the program waits, ns on the clock; infinite for a change alone."""
        return self.clock.deadline_stamp if self.clock.waiting else math.inf

    # -- inside -----------------------------------------------------------------------------------

    def _start(self) -> None:
        self._started = self.running = True
        self.cost.switch('program')
        try:
            self._host.run()
        except RobotsError as error:  # a fault stops the robot from the start, or no program runs in the mode
            self.log.given_up = ProgramError(str(error), file=self.program.file)
            self.running = False
        self.cost.switch('other')

    def _deliver(self) -> None:
        while self.mail:
            self.mail.popleft()()

    def _end_program(self) -> None:
        self.running = False
        self.program.join()

    def _watch_inputs(self) -> None:
        """Stop for the digital inputs that are published, and close zones by them."""
        bits = self.program.io.bits('digital_inputs')
        image = bits[: self._inputs.get('digital_inputs', 0)].tolist()
        self._watched.check(image, self._parts.cell_io.unknown_offline)

    def _stop_before_collision(self, reason: str) -> bool:  # noqa: ARG002  # as the service, which takes none
        self.control.loop.stop_before_collision()
        return True

    # -- from the controller and the planner --------------------------------------------------------

    def motion_started(self) -> None:
        """The controller begins with the oldest motion."""
        if self._planner.motions:
            self.log.motions.started(self._planner.motions[0].id, self.clock.elapsed)

    def progressed(self, progress: float) -> None:
        """Done part of the path, in the period in which it was reached."""
        now = self.clock.now()
        self.mail.append(lambda: self._host.switching.progress(now, progress))
        if self._guard is not None:
            self._guard.progress(progress)

    def settings_changed(self, settings: MotionSettings) -> None:
        """The modal settings are set."""
        self._on_settings(settings)
        self.guide_player.carry(settings.payload)
        self.controller.speed.set_tool(settings.tool_pose.r)

    def motion_planned(self, plan: MotionPlan) -> None:
        """A plan goes to the controller; see `MotionPlannerPort.send`."""
        trajectory = plan.trajectory
        self._host.switching.planned(plan.id, plan.ends, lambda: trajectory)
        if self._guard is not None:
            self._guard.planned(plan.id, JointPath(*trajectory.points))

    def control_ended(self, result: MotionResult) -> None:
        """The controller has ended a motion."""
        self._planner.result(result, self.clock.now())
        self.motion_ended(result)

    def motion_ended(self, result: MotionResult) -> None:
        """A motion has ended, in the controller or before it reached that."""
        if self._guard is not None:
            self._guard.ended(result)
        if not result.blocked:
            self.log.motions.ended(result, self.clock.elapsed)
        self.control.loop.ended(result)
        self._host.motions.result(result)
        self.changed = True

    def run_enabled(self, *, enabled: bool) -> None:
        """Motions of programs may continue, or not any more."""
        if enabled is not self._host.permission.enabled:
            self.mail.append(lambda: self._let_run(enabled=enabled))

    def _let_run(self, *, enabled: bool) -> None:
        self._host.run_enabled(enabled=enabled)
        self.changed = True

    def stopped(self, reason: str) -> None:
        """A fault stops the robot."""
        self._host.stop_changed(reason)
        self.changed = True

    # -- the program's robot ------------------------------------------------------------------------

    def joint_feedback(self) -> JointFeedback:
        """See `RobotPort`."""
        if self._feedback is None:
            raise NotNowError(NO_FEEDBACK)
        return self._feedback

    def guide(self, guide: Guide) -> None:
        """See `RobotPort`."""
        if self._parts.walked:
            return
        self.guide_player.hand_over(guide, self.clock.stamp)
        self.log.value('guide', guide.value)
