"""SimulatedCell: a cell in one process with simulated drives and a scripted PLC."""

import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

import numpy as np

from robots_controller.io.scripted_plc import ScriptedPlc
from robots_controller.program.joint_feedback import JointFeedback
from robots_controller.program.turn_clock import NANOSECONDS
from robots_controller.simulation.cell_parts import CellParts
from robots_controller.simulation.in_process_cell import InProcessCell
from robots_controller.simulation.record.recording import Recording
from robots_controller.simulation.record.simulated_bag import SimulatedBag
from robots_controller.simulation.simulated_clock import START
from robots_controller.simulation.simulated_rendezvous import SimulatedRendezvous
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core.blocks.drives.drive_choice import drive_train
from robots_core.blocks.drives.supervised_drives import SupervisedDrives
from robots_core.blocks.multibody.payload import CarriedPayload, payload_of
from robots_core.errors import ProgramError
from robots_core.validation import Array

LONGEST_SPAN: Final = 500  # periods; bounds the memory, and the time until an interruption
LEAST_AHEAD: Final = 2  # periods; a single one is stepped through in less time
# A robot that stands for this long in the middle of a motion, with nothing left that could change that.
STUCK_TIME: Final = 10.0  # s
# A program that computes or calls so long while nothing can change: 4e8 instructions or 1.5e6 calls.
BUSY_TIME: Final = 30.0  # s


class SimulatedCell:
    """Runs a program once, as fast as the machine can, and records what the robot does.

    In each period the drives move after the controller has made its step, then the PLC acts; see
    `InProcessCell`. Periods in which nothing happens are passed over.

    Args:
        parts: Robot, program and blocks.
        drive, bag, longest, patience, on_progress: As of `simulate`.

    Raises:
        RobotsError: the bag's folder exists, or an unknown level.
    """

    def __init__(
        self,
        parts: CellParts,
        *,
        drive: str,
        bag: Path | None = None,
        longest: float,
        patience: float = math.inf,
        on_progress: Callable[[float, int], None] | None = None,
    ) -> None:
        self._patience, self._begun = patience, time.monotonic()
        self._parts, self._drive, self._longest, self._on_progress = parts, drive, longest, on_progress
        robot, period = parts.robot, parts.period
        self._period_ns = round(period * NANOSECONDS)
        payload = payload_of(parts.setup.payload)
        self._drives = drive_train(
            drive, robot, robot.home, period=period, payload=payload, orbit=parts.setup.orbit
        )
        self._supervised = SupervisedDrives(self._drives, robot.axes_data, period=period)
        self._recording = Recording(robot.num_axes, torque=self._drives.torque is not None)
        self._bag = (
            None if bag is None else SimulatedBag(bag, robot, period=period, recording=self._recording)
        )
        carried = CarriedPayload(self._drives.load, parts.setup.payload)
        bodies = self._drives.rendezvous
        self._bodies = None if bodies is None else SimulatedRendezvous(bodies, parts.robot_name)
        self._cell = InProcessCell(
            parts,
            bag=self._bag,
            on_settings=lambda settings: carried.carry(settings.payload),
            camera=self._bodies,
        )
        self._plc = ScriptedPlc(parts.cell_io.offline, self._cell.clock.now())
        self._cell.log.on_output = self._plc.output if self._bodies is None else self._bodies.output
        self._settled = False
        self._stands_since = self._rests_since = 0.0  # s since the start
        self._interrupted = self._over = False

    def stop(self) -> None:
        """End the simulation after the period under way; from any thread, and from a signal handler."""
        self._interrupted = True
        self._cell.program.stop()

    def run(self) -> SimulationRun:
        """Run the program from its start to its end, and the robot to standstill.

        Returns:
            What was recorded, also of a program that fails.

        Raises:
            RobotsError: the program cannot be opened or is not Lua, or the bag cannot be written.
        """
        try:
            self._cell.begin(self._plc.inputs if self._bodies is None else self._bodies.inputs)
            self._measure()
            self._step()
            self._cell.cost.begin()
            self._go()
        finally:
            self._close()
        if self._bag is not None and self._bag.problem is not None:
            raise self._bag.problem
        return self._result()

    # -- the run ----------------------------------------------------------------------------------

    def _go(self) -> None:
        cell = self._cell
        while True:
            cell.work()
            if self._bag is not None and self._bag.problem is not None:
                raise self._bag.problem
            if time.monotonic() - self._begun > self._patience:
                self._give_up(f'it has not ended within the patience of {self._patience:.3g} s')
            if self._interrupted or self._over or (not cell.running and self._at_rest):
                return
            if not self._pass_over():
                self._follow_span()
                self._step()
                self._guard_against_deadlocks()

    @property
    def _stands(self) -> bool:
        cell = self._cell
        return cell.control.holding and (cell.controller.stops.state.drives_on or self._supervised.braked)

    @property
    def _at_rest(self) -> bool:
        return self._stands and not self._cell.log.motions.any_open

    def _pass_over(self) -> bool:
        """Let periods pass at once in which nothing moves; False if there are too few."""
        if not self._settled or min(self._cell.wait, self._next_event) == math.inf:
            return False
        until = min(self._next_event - START / NANOSECONDS, self._longest)
        count = self._cell.pass_over(until)
        if count == 0:
            return False
        self._recording.repeat(count, self._period_ns)
        if self._bag is not None:
            self._bag.write_samples_in_time()
        return True

    def _follow_span(self) -> None:
        """Let periods pass at once in which the controller continues as before, and nothing else happens."""
        cell, drives, recording = self._cell, self._drives, self._recording
        left = int(self._longest * NANOSECONDS) // self._period_ns - 1 - cell.cycle
        periods = min(LONGEST_SPAN, left)
        if self._on_progress is not None:
            every = cell.control.rates.progress_every
            periods = min(periods, every - 1 - cell.cycle % every)
        if self._bag is not None:
            periods = min(periods, self._bag.room)
        if self._bodies is not None or periods < LEAST_AHEAD:
            return
        before = cell.cost.switch('controller')
        span = cell.ahead(self._next_event - START / NANOSECONDS, periods)
        if len(span) >= LEAST_AHEAD:
            span = span.first(self._supervised.ahead(span.references))
            nanoseconds, references, states = recording.room(len(span))
            nanoseconds[:] = self._period_ns * np.arange(cell.cycle + 1, cell.cycle + 1 + len(span))
            references[:] = span.references

            def move(part: slice) -> Array:
                drives.follow(span.references[part], states[part])
                return drives.position

            cell.cost.switch('drives')
            passed = cell.control.follow(span, move)
            if passed:
                recording.count += passed
                self._supervised.pass_over(cell.clock.now(), span.references[:passed])
                self._measure()
        cell.cost.switch(before)

    @property
    def _next_event(self) -> float:
        """When the PLC or what guides the robot acts by itself, s."""
        return min(self._plc.next_time, self._cell.guide_player.next_time)

    def _guard_against_deadlocks(self) -> None:
        cell = self._cell
        if cell.changed:  # the program may continue
            return
        now = cell.clock.elapsed
        reason = self._deadlock(now)
        if reason:
            obstacle = cell.controller.obstacle
            self._give_up(f'{reason}: it is held before {obstacle}' if obstacle else reason)
        self._over = now >= self._longest

    def _deadlock(self, now: float) -> str:
        """Why the program does not end, '' as long as it may; now in s since its start."""
        if now >= self._longest:
            return f'it has not ended after {self._longest:g} s'
        clock, at_rest = self._cell.clock, self._at_rest
        wait = math.inf if clock.busy else self._cell.wait
        expected = self._bodies is not None or min(wait, self._next_event) < math.inf
        if not at_rest or expected:
            self._rests_since = now
        elif clock.busy:
            forever = now - self._rests_since > BUSY_TIME
            return 'it computes for ever: nothing is left that could change' if forever else ''
        else:
            return 'it waits for ever: nothing is left that could change' if clock.waiting else ''
        if expected or not self._recording.standing(2):
            self._stands_since = now
        elif now - self._stands_since > STUCK_TIME:
            return 'the robot stands in the middle of a motion, and nothing lets it go on'
        return ''

    def _give_up(self, reason: str) -> None:
        cell = self._cell
        if cell.log.given_up is None:
            program = cell.program
            cell.log.given_up = ProgramError(reason, file=program.file, line=program.line)
            program.stop()
            cell.control.loop.cancel(reason)
            cell.control.request('resume')
            cell.control.loop.set_override(1.0)
            cell.clock.end()

    def _step(self) -> None:
        """One period."""
        cell, cost, drives = self._cell, self._cell.cost, self._drives
        position, reference = drives.position, cell.step()
        assert reference is not None
        cost.switch('drives')
        self._supervised.power(on=cell.controller.stops.state.drives_on)
        q, q_dot = self._supervised.step(cell.clock.now(), reference[0], reference[1])
        cost.switch('recording')
        self._settled = (
            self._bodies is None and self._stands and not q_dot.any() and np.array_equal(q, position)
        )
        self._recording.add(cell.clock.nanoseconds, reference, q, q_dot, drives.torque)
        if self._bag is not None:
            self._bag.write_samples_in_time()
        cost.switch('other')
        if self._bodies is not None:
            self._bodies.after_step(self._cell)
        self._measure()
        now = cell.clock.now()
        changes = self._plc.step(now) if self._plc.next_time <= now else []
        inputs = [(change.channel, change.value) for change in changes]
        cell.take_inputs(inputs if self._bodies is None else [*inputs, *self._bodies.changes()])
        if self._on_progress is not None and cell.cycle % cell.control.rates.progress_every == 0:
            self._on_progress(cell.clock.elapsed, cell.program.line)

    def _measure(self) -> None:
        drives = self._drives
        self._cell.measure(JointFeedback(drives.position, drives.velocity, drives.torque))
        if self._cell.contact is not None:
            drives.push(self._cell.contact.joint_torques)

    def _close(self) -> None:
        self._cell.close()
        if self._bag is not None:
            self._cell.cost.switch('recording')
            self._bag.close()
        self._cell.cost.end()

    def _result(self) -> SimulationRun:
        cell, parts, recording = self._cell, self._parts, self._recording
        position, velocity, torque = recording.states
        return SimulationRun(
            program=Path(parts.setup.program),
            robot=parts.robot_name,
            drive=self._drive,
            scene=str(parts.setup.scene),
            io=str(parts.setup.io),
            period=parts.period,
            axes=parts.robot.axes_data.names,
            time=recording.time,
            reference=recording.references,
            position=position,
            velocity=velocity,
            torque=torque,
            motions=cell.log.motions.all,
            events=tuple(cell.log.events),
            state=cell.run_state.value,
            error=cell.error,
            interrupted=self._interrupted and cell.error is None,
            bag=None if self._bag is None else self._bag.path,
            cost=cell.cost.seconds,
            processor_time=cell.cost.processor,
        )
