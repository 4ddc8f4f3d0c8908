"""MotionReport: what a recorded program run did, motion by motion."""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from robots_controller.recording.bag_file import Bag, read_bag
from robots_controller.recording.bag_reading import late_references, read_messages, reference_trajectory
from robots_controller.recording.joint_rows import joint_rows
from robots_controller.recording.motion_record import (
    MOTION_TOPICS,
    CommandRecord,
    MotionRecord,
    recorded_motions,
    status_values,
)
from robots_controller.recording.reference_use import QUANTITIES, ReferenceUse
from robots_controller.report.tool_path import ToolPath
from robots_core.errors import RobotsError
from robots_core.pose import Pose
from robots_core.robot_choice import load_robot_model
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.limit_use import LimitUse

POSITION_TOLERANCE = 1e-4  # m
ORIENTATION_TOLERANCE = math.radians(0.01)  # rad
LINE_TOLERANCE = 1e-4  # m
# A blend is planned to its zone, and passes between two references that are compared with it.
ZONE_TOLERANCE = 1e-3  # of the zone
# The controller's guard lets rounding pass. Torques it does not know, and its moving average is one of the
# motion: this is what that makes of torques at their limit.
RATIO_TOLERANCE = {'position': 1e-5, 'velocity': 1e-5, 'acceleration': 1e-5, 'torque': 1e-3}
TOPICS = (*MOTION_TOPICS, 'joint_reference', 'joint_states')
"""What is read."""


@dataclass(frozen=True)
class Passing:
    """How a motion ran through to the next one.

    Attributes:
        distance: How near the references came to the target, m or rad.
        zone: How near they had to come, in the same unit.
        joints: The unit is rad (m) of the axis that is farthest away, and not m of the tool.
    """

    distance: float
    zone: float
    joints: bool

    def describe(self) -> str:
        """'12.3 of 30 mm'."""
        factor, unit = (math.degrees(1.0), 'deg') if self.joints else (1e3, 'mm')
        return f'{factor * self.distance:.1f} of {factor * self.zone:g} {unit}'


@dataclass(frozen=True)
class MotionRow:
    """One motion of the program.

    Attributes:
        place: Line, with the file of a subprogram: '12' or 'pick.lua:12'.
        line: Line of the program.
        kind: How the target was given and the way there.
        planned: Planned duration, s; NaN where no plan was made.
        duration: Time from the start of the motion until the robot stood at the target or passed it, s.
        position_error: Distance of the tool to its target at the end, m; that of the references where the
            next motion followed at once; NaN where it was passed.
        orientation_error: Angle to its target at the end, rad.
        passing: How the target was passed; None where the robot stood there.
        line_deviation: Largest distance of the references to the straight line outside the zones at its ends,
            m; None in joint space.
        uses: Worst use of each axis limit by quantity.
        problem: Why the motion did not succeed; empty if it did.
    """

    place: str
    line: int
    kind: str
    planned: float
    duration: float
    position_error: float
    orientation_error: float
    passing: Passing | None
    line_deviation: float | None
    uses: dict[str, LimitUse]
    problem: str

    @property
    def ok(self) -> bool:
        """The target was reached exactly, or passed within its zone, inside all limits."""
        return not self.problem


@dataclass(frozen=True)
class MotionReport:
    """All motions of a run.

    Attributes:
        rows: The motions in order.
        program_state: How the program ended.
        program_error: Its error, or empty.
        latest: The longest that a reference of a moving robot came too late, s. The robot went on from where
            it was, so that it breaks no limit as a value; but drives that wait stand meanwhile.
    """

    rows: tuple[MotionRow, ...]
    program_state: str
    program_error: str = field(default='')
    latest: float = 0.0

    @property
    def ok(self) -> bool:
        """The program finished and every motion is as it should be."""
        return self.program_state == 'FINISHED' and all(row.ok for row in self.rows)

    def show(self, console: Console) -> None:
        """Print the table and a closing line."""
        passed = any(row.passing is not None for row in self.rows)
        table = Table(box=SIMPLE_HEAD, header_style='bold', pad_edge=False, collapse_padding=True)
        table.add_column('line', justify='right', no_wrap=True)
        table.add_column('motion', no_wrap=True)
        missed = 'missed by mm, deg\n(passed in zone)' if passed else 'missed by\nmm, deg'
        for name in ('planned\ns', 'real\ns', missed, 'off line\nmm', *QUANTITIES):
            table.add_column(name, justify='right', no_wrap=True)
        for row in self.rows:
            table.add_row(*_cells(row))
        console.print(table)
        for row in self.rows:
            if not row.ok:
                console.print(f'[bold red]line {row.place}: {row.problem}[/]', highlight=False)
        if self.program_error:
            console.print(f'[bold red]{self.program_error}[/]', highlight=False)
        if self.latest > 0.0:
            console.print(
                f'[yellow]the machine was busy: references came up to {1e3 * self.latest:.0f} ms late[/]',
                highlight=False,
            )
        if self.ok:
            count = f'{len(self.rows)} motion{"" if len(self.rows) == 1 else "s"}'
            console.print(
                f'[bold green]program finished[/]: {count}, every target reached, every limit kept',
                highlight=False,
            )
        else:
            console.print(f'[bold red]program {self.program_state.lower()}[/]', highlight=False)


def motion_report(bag: Path, robot_name: str, *, namespace: str = '/') -> MotionReport:
    """Report on a recorded run.

    Args:
        bag: The recorded bag, live or simulated.
        robot_name: The robot it was recorded with.
        namespace: Namespace of the recorded cell.

    Raises:
        RobotsError: not a readable bag, or an unknown robot.
    """
    prefix = namespace.rstrip('/') + '/'
    recorded = read_bag(bag)
    found = read_messages(recorded, [prefix + topic for topic in MOTION_TOPICS])
    messages = {topic: found[prefix + topic] for topic in MOTION_TOPICS}
    robot = load_robot_model(robot_name)
    motions = recorded_motions(messages, robot)
    statuses = [status_values(message) for _, message in messages['program_status']]
    program = next((status['file'] for status in statuses if status.get('file')), '')
    last = statuses[-1] if statuses else {}
    rows: list[MotionRow] = []
    latest = 0.0
    if any(_succeeded(motion) for motion in motions):
        judge = _Judge(robot, recorded, prefix, program)
        for motion in motions:
            rows += judge.rows(motion)
        latest = judge.latest
    else:
        rows = [_failed_row(command, program) for motion in motions for command in motion.commands]
    return MotionReport(tuple(rows), last.get('state', 'unknown'), last.get('error', ''), latest)


class _Judge:
    """Compares motions with the references and the feedback of their time."""

    def __init__(self, robot: BaseRobotModel, bag: Bag, prefix: str, program: str) -> None:
        self._robot, self._program = robot, program
        references = joint_rows(bag, f'{prefix}joint_reference', robot)
        states = joint_rows(bag, f'{prefix}joint_states', robot)
        self._times, self._state_times = (
            [bag.since_start(stamp) for stamp in rows.sent.tolist()] for rows in (references, states)
        )
        self._positions = states.values[0]
        self._trajectory = reference_trajectory(references)
        self._late = late_references(references)
        self._use = ReferenceUse(robot, self._trajectory, references.period)
        self.latest = 0.0

    def rows(self, motion: MotionRecord) -> list[MotionRow]:
        """A row for each command of a motion."""
        if not _succeeded(motion):
            return [_failed_row(command, self._program) for command in motion.commands]
        assert motion.plan is not None
        first = max(0, bisect_right(self._times, motion.start) - 1)
        last = bisect_right(self._times, motion.end) - 1
        self.latest = max(self.latest, float(self._late[first : last + 1].max()))
        references = ToolPath(self._robot, self._trajectory.position[first : last + 1])
        passed = references.passings(motion.commands)
        planned = motion.plan.time[ToolPath(self._robot, motion.plan.position).passings(motion.commands)]
        starts = [first, *(first + place for place in passed)]
        ends = [*starts[1:], last]
        passing_times = [self._trajectory.time[end] - self._trajectory.time[first] for end in ends[:-1]]
        durations = np.diff([0.0, *passing_times, motion.duration])
        plans = np.diff([0.0, *planned, motion.plan.duration])
        rows = []
        for number, command in enumerate(motion.commands):
            begin, end = starts[number], ends[number]
            passing, errors = None, (math.nan, math.nan)
            if command is motion.commands[-1]:
                stood = self._trajectory.position[last] if motion.followed else self._feedback_at(motion.end)
                flange = Pose(*self._robot.direct_kinematics(stood))
                errors = (flange @ command.settings.tool_pose).distance_to(command.tool_target)
            else:
                passing = Passing(references.distance(passed[number], command), *command.zone)
            row = MotionRow(
                place=_place(command, self._program),
                line=command.line,
                kind=command.kind.title,
                planned=float(plans[number]),
                duration=float(durations[number]),
                position_error=errors[0],
                orientation_error=errors[1],
                passing=passing,
                line_deviation=references.line_deviation(
                    begin - first,
                    end - first,
                    motion.commands[number - 1] if number else None,
                    command,
                    stands=passing is None,
                )
                if command.straight
                else None,
                uses=self._use.worst(begin, end),
                problem='',
            )
            rows.append(_checked(row))
        return rows

    def _feedback_at(self, time: float) -> Array:
        if self._positions is None:
            raise RobotsError('the bag holds no joint_states with positions; a report needs them')
        return np.asarray(self._positions[max(0, bisect_right(self._state_times, time) - 1)])


def _checked(row: MotionRow) -> MotionRow:
    problems = [
        use.describe() for quantity, use in row.uses.items() if use.ratio > 1.0 + RATIO_TOLERANCE[quantity]
    ]
    if row.position_error > POSITION_TOLERANCE or row.orientation_error > ORIENTATION_TOLERANCE:
        problems.append(
            f'the target was missed by {1e3 * row.position_error:.3f} mm and '
            f'{math.degrees(row.orientation_error):.4f} deg; allowed are {1e3 * POSITION_TOLERANCE:g} mm and '
            f'{math.degrees(ORIENTATION_TOLERANCE):g} deg'
        )
    passing = row.passing
    if passing is not None and passing.distance > passing.zone * (1.0 + ZONE_TOLERANCE):
        problems.append(f'the target was passed outside its zone, in {passing.describe()}')
    if row.line_deviation is not None and row.line_deviation > LINE_TOLERANCE:
        problems.append(
            f'the references leave the straight line by {1e3 * row.line_deviation:.3f} mm, allowed is '
            f'{1e3 * LINE_TOLERANCE:g} mm'
        )
    return replace(row, problem='; '.join(problems))


def _succeeded(motion: MotionRecord) -> bool:
    return motion.plan is not None and all(command.ok for command in motion.commands)


def _failed_row(command: CommandRecord, program: str) -> MotionRow:
    nan = math.nan
    return MotionRow(
        place=_place(command, program),
        line=command.line,
        kind=command.kind.title,
        planned=nan,
        duration=nan,
        position_error=nan,
        orientation_error=nan,
        passing=None,
        line_deviation=None,
        uses={},
        problem=command.message,
    )


def _place(command: CommandRecord, program: str) -> str:
    subprogram = command.file not in ('', program)
    return f'{Path(command.file).name}:{command.line}' if subprogram else str(command.line)


def _cells(row: MotionRow) -> list[str]:
    def number(value: float | None, text: str) -> str:
        return '-' if value is None or math.isnan(value) else text.format(value)

    missed = f'{1e3 * row.position_error:.4f}, {math.degrees(row.orientation_error):.4f}'
    if row.passing is not None:
        missed = f'({row.passing.describe()})'
    elif math.isnan(row.position_error):
        missed = '-'
    cells = [
        row.place,
        row.kind,
        number(row.planned, '{:.2f}'),
        number(row.duration, '{:.2f}'),
        missed,
        number(None if row.line_deviation is None else 1e3 * row.line_deviation, '{:.4f}'),
    ]
    for quantity in QUANTITIES:
        use = row.uses.get(quantity)
        cells.append('-' if use is None else f'{use.joint} {100.0 * use.ratio:.0f}%')
    return cells
