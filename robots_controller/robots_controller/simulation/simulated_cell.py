"""SimulatedCell: the cell in one process, on a simulated clock."""

import math
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from robots_controller.cell.program_host import ProgramHost
from robots_controller.control.control_loop import ControllerRequest, ControlLoop
from robots_controller.control.controller import ControllerState
from robots_controller.control.controller_rates import ControllerRates, cycles
from robots_controller.control.stop_latch import StopState
from robots_controller.program.joint_feedback import JointFeedback
from robots_controller.program.turn_clock import NANOSECONDS
from robots_controller.simulation.cell_parts import CellParts
from robots_controller.simulation.cost import Cost
from robots_controller.simulation.deadlock_detection import DeadlockDetection
from robots_controller.simulation.in_process_planner import InProcessPlanner, Mail
from robots_controller.simulation.record.cell_log import CellLog
from robots_controller.simulation.record.recording import Recording
from robots_controller.simulation.record.simulated_bag import SimulatedBag
from robots_controller.simulation.simulated_clock import START, SimulatedClock
from robots_controller.simulation.simulated_guide import SimulatedGuide
from robots_controller.simulation.simulated_plc import SimulatedPlc
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core.blocks.collision.collision_guard import LOOK_RATE, CollisionGuard
from robots_core.blocks.collision.joint_path import JointPath
from robots_core.blocks.drives.supervised_drives import SupervisedDrives
from robots_core.blocks.following.guide import Guide
from robots_core.blocks.multibody.carried_payload import CarriedPayload
from robots_core.errors import ProgramError, RobotsError
from robots_core.motion_result import MotionResult
from robots_core.operating_modes import Commander
from robots_core.validation import read_only
from robots_planning.motion_settings import MotionSettings
from robots_planning.trajectory import Trajectory

WATCH_PERIOD = 0.1  # s between looks at motions that nothing would end


class SimulatedCell:
    """A cell for one run of one program.

    In each period what guides the robot acts first, then the controller makes one step, then the drives,
    then the PLC. After that time stands still: the program works until it waits, and the planner plans. The
    program's own waits end between two periods, too. A lock-step run of the nodes goes through the same
    phases. See `CellParts` for the parts.

    Args:
        parts: Robot, program and blocks.
        bag: Folder of a bag to write, or None.
        longest: Longest simulated time, s.
        on_progress: Called now and then: time in s, line of the program. For a progress bar.

    Raises:
        RobotsError: the bag's folder exists.
    """

    def __init__(
        self,
        parts: CellParts,
        *,
        bag: Path | None = None,
        longest: float,
        on_progress: Callable[[float, int], None] | None = None,
    ) -> None:
        self._parts, self._longest, self._on_progress = parts, longest, on_progress
        robot, period = parts.robot, parts.period
        axes = robot.axes_data
        self._period_ns = round(period * NANOSECONDS)
        self._drives = parts.drives
        self._supervised = SupervisedDrives(parts.drives, axes, period=period)
        self.clock = SimulatedClock()
        torque = parts.drives.torque is not None
        self._recording = Recording(axes.num_axes, torque=torque)
        self._bag = (
            None if bag is None else SimulatedBag(bag, robot, period=period, recording=self._recording)
        )
        self.cost = Cost()
        self._motions = self._recording.motions
        self._log = CellLog(
            self._recording, self._bag, self.clock, self.cost, robot=parts.robot_name, joints=axes.names
        )
        self._mail: Mail = Mail()
        controller = self._controller = parts.controller
        self._rates = ControllerRates(1.0 / period, controller.settings.feedback_timeout)
        self._control = ControlLoop(controller, self._rates, self, progress_every=1)
        self._authority = controller.speed.authority
        link = InProcessPlanner(
            parts.planning,
            payload=parts.payload,
            mail=self._mail,
            clock=self.clock,
            control=self._control,
            log=self._log,
            cost=self.cost,
        )
        self._planner = link.planner
        self._host = ProgramHost(
            robot,
            clock=self.clock,
            robot_port=self,
            planner=link,
            controller=self,
            observer=self._log,
            io_labels=parts.io_labels,
            fail_safe=parts.fail_safe,
            payload=parts.payload,
            simulated=True,
        )
        link.on_result = self._motion_ended
        link.on_planned = self._motion_planned
        link.on_settings = self._settings_changed
        self._carried = CarriedPayload(parts.drives.load, parts.payload)
        self._program = self._host.program
        self._plc = SimulatedPlc(parts, self._program.io, self._control, self._log, self.clock.now())
        self._guide = SimulatedGuide(
            parts.references,
            robot,
            self._control,
            self._planner,
            method=parts.guided,
            on_message=self._log.guided,
            on_point=self._log.streamed,
        )
        self._guard = None
        if parts.scene and parts.planning.collision is not None:
            self._guard = CollisionGuard(parts.planning.collision, self._stop_before_collision)
        self._look_every = cycles(1.0 / period, LOOK_RATE)
        self._watch_every = cycles(1.0 / period, 1.0 / WATCH_PERIOD)
        self._cycle = -1
        self._progress = 1.0
        self._settled = False
        self._changed = False
        self._deadlocks = DeadlockDetection(longest, self._recording)
        self._interrupted = self._over = self._running = False

    def stop(self) -> None:
        """End the simulation after the period under way; from any thread, and from a signal handler."""
        self._interrupted = True
        self._program.stop()

    def run(self) -> SimulationRun:
        """Run the program from its start to its end, and the robot to standstill.

        Returns:
            What was recorded, also of a program that fails.

        Raises:
            RobotsError: the program cannot be opened or is not Lua, or the bag cannot be written.
        """
        try:
            self._begin()
            self._go()
        finally:
            self._close()
        if self._bag is not None and self._bag.problem is not None:
            raise self._bag.problem
        return self._result()

    # -- the run ----------------------------------------------------------------------------------

    def _begin(self) -> None:
        self._plc.begin()
        self._log.begin(self._program.io, self._parts.io_labels, self._plc.images, self._authority.mode)
        self._host.open(self._parts.program, self._parts.points_file or '')
        self._host.permission.mode_changed(self._authority.mode)
        self._plc.watch_inputs()
        self._tick()  # the program finds a robot that stands, and its position
        self._running = True
        self.cost.begin()
        self.cost.switch('program')
        try:
            self._host.run()
        except RobotsError as error:  # a fault stops the robot from the start, or no program runs in the mode
            self._log.given_up = ProgramError(str(error), file=self._program.file)
            self._running = False
        self.cost.switch('other')

    def _go(self) -> None:
        clock = self.clock
        while True:
            self._deliver()
            if self._bag is not None and self._bag.problem is not None:
                raise self._bag.problem
            if self._running and not clock.waiting:
                self._end_program()
            at_rest = not self._running and not self._motions.any_open and self._stands()
            if self._interrupted or self._over or at_rest:
                return
            if not self._changed:
                self._pass_time()
            if self._changed or clock.deadline <= clock.now():
                self._changed = False
                if clock.waiting:
                    self.cost.switch('program')
                    clock.let_program_work()
                    self.cost.switch('other')

    def _deliver(self) -> None:
        while self._mail:
            self._mail.popleft()()

    def _stands(self) -> bool:
        if self._controller.state is ControllerState.STOPPED:
            return self._controller.stops.state.drives_on or self._supervised.braked
        return self._controller.state is ControllerState.HOLDING

    def _end_program(self) -> None:
        self._running = False
        self._program.join()

    def _pass_time(self) -> None:
        """Go on to the next thing that happens: the end of the program's wait, or a period."""
        clock = self.clock
        wait = clock.deadline_stamp if clock.waiting else math.inf
        next_tick = START + (self._cycle + 1) * self._period_ns
        if wait < next_tick:
            clock.nanoseconds = max(clock.nanoseconds, int(wait) - START)
            return
        # A line is reported some periods after it was reached, not after its wait.
        nothing_to_do = not (self._host.reporter.due or self._control.pending)
        if self._settled and nothing_to_do and self._skip(min(wait / NANOSECONDS, self._next_event())):
            return
        clock.nanoseconds = next_tick - START
        self._tick()
        self._deliver()
        self._guard_against_deadlocks(wait)

    def _skip(self, until: float) -> bool:
        """Let periods pass at once in which nothing moves; False if there are too few."""
        if until == math.inf:
            return False
        until = min(until - START / NANOSECONDS, self._longest)
        last = math.floor(until / self._parts.period) - 1
        # Time without feedback ends with a period that has it: it must not seem to be lost.
        last -= last % self._rates.holding_every + 1
        count = last - self._cycle
        if count < self._rates.holding_every:
            return False
        self._recording.repeat(count, self._period_ns)
        self._control.pass_over(count)
        self._cycle = last
        self.clock.nanoseconds = last * self._period_ns
        if self._bag is not None:
            self._bag.write_samples_in_time()
        return True

    def _next_event(self) -> float:
        """When the PLC or what guides the robot acts by itself, s."""
        return min(self._plc.next_time, self._guide.next_time)

    def _guard_against_deadlocks(self, wait: float) -> None:
        if self._changed:  # the program may go on
            return
        now = self.clock.elapsed
        reason = self._deadlocks.reason(
            now,
            expected=min(math.inf if self.clock.busy else wait, self._next_event()) < math.inf,
            at_rest=self._stands() and not self._motions.any_open,
            waiting=self.clock.waiting,
            busy=self.clock.busy,
        )
        if reason:
            obstacle = self._controller.obstacle
            self._give_up(f'{reason}: it is held before {obstacle}' if obstacle else reason)
        self._over = now >= self._longest

    def _give_up(self, reason: str) -> None:
        if self._log.given_up is None:
            program = self._program
            self._log.given_up = ProgramError(reason, file=program.file, line=program.line)
            program.stop()
            self._control.stop(reason)
            self._control.request('resume')
            self._control.set_override(1.0)
            self.clock.end()

    def _tick(self) -> None:
        """One period of the controller."""
        self._cycle += 1
        now, cycle, cost = self.clock.now(), self._cycle, self.cost
        cost.switch('controller')
        if self._parts.references is not None:
            self._guide.step(self.clock.stamp)
        position = self._drives.position
        reference = self._control.step(now, position if self._control.feedback_due else None)
        assert reference is not None
        self._control.report()
        cost.switch('drives')
        q, q_dot = self._supervised.step(now, reference[0], reference[1])
        cost.switch('other')
        self._settled = self._stands() and not q_dot.any() and np.array_equal(q, position)
        cost.switch('recording')
        self._recording.add(self.clock.nanoseconds, reference, q, q_dot, self._drives.torque)
        if self._bag is not None:
            self._bag.write_samples_in_time()
        if self._guard is not None and cycle % self._look_every == 0:
            self._log.collision_status(self._guard.look(q, q_dot))
        cost.switch('other')
        self._deliver()
        self._changed |= self._plc.step(now)
        if cycle % self._watch_every == 0 and self._motions.any_open:
            self._host.motions.watch()
        if self._host.reporter.due:
            self._host.reporter.report_in_time()
        if self._on_progress is not None and cycle % self._rates.progress_every == 0:
            self._on_progress(self.clock.elapsed, self._program.line)

    def _stop_before_collision(self, reason: str) -> bool:  # noqa: ARG002  # as ~/stop, which takes none
        self._control.request('stop')
        return True

    def _note_start(self) -> None:
        if self._planner.motions:
            self._motions.started(self._planner.motions[0].id, self.clock.elapsed)

    def _settings_changed(self, settings: MotionSettings) -> None:
        self._carried.carry(settings.payload)
        self._controller.speed.set_tool(settings.tool_pose.r)

    def _motion_planned(self, id_: str, ends: Mapping[str, float], trajectory: Trajectory) -> None:
        self._host.switching.planned(id_, ends, lambda: trajectory)
        if self._guard is not None:
            path = JointPath(
                trajectory.time, trajectory.position, trajectory.velocity, trajectory.acceleration
            )
            self._guard.planned(id_, path)

    def _motion_ended(self, result: MotionResult) -> None:
        if self._guard is not None:
            self._guard.ended(result.id)
        self._motions.ended(result, self.clock.elapsed)
        self._host.motions.result(result)
        self._changed = True

    def _close(self) -> None:
        self._program.stop()
        self.clock.end()
        if self._running:
            self._end_program()
        if self._bag is not None:
            self.cost.switch('recording')
            self._bag.close()
        self.cost.end()

    def _result(self) -> SimulationRun:
        error = self._log.given_up or self._program.error
        parts, recording = self._parts, self._recording
        position, velocity, torque = recording.states
        return SimulationRun(
            program=parts.program,
            robot=parts.robot_name,
            drive=parts.drive,
            scene=parts.scene,
            io=parts.io,
            period=parts.period,
            axes=parts.robot.axes_data.names,
            time=recording.time,
            reference=recording.references,
            position=position,
            velocity=velocity,
            torque=torque,
            motions=self._motions.all,
            events=tuple(recording.events),
            state='FAILED' if error is not None else self._program.run_state.value,
            error=error,
            interrupted=self._interrupted and error is None,
            bag=None if self._bag is None else self._bag.path,
            cost=self.cost.seconds,
            processor_time=self.cost.processor,
        )

    # -- ports of the control loop ----------------------------------------------------------------

    def result(self, result: MotionResult) -> None:
        """See `ControlPort`."""
        details = {**result.details, 'ended': f'{self.clock.now():.9f}'}
        result = MotionResult(result.id, result.ok, result.message, details)
        self._log.result(result)
        self._mail.append(lambda: self._control_ended(result))

    def _control_ended(self, result: MotionResult) -> None:
        self._planner.result(result, self.clock.now())
        self._motion_ended(result)

    def progress(self, progress: float) -> None:
        """See `ControlPort`."""
        if progress < self._progress:  # of another motion than before
            self._mail.append(self._note_start)
        self._progress = progress
        if progress in (0.0, 1.0) or self._cycle % self._rates.progress_every == 0:
            self._log.progress(progress)
        now = self.clock.now()
        self._mail.append(lambda: self._host.switching.progress(now, progress))
        if self._guard is not None:
            self._guard.progress(progress)

    def stream_refused(self, error: RobotsError, now: float) -> None:
        """See `ControlPort`; a stopped sender goes on sending, as in a live cell."""

    def stop_changed(self, state: StopState) -> None:
        """See `ControlPort`."""
        self._log.stop(state)
        self._supervised.power(on=state.drives_on)
        if state.fault is not None:
            self._mail.append(lambda: self._stopped(state.reason))

    def run_enabled(self, *, enabled: bool) -> None:
        """See `ControlPort`; in a simulation nobody needs to hold run."""
        self._log.value('run_enabled', enabled)

    def _stopped(self, reason: str) -> None:
        self._host.stop_changed(reason)
        self._changed = True

    # -- ports of the program ---------------------------------------------------------------------

    def joint_feedback(self) -> JointFeedback:
        """See `RobotPort`."""
        drives = self._drives
        return JointFeedback(read_only(drives.position), read_only(drives.velocity), drives.torque)

    def guide(self, guide: Guide) -> None:
        """See `RobotPort`."""
        self._guide.hand_over(guide, self.clock.stamp)
        self._log.value('guide', guide.value)

    def request(self, request: ControllerRequest) -> None:
        """See `ControllerPort`."""
        self._control.request(request)

    def command(self, *, taken: bool) -> None:
        """See `ControllerPort`; nobody else is there."""
        if taken:
            self._authority.take(Commander.PROGRAM, standing=self._control.at_rest)
        else:
            self._authority.give_back(Commander.PROGRAM)
        self._log.value('commander', self._authority.commander.value)

    def wait_for_command(self) -> None:
        """See `ControllerPort`; it has answered."""

    def set_override(self, value: float) -> None:
        """See `ControllerPort`."""
        self._control.set_override(value)
        self._log.override(value)
