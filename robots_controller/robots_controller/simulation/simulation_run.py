"""SimulationRun: everything that was recorded of a simulated program."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from robots_controller.program.motions.motion_command import MotionCommand
from robots_controller.simulation.record.events import Event, ProgramStateChanged, TextPrinted
from robots_core.errors import ProgramError
from robots_core.validation import Array
from robots_planning.motion_settings import MotionSettings
from robots_planning.pathplanning import PlannedMotion


@dataclass(frozen=True, eq=False)
class SimulatedMotion:
    """One motion command of the program and what became of it.

    Attributes:
        id: As on the topics.
        command: Target, line and function.
        file: The program or subprogram that commanded it.
        commanded: When the program asked for it, s.
        settings: The modal settings that it was planned with.
        started: When the controller began with it, or with the chain of blended motions it is part of, s; NaN
            if it did not.
        ended: When its result was known, s; NaN if the simulation ended before.
        ok: The robot stood at the target, or passed it where motions blend.
        message: 'reached', 'passed', or why not.
        plan: Its verified plan, the same for all commands of a chain; None if there is none.
        chain: Ids of the commands in the plan, in their order; () without a plan.
        start_on_plan: Where this command begins on the plan, s.
        end_on_plan: Where it ends, s.
    """

    id: str
    command: MotionCommand
    file: str
    commanded: float
    settings: MotionSettings = field(default_factory=MotionSettings)
    started: float = math.nan
    ended: float = math.nan
    ok: bool = False
    message: str = ''
    plan: PlannedMotion | None = None
    chain: tuple[str, ...] = ()
    start_on_plan: float = math.nan
    end_on_plan: float = math.nan


@dataclass(frozen=True, eq=False)
class SimulationRun:
    """A simulated run of a robot program. All times in s from the start of the program; arrays are read-only.

    Attributes:
        program: The program's path.
        robot: The robot's name.
        drive: Level of the drives.
        scene: Path of the scene that motions were checked against, '' for none.
        io: Path of the script of the PLC that was played, '' for none.
        period: Of the controller, s.
        axes: Names of the n axes.
        time: (k,) every period.
        reference: (k, 3, n) of the controller: position, velocity, acceleration; rad (m), s.
        position: (k, n) of the drives, rad (m).
        velocity: (k, n), rad/s (m/s).
        torque: (k, n) of the motors at the joints, N m (N); None for drives that report none.
        motions: In the order of their commands.
        events: In the order of time.
        state: How the program ended: FINISHED, FAILED or STOPPED.
        error: Why it failed, as a live cell would say it.
        interrupted: It was stopped from outside, so that all this is only a part.
        bag: The recorded bag, if one was wanted.
        cost: What it took to simulate, s of the wall's time by part. This and the next are the only things
            that are not the same in every run.
        processor_time: What it took of one core, s.
    """

    program: Path
    robot: str
    drive: str
    scene: str
    io: str
    period: float
    axes: tuple[str, ...]
    time: Array
    reference: Array
    position: Array
    velocity: Array
    torque: Array | None
    motions: tuple[SimulatedMotion, ...]
    events: tuple[Event, ...]
    state: str
    error: ProgramError | None = None
    interrupted: bool = False
    bag: Path | None = None
    cost: Mapping[str, float] = field(default_factory=dict, repr=False)
    processor_time: float = field(default=0.0, repr=False)

    @property
    def ok(self) -> bool:
        """The program came to its end."""
        return self.state == 'FINISHED'

    @property
    def duration(self) -> float:
        """Cycle time of the program, s."""
        ends = [event.time for event in self.events if isinstance(event, ProgramStateChanged)]
        return max(ends, default=0.0)

    @property
    def printed(self) -> tuple[str, ...]:
        """What the program printed."""
        return tuple(event.text for event in self.events if isinstance(event, TextPrinted))

    @property
    def real_time_factor(self) -> float:
        """Simulated time per time that it took."""
        return self.duration / max(sum(self.cost.values()), 1e-9)
