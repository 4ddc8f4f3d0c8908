"""PendantState: what is known of the cell where it is operated or watched."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

from robots_controller.control.stops.faults import Fault
from robots_controller.io.io_image import Channel
from robots_controller.program.run_state import RunState
from robots_core.blocks.following.guide import Guide
from robots_core.blocks.multibody.payload import NOTHING, Payload
from robots_core.cell_interface.operating_modes import MODES, Commander, OperatingMode
from robots_core.pose import Pose
from robots_core.validation import Array
from robots_planning.motion_settings import MotionSettings

WATCHED: Final = ('controller_node', 'planning_node', 'lua_program_node')
"""Nodes without which a robot cannot be operated."""
STARTABLE: Final = frozenset({RunState.OPENED, RunState.STOPPED, RunState.FINISHED, RunState.FAILED})
"""States from which a program runs from its start."""
EMERGENCY_STOPS: Final = (Fault.EMERGENCY_STOP.label, Fault.EMERGENCY_STOP_INPUT.label)


@dataclass(frozen=True)
class ShownProgram:
    """The robot program.

    Attributes:
        path: Of the file that is open, or, in the state IDLE, of one that could not be opened; '' for none.
        state: What it does.
        file: Name of the file that `line` belongs to.
        line: Line of the last call of a robot function, counted from 1; 0 for none.
        motion_file: Name of the file that `motion_line` belongs to.
        motion_line: Line of the motion that was sent last; 0 for none.
        error: Why it has failed; '' if it has not.
        hold: Why it is held; '' if it is not.
        points_file: Where its taught points stand; '' without a program.
        frames_file: Where its tools and bases stand; '' without a program.
        written: When the text that was opened was written, ns since 1970; 0 where that is not known.
    """

    path: str = ''
    state: RunState = RunState.IDLE
    file: str = ''
    line: int = 0
    motion_file: str = ''
    motion_line: int = 0
    error: str = ''
    hold: str = ''
    points_file: str = ''
    frames_file: str = ''
    written: int = 0

    @property
    def waits_for_run(self) -> bool:
        """It is held because nobody holds run, and continues when somebody does."""
        return self.state is RunState.PAUSED and self.hold == 'release'

    def place(self, *, of_motion: bool) -> str:
        """Where it or the motion sent last is, such as 'welding.lua:12'; '' while it does not run."""
        if self.state is not RunState.RUNNING:
            return ''
        if of_motion and self.motion_line:
            return f'{self.motion_file}:{self.motion_line}'
        return f'{self.file}:{self.line}' if self.line else ''


@dataclass(frozen=True)
class ShownIo:
    """Inputs and outputs.

    Attributes:
        values: By image, see `IMAGES`; inputs as the program reads them.
        labels: Names of the channels of each image, from the first on; '' for none.
        forced: Names of the forced inputs, such as 'digital_input.3'.
    """

    values: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    labels: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    forced: frozenset[str] = frozenset()

    def found(self, image: str, part: str = '') -> list[Channel]:
        """Channels of one of `IMAGES` whose name contains a part, or whose number it is; '' finds all."""
        labels, wanted = self.labels.get(image, ()), part.strip().casefold()
        channels = [
            Channel.of(image, index, labels[index - 1] if index <= len(labels) else '')
            for index in range(1, len(self.values.get(image, ())) + 1)
        ]
        return [one for one in channels if wanted in one.label.casefold() or wanted in ('', str(one.index))]

    def label(self, name: str) -> str:
        """The name that a channel such as 'digital_input.3' has in the cell; its own where it has none."""
        image, _, number = name.partition('.')
        labels = self.labels.get(f'{image}s', ())
        return (labels[int(number) - 1] if int(number) <= len(labels) else '') or name


@dataclass(frozen=True)
class ShownPlc:
    """A scripted PLC.

    Attributes:
        script: Name of its file; '' where none is played.
        error: Why it has ended; '' while it has not.
        lost: It gives no sign of life.
        pending: What it will do next: when (s, on the clock of the node that shows it), the line of the rule,
            and inputs by name with their new values.
    """

    script: str = ''
    error: str = ''
    lost: bool = False
    pending: tuple[tuple[float, int, Mapping[str, float]], ...] = ()


@dataclass(frozen=True)
class JogSpeeds:
    """Highest speeds of a jogged robot.

    Attributes:
        fraction: Part of the velocity limits of the axes.
        tool: Of the tool centre point, m/s.
    """

    fraction: float = 0.1
    tool: float = 0.25


@dataclass(frozen=True, eq=False)
class PendantState:
    """The newest that is known of the cell.

    Attributes:
        lost: Those of `WATCHED` that give no sign of life.
        mode: The operating mode; None before the controller has reported it.
        commander: Who commands the robot.
        guide: What the program lets guide its robot.
        run_enabled: Motions of programs may go on.
        drives_on: The drives follow the references.
        fault: Why the robot is stopped until a reset; '' if it is not.
        override: Speed override, 0..1.
        fault_kind: Label of that `Fault`, such as 'feedback lost'; '' for none.
        q: Measured joint positions, (n,), rad (m); None before the first.
        q_dot: Measured joint velocities, (n,), rad/s (m/s); None where none are measured.
        torque: Of the axes, (n,), N m (N); None where none are measured.
        payload: What the robot carries.
        tool: Pose of the tool centre point of `settings` in the robot's base; None before the first.
        tool_speed: Of the tool centre point, m/s.
        distance: Smallest distance to a collision, m; NaN where none is watched.
        hindrance: What planning_node reports as wrong; '' for nothing.
        limits: What stops or slows the jog of that, as in `TeachStep`.
        scene_url: Address of the 3D view; '' for none.
        program: The robot program.
        breakpoints: Lines where programs are held, by file.
        io: Inputs and outputs.
        plc: The scripted PLC at them.
        jog_speeds: Highest speeds of a jogged robot.
        settings: Those of the next motion, as planning_node has them.
    """

    lost: tuple[str, ...] = WATCHED
    mode: OperatingMode | None = None
    commander: Commander = Commander.NOBODY
    guide: Guide = Guide.NONE
    run_enabled: bool = False
    drives_on: bool = False
    fault: str = ''
    override: float = 1.0
    fault_kind: str = ''
    q: Array | None = None
    q_dot: Array | None = None
    torque: Array | None = None
    payload: Payload = NOTHING
    tool: Pose | None = None
    tool_speed: float = 0.0
    distance: float = math.nan
    hindrance: str = ''
    limits: tuple[str, ...] = ()
    scene_url: str = ''
    program: ShownProgram = field(default_factory=ShownProgram)
    breakpoints: Mapping[str, set[int]] = field(default_factory=dict)
    io: ShownIo = field(default_factory=ShownIo)
    plc: ShownPlc = field(default_factory=ShownPlc)
    jog_speeds: JogSpeeds = field(default_factory=JogSpeeds)
    settings: MotionSettings = field(default_factory=MotionSettings)

    @property
    def emergency_stop(self) -> bool:
        """The fault is an emergency stop."""
        return self.fault_kind in EMERGENCY_STOPS

    @property
    def run_is_held(self) -> bool:
        """In its mode, programs run only while a person holds run."""
        return self.mode is not None and MODES[self.mode].held

    @property
    def values(self) -> Mapping[str, Any]:
        """What a message about the state may name."""
        return {
            'lost': ', '.join(self.lost),
            'mode': self.mode or '?',
            'commander': self.commander,
            'fault': self.fault,
            'fault_kind': self.fault_kind,
            'program': self.program.file or self.program.path.rpartition('/')[2],
            'state': self.program.state,
        }
