"""MotionReport: what a recorded program run did, motion by motion."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from robots_controller.bag_reading import read_messages, reference_trajectory, seconds
from robots_core.pose import Pose
from robots_core.robot_choice import load_robot_model
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.robot_command_state import RobotCommandState
from robots_planning.verification import LimitUse, verify

POSITION_TOLERANCE = 1e-4  # m
ORIENTATION_TOLERANCE = math.radians(0.01)  # rad
LINE_TOLERANCE = 1e-4  # m
# The references are rebuilt from samples one period apart; verify resamples them at 1 kHz.
RATIO_TOLERANCE = 1e-3
OK = 0  # DiagnosticStatus.OK
QUANTITIES = ('position', 'velocity', 'acceleration', 'torque')

COMMAND_TOPICS = {
    'ptpjoint_joint': RobotCommandState.PTPJOINT_JOINT,
    'ptpjoint_cartesian': RobotCommandState.PTPJOINT_CARTESIAN,
    'ptpcartesian': RobotCommandState.PTPCARTESIAN,
}
TOPICS = (
    *COMMAND_TOPICS,
    'joint_trajectory',
    'motion_result',
    'joint_reference',
    'joint_states',
    'program_status',
)


@dataclass(frozen=True)
class MotionRow:
    """One motion of the program.

    Attributes:
        line: Line of the program.
        kind: How the target was given and the way there.
        planned: Planned duration, s; NaN where no plan was made.
        duration: Time from the start of the motion until the robot stood at the target, s.
        position_error: Distance of the tool to its target at the end, m.
        orientation_error: Angle to its target at the end, rad.
        line_deviation: Largest distance of the references to the straight line, m; None in joint space.
        uses: Worst use of each axis limit by quantity.
        problem: Why the motion did not succeed; empty if it did.
    """

    line: int
    kind: str
    planned: float
    duration: float
    position_error: float
    orientation_error: float
    line_deviation: float | None
    uses: dict[str, LimitUse]
    problem: str

    @property
    def ok(self) -> bool:
        """The target was reached exactly, inside all limits."""
        return not self.problem


@dataclass(frozen=True)
class MotionReport:
    """All motions of a run.

    Attributes:
        rows: The motions in order.
        program_state: How the program ended.
        program_error: Its error, or empty.
    """

    rows: tuple[MotionRow, ...]
    program_state: str
    program_error: str = field(default='')

    @property
    def ok(self) -> bool:
        """The program finished and every motion is as it should be."""
        return self.program_state == 'FINISHED' and all(row.ok for row in self.rows)

    def show(self, console: Console) -> None:
        """Print the table and a closing line."""
        table = Table(box=SIMPLE_HEAD, header_style='bold', pad_edge=False)
        table.add_column('line', justify='right')
        table.add_column('motion')
        names = ('planned\ns', 'real\ns', 'missed by\nmm, deg', 'off line\nmm', *QUANTITIES)
        for name in names:
            table.add_column(name, justify='right', no_wrap=True)
        for row in self.rows:
            table.add_row(*_cells(row))
        console.print(table)
        for row in self.rows:
            if not row.ok:
                console.print(f'[bold red]line {row.line}: {row.problem}[/]', highlight=False)
        if self.program_error:
            console.print(f'[bold red]{self.program_error}[/]', highlight=False)
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
        bag: The recorded bag.
        robot_name: The robot it was recorded with.
        namespace: Namespace of the recorded cell.

    Raises:
        RobotsError: not a readable bag, or an unknown robot.
    """
    prefix = namespace.rstrip('/') + '/'
    recorded = read_messages(bag, [prefix + topic for topic in TOPICS])
    messages = {topic: recorded[prefix + topic] for topic in TOPICS}
    robot = load_robot_model(robot_name)
    commands = sorted(
        ((time, topic, message) for topic in COMMAND_TOPICS for time, message in messages[topic]),
        key=lambda item: seconds(item[2].header.stamp),
    )
    statuses = [(time, _values(message)) for time, message in messages['program_status']]
    rows = [
        _row(robot, COMMAND_TOPICS[topic], message, _status_before(statuses, time), messages)
        for time, topic, message in commands
    ]
    last = statuses[-1][1] if statuses else {}
    return MotionReport(tuple(rows), last.get('state', 'unknown'), last.get('error', ''))


def _row(
    robot: BaseRobotModel,
    kind: RobotCommandState,
    command: Any,
    status: dict[str, str],
    messages: dict[str, list[tuple[float, Any]]],
) -> MotionRow:
    id_ = _stamp_id(command.header.stamp)
    results = [
        (time, message) for time, message in messages['motion_result'] if _values(message).get('id') == id_
    ]
    plans = [(time, m) for time, m in messages['joint_trajectory'] if _stamp_id(m.header.stamp) == id_]
    line = int(status.get('line') or 0)
    if not results:
        return _failed_row(line, kind, 'no result was recorded')
    end, result = results[-1]
    values = _values(result)
    if not plans or result.level != OK:
        return _failed_row(line, kind, str(result.message))
    start, plan = plans[-1]
    references = [m for time, m in messages['joint_reference'] if start <= time <= end]
    trajectory = reference_trajectory(references)
    target = _target(robot, kind, command)
    r, T = robot.direct_kinematics(trajectory.position[0])
    straight = (Pose(r, T), target) if kind is RobotCommandState.PTPCARTESIAN else None
    report = verify(trajectory, robot, line=straight)
    stood = _feedback_at(robot, messages['joint_states'], end)
    position_error, orientation_error = stood.distance_to(target)
    row = MotionRow(
        line=line,
        kind=kind.value,
        planned=seconds(plan.points[-1].time_from_start),
        duration=float(values['duration']),
        position_error=position_error,
        orientation_error=orientation_error,
        line_deviation=report.line_deviation,
        uses={quantity: report.uses[quantity] for quantity in QUANTITIES},
        problem='',
    )
    return _checked(row)


def _checked(row: MotionRow) -> MotionRow:
    problems = [use.describe() for use in row.uses.values() if use.ratio > 1.0 + RATIO_TOLERANCE]
    if row.position_error > POSITION_TOLERANCE or row.orientation_error > ORIENTATION_TOLERANCE:
        problems.append(
            f'the target was missed by {1e3 * row.position_error:.3f} mm and '
            f'{math.degrees(row.orientation_error):.4f} deg; allowed are {1e3 * POSITION_TOLERANCE:g} mm and '
            f'{math.degrees(ORIENTATION_TOLERANCE):g} deg'
        )
    if row.line_deviation is not None and row.line_deviation > LINE_TOLERANCE:
        problems.append(
            f'the references leave the straight line by {1e3 * row.line_deviation:.3f} mm, allowed is '
            f'{1e3 * LINE_TOLERANCE:g} mm'
        )
    return MotionRow(**{**vars(row), 'problem': '; '.join(problems)})


def _failed_row(line: int, kind: RobotCommandState, problem: str) -> MotionRow:
    nan = math.nan
    return MotionRow(line, kind.value, nan, nan, nan, nan, None, {}, problem)


def _target(robot: BaseRobotModel, kind: RobotCommandState, command: Any) -> Pose:
    if kind is RobotCommandState.PTPJOINT_JOINT:
        return Pose(*robot.direct_kinematics(np.asarray(command.position)))
    p, o = command.pose.position, command.pose.orientation
    return Pose.from_quaternion([p.x, p.y, p.z], [o.x, o.y, o.z, o.w])


def _feedback_at(robot: BaseRobotModel, joint_states: Sequence[tuple[float, Any]], time: float) -> Pose:
    index = max(0, bisect_right([t for t, _ in joint_states], time) - 1)
    message = joint_states[index][1]
    q: Array = np.array([message.position[message.name.index(name)] for name in robot.axes_data.names])
    return Pose(*robot.direct_kinematics(q))


def _status_before(statuses: Sequence[tuple[float, dict[str, str]]], time: float) -> dict[str, str]:
    index = bisect_right([t for t, _ in statuses], time) - 1
    return statuses[index][1] if index >= 0 else {}


def _values(status: Any) -> dict[str, str]:
    return {item.key: item.value for item in status.values}


def _stamp_id(stamp: Any) -> str:
    return f'{stamp.sec}.{stamp.nanosec:09d}'


def _cells(row: MotionRow) -> list[str]:
    def number(value: float | None, text: str) -> str:
        return '-' if value is None or math.isnan(value) else text.format(value)

    missed = f'{1e3 * row.position_error:.4f}, {math.degrees(row.orientation_error):.4f}'
    cells = [
        str(row.line),
        row.kind,
        number(row.planned, '{:.2f}'),
        number(row.duration, '{:.2f}'),
        '-' if math.isnan(row.position_error) else missed,
        number(None if row.line_deviation is None else 1e3 * row.line_deviation, '{:.4f}'),
    ]
    for quantity in QUANTITIES:
        use = row.uses.get(quantity)
        cells.append('-' if use is None else f'{use.joint} {100.0 * use.ratio:.0f}%')
    return cells
