"""SimulatedCell: robot program, planner, controller, drives and PLC on one simulated clock."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Final

import numpy as np

from robots_controller.control.controller import Controller, ControllerState
from robots_controller.control.controller_rates import ControllerRates, cycles
from robots_controller.interpreter.lua_program import LuaProgram
from robots_controller.program.program_state import MotionCommand, OutputChange, RunState
from robots_controller.simulation.cell_log import CellLog
from robots_controller.simulation.cell_parts import CellParts
from robots_controller.simulation.collision_watch import WATCH_RATE, CollisionWatch
from robots_controller.simulation.cost import Cost
from robots_controller.simulation.deadlock_detection import DeadlockDetection
from robots_controller.simulation.recording import Recording
from robots_controller.simulation.simulated_bag import SimulatedBag
from robots_controller.simulation.simulated_clock import NANOSECONDS, SimulatedClock
from robots_controller.simulation.simulated_guide import SimulatedGuide
from robots_controller.simulation.simulated_motions import MotionEnd, SimulatedMotions
from robots_controller.simulation.simulated_plc import SimulatedPlc
from robots_controller.simulation.simulated_switches import SimulatedSwitches
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core.errors import ProgramError
from robots_core.motion_result import MotionResult
from robots_core.pose import Pose
from robots_core.validation import Array, read_only
from robots_planning.command_planner import PlannedCommands
from robots_planning.robot_command_state import RobotCommandState

STOPPED: Final = 'stopped by ~/stop'


class SimulatedCell:
    """A cell for one run of one program.

    Between two periods of the controller the program works, the planner plans and time stands still; in each
    period the controller makes one step, then the drives, then the PLC. The program's own waits end in
    between, when they are over. See `CellParts` for the parts.

    Args:
        parts: Robot, program and blocks.
        bag: Folder of a bag to write, or None.
        longest: Longest simulated time, s.
        on_progress: Told now and then: time in s, line of the program. For a progress bar.

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
        self._controller: Controller = parts.controller
        self._drives = parts.drives
        self._clock = SimulatedClock(period)
        torque = parts.drives.torque is not None
        self._recording = Recording(axes.num_axes, torque=torque)
        self._bag = (
            None if bag is None else SimulatedBag(bag, robot, period=period, recording=self._recording)
        )
        self.cost = Cost()
        self._log = CellLog(
            self._recording, self._bag, self._clock, self.cost, robot=parts.robot_name, joints=axes.names
        )
        self._commands: deque[Callable[[], None]] = deque()
        self._program = LuaProgram(
            axes.num_axes,
            io_labels=parts.io_labels,
            orientation_convention=robot.orientation_convention,
            prismatic=axes.prismatic,
            clock=self._clock,
            joint_position=lambda: read_only(self._drives.position),
            direct_kinematics=lambda q: Pose(*robot.direct_kinematics(q)),
            on_command=self._on_command,
            on_flush=lambda: self._commands.append(self._motions_flush),
            on_abort=lambda: self._commands.append(self._motions_abort),
            on_guided=self._on_guided,
            on_hold=self._on_hold,
            on_override=self._on_override,
            on_output=self._on_output,
            on_print=self._log.printed,
            on_line=lambda line: self._log.line(self._program, line),
            on_finished=lambda _: self._clock.program_ended(),
        )
        self._motions = SimulatedMotions(
            parts.planning,
            parts.controller,
            axes,
            now=self._clock.now,
            on_planned=self._on_planned,
            on_end=self._on_end,
        )
        self._plc = SimulatedPlc(parts.plc_script, self._program.io)
        self._switches = SimulatedSwitches(
            lambda q: Pose(*robot.direct_kinematics(q)), self._program.switch_output
        )
        self._guide = SimulatedGuide(
            parts.references,
            robot,
            parts.controller,
            method=parts.guided,
            on_message=self._log.guided,
            on_point=self._log.streamed,
        )
        self._watch = None
        if parts.scene and parts.planning.collision is not None:
            self._watch = CollisionWatch(parts.planning.collision, axes)
        self._watch_every = cycles(1.0 / period, WATCH_RATE)
        self._rates = ControllerRates(1.0 / period, self._controller.settings.feedback_timeout)
        self._cycle = -1
        self._settled = False
        self._changed = False
        self._endlessness = DeadlockDetection(longest, self._recording)
        self._interrupted = self._over = self._running = False
        self._error: ProgramError | None = None

    def stop(self) -> None:
        """End the simulation after the period under way; from any thread, and from a signal handler."""
        self._interrupted = True
        self._program.stop()

    def run(self) -> SimulationRun:
        """Run the program from its start to its end, and the robot to standstill.

        Returns:
            What was recorded, also of a program that fails.

        Raises:
            RobotsError: the program cannot be opened or is not Lua.
        """
        try:
            self._program.open(self._parts.program)
            self._program.points_file = self._parts.points_file
            self._begin()
            self._go()
        finally:
            self._close()
        return self._result()

    # -- the run ----------------------------------------------------------------------------------

    def _begin(self) -> None:
        log = self._log
        self._plc.begin()
        log.begin(self._program, self._parts.io_labels, self._plc.images)
        log.state(self._program, RunState.OPENED)
        self._tick()  # the program finds a robot that stands and tells where
        log.state(self._program, RunState.RUNNING)
        self._running = True
        self._program.run()
        self.cost.begin()
        self.cost.switch('program')
        self._clock.wait_for_program()
        self.cost.switch('other')

    def _go(self) -> None:
        while True:
            while self._commands:
                self._commands.popleft()()
            if self._running and not self._clock.waiting:
                self._end_program()
            at_rest = not self._running and not self._motions.any and self._stands()
            if self._interrupted or self._over or at_rest:
                return
            if not self._changed:
                self._pass_time()
            if self._changed or self._clock.deadline <= self._clock.now():
                self._changed = False
                if self._clock.waiting:
                    self.cost.switch('program')
                    self._clock.let_program_work()
                    self.cost.switch('other')

    def _stands(self) -> bool:
        return self._controller.state is ControllerState.HOLDING

    def _end_program(self) -> None:
        self._running = False
        self._program.join()
        self._error = self._error or self._program.error
        state = RunState.FAILED if self._error else self._program.run_state
        self._log.state(self._program, state, str(self._error or ''))

    def _pass_time(self) -> None:
        """Go on to the next thing that happens: the end of the program's wait, or a period."""
        clock = self._clock
        wait = clock.deadline if clock.waiting else math.inf
        next_tick = (self._cycle + 1) * self._period_ns
        if wait * NANOSECONDS <= next_tick:
            clock.nanoseconds = max(clock.nanoseconds, math.ceil(wait * NANOSECONDS - 1e-3))
            while clock.now() < wait:  # a nanosecond is finer than the rounding of late times
                clock.nanoseconds += 1
            if clock.nanoseconds < next_tick:
                return
        # A line is told some periods after it was reached, not after its wait.
        told = not self._log.status_due
        if self._settled and told and self._skip(min(wait, self._next_event())):
            return
        clock.nanoseconds = next_tick
        self._tick()
        self._guard_against_endlessness(wait)

    def _skip(self, until: float) -> bool:
        """Let periods pass at once in which nothing moves; False if there are too few."""
        if until == math.inf:
            return False
        until = min(until, self._longest)
        last = math.floor(until / self._parts.period) - 1
        # Time without feedback ends with a period that has it: it must not seem to be lost.
        last -= last % self._rates.holding_every + 1
        count = last - self._cycle
        if count < self._rates.holding_every:
            return False
        self._recording.repeat(count, self._period_ns)
        self._cycle = last
        self._clock.nanoseconds = last * self._period_ns
        if self._bag is not None:
            self._bag.write_samples_in_time()
        return True

    def _next_event(self) -> float:
        """When the PLC or who guides the robot does something by itself, s."""
        return min(self._plc.next_time, self._guide.next_time)

    def _guard_against_endlessness(self, wait: float) -> None:
        if self._changed:  # the program will know what to do
            return
        now = self._clock.now()
        reason = self._endlessness.reason(
            now,
            expected=min(wait, self._next_event()) < math.inf,
            at_rest=self._stands() and not self._motions.any,
            waiting=self._clock.waiting,
        )
        if reason:
            self._give_up(reason)
        self._over = now >= self._longest

    def _give_up(self, reason: str) -> None:
        if self._error is None:
            program = self._program
            self._error = ProgramError(reason, file=program.file, line=program.line)
            program.stop()
            self._controller.stop(reason)
            self._controller.paused = False
            self._controller.set_override(1.0)
            self._clock.end()

    def _tick(self) -> None:
        """One period of the controller."""
        self._cycle += 1
        now, cycle = self._clock.now(), self._cycle
        cost, controller = self.cost, self._controller
        position = self._drives.position
        self._motions.begin(now)
        cost.switch('controller')
        self._guide.step(self._clock.nanoseconds)
        due = self._rates.feedback_due(cycle, controller)
        reference = controller.step(now, position if due else None)
        assert reference is not None
        cost.switch('drives')
        q, q_dot = self._drives.step(reference[0], reference[1])
        cost.switch('other')
        self._settled = (
            controller.state is ControllerState.HOLDING and not q_dot.any() and np.array_equal(q, position)
        )
        cost.switch('recording')
        self._recording.add(self._clock.nanoseconds, reference, q, q_dot, self._drives.torque)
        if self._bag is not None:
            self._log.progress(controller.progress, due=cycle % self._rates.progress_every == 0)
            self._bag.write_samples_in_time()
        if self._watch is not None and cycle % self._watch_every == 0:
            self._look_around(self._watch, q, q_dot)
        cost.switch('other')
        while controller.outcomes:
            self._end_motion(controller.outcomes.popleft())
        self._switches.reach(self._motions.running, controller.progress)
        for channel, value in self._plc.step(now):
            self._log.input(self._program.io, channel, value, self._plc.images[channel.image])
            self._changed = True
        self._log.status_in_time(self._program)
        if self._on_progress is not None and cycle % self._rates.progress_every == 0:
            self._on_progress(now, self._program.line)

    def _look_around(self, watch: CollisionWatch, q: Array, q_dot: Array) -> None:
        if self._bag is not None:
            self._log.clearness(watch.look(q))
        if self._controller.state is ControllerState.STREAMING and watch.ahead(q, q_dot):
            self._controller.stop(STOPPED)

    def _end_motion(self, outcome: MotionResult) -> None:
        if not self._motions.end(outcome):
            self._log.result(outcome)

    def _close(self) -> None:
        self._program.stop()
        self._clock.end()
        if self._running:
            self._end_program()
        if self._bag is not None:
            self.cost.switch('recording')
            self._bag.close()
        self.cost.end()

    def _result(self) -> SimulationRun:
        parts, recording = self._parts, self._recording
        position, velocity, torque = recording.states
        failed = self._error is not None
        return SimulationRun(
            program=Path(parts.program),
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
            motions=self._motions.records,
            events=tuple(recording.events),
            state='FAILED' if failed else self._program.run_state.value,
            error=self._error,
            interrupted=self._interrupted and not failed,
            bag=None if self._bag is None else self._bag.path,
            cost=self.cost.seconds,
            processor_time=self.cost.processor,
        )

    # -- the program's callbacks ------------------------------------------------------------------

    def _on_command(self, command: MotionCommand) -> None:
        id_ = self._log.commanded(self._program, command)
        self._commands.append(partial(self._plan, id_, command))

    def _plan(self, id_: str, command: MotionCommand) -> None:
        self.cost.switch('planning')
        self._motions.command(id_, command)
        self.cost.switch('other')

    def _motions_flush(self) -> None:
        self.cost.switch('planning')
        self._motions.flush()
        self.cost.switch('other')

    def _motions_abort(self) -> None:
        self._motions.abort(STOPPED)

    def _on_guided(self, state: RobotCommandState) -> None:
        self._guide.hand_over(state, self._clock.nanoseconds, self._motions.tool)
        self._log.command_state(state.value)

    def _on_hold(self, held: bool) -> None:  # noqa: FBT001  # a callback's only argument
        self._controller.paused = held

    def _on_override(self, value: float) -> None:
        self._controller.set_override(value)
        self._log.override(value)

    def _on_output(self, change: OutputChange) -> None:
        self._log.status(self._program, self._clock.nanoseconds)
        self._log.output(self._program.io, change)
        self._plc.hear(change)

    # -- the motions' callbacks -------------------------------------------------------------------

    def _on_planned(self, planned: PlannedCommands) -> None:
        self._log.planned(planned)
        ids = [order.id for order in planned.orders]
        chain = [self._motions.commands[id_] for id_ in ids]
        self._switches.planned(chain, ids[-1], planned.motion.trajectory)

    def _on_end(self, end: MotionEnd) -> None:
        self._log.result(end)
        if end.ok and not self._motions.running:
            self._log.finished(done=True)
        self._switches.finish(end.id, ok=end.ok)
        if not end.ok or end.command in self._program.motions[-1:]:
            self._log.command_state('IDLE')
        self._program.finish_motion(end.error, end.command)
        self._changed = True
