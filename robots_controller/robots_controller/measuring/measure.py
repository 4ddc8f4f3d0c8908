"""robots measure: tools, bases and payloads, from taught points and recorded motions."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from rich.console import Console
from rich.markup import escape

from robots_controller.commands.json_output import print_json
from robots_controller.measuring.frame_measuring import FrameMeasuring
from robots_controller.measuring.frame_measuring import Sequence as Touched
from robots_controller.measuring.shown_numbers import degrees, millimetres
from robots_controller.program.files.cell_frames import FRAMES_FILE, FrameKind
from robots_controller.program.files.program_header import read_program_header
from robots_controller.program.files.taught_points import SUFFIX, TaughtPoint, read_points
from robots_controller.recording.bag_file import read_bag
from robots_controller.recording.joint_rows import joint_rows, recorded_robot
from robots_controller.terminal_table import Columns, TerminalTable
from robots_core.blocks.calibration.motion_samples import MotionSamples
from robots_core.blocks.calibration.payload_identification import identify_payload
from robots_core.errors import BagError, MeasurementError, OptionError, UnreadableFileError
from robots_core.exit_codes import ExitCode
from robots_core.message_builder import NANOSECONDS
from robots_core.pose import Pose
from robots_core.robot_choice import load_robot_model
from robots_core.robot_model.base_robot_model import BaseRobotModel

RESULT: Final[Columns] = (
    ('quantity', 'text'),
    ('value', 'number'),
    ('+-', 'number'),
    ('unit', 'text'),
)
POINTS: Final[Columns] = (('point', 'text'), ('residual mm', 'number'))


@dataclass(frozen=True)
class Measured:
    """What was measured.

    Attributes:
        kind: Of what is saved.
        rows: What a table shows: quantity, value, standard deviation, unit.
        data: What `--json` prints, in SI units; `residuals` by point, m, are shown as a table too.
        save: Writes it to a frames file under a name.
    """

    kind: FrameKind
    rows: Sequence[tuple[str, str, str, str]]
    data: Mapping[str, Any]
    save: Callable[[Path, str], None]


def measure(options: argparse.Namespace, console: Console) -> int:
    """Measure, print the result, and save it if it has a name; returns an exit code.

    Raises:
        RobotsError: what the options name is not there, or determines nothing well enough.
    """
    found = MEASURES[options.what](options)
    file = _frames_file(options)
    if options.name:
        found.save(file, options.name)
    if options.json:
        print_json({'saved': file if options.name else None, **found.data})
        return ExitCode.OK
    TerminalTable(RESULT, found.rows).show(console)
    if residuals := found.data.get('residuals'):
        rows = [(escape(name), f'{1e3 * one:.2f}') for name, one in residuals.items()]
        TerminalTable(POINTS, rows).show(console)
    saved = (
        f'{found.kind} {options.name} is saved in {file}' if options.name else 'not saved; --name saves it'
    )
    console.print(escape(saved))
    return ExitCode.OK


def measure_tool(options: argparse.Namespace) -> Measured:
    """A tool from taught points."""
    robot = _robot(options)
    points, turned = _points(options.file, robot), options.orientation or []
    names = options.points or [name for name in points if name not in turned]
    measuring = _touched(robot, points, {'tool': names, 'orientation': turned})
    try:
        center = measuring.tool_center()
    except MeasurementError as error:
        index = error.details.get('index')
        if index is None:
            raise
        raise MeasurementError(
            f'{error} (point {int(index) + 1} is {names[int(index)]})', **error.details
        ) from None
    pose = measuring.tool(options.axis)
    residuals = dict(zip(names, center.residuals.tolist(), strict=True))
    return Measured(
        'tool',
        _pose_rows(pose, robot, center.std.tolist(), turned=bool(turned)),
        {**_pose_data(pose), 'std': center.std, 'touched': center.touched, 'residuals': residuals},
        lambda file, name: measuring.save_tool(file, name, options.axis),
    )


def measure_base(options: argparse.Namespace) -> Measured:
    """A base from three taught points, which leave no residual."""
    robot = _robot(options)
    measuring = _touched(robot, _points(options.file, robot), {'base': options.points})
    pose = measuring.base(measuring.tool_of(_frames_file(options), options.tool))
    return Measured(
        'base',
        _pose_rows(pose, robot, (), turned=True),
        _pose_data(pose),
        lambda path, name: measuring.save_base(path, name, options.tool),
    )


def measure_payload(options: argparse.Namespace) -> Measured:
    """A payload from the torques of a recorded motion."""
    robot, samples = recorded_motion(options.file, robot=options.robot, namespace=options.namespace)
    found = identify_payload(robot, samples)
    center, std = millimetres(found.payload.center), millimetres(found.center_std)
    return Measured(
        'tool',
        [
            ('mass', f'{found.payload.mass:.3f}', f'{found.mass_std:.3f}', 'kg'),
            *((f'centre of mass {axis}', center[axis], std[axis], 'mm') for axis in 'xyz'),
        ],
        {
            'mass': found.payload.mass,
            'mass_std': found.mass_std,
            'center': found.payload.center,
            'center_std': found.center_std,
            'torque_residuals': dict(zip(robot.axes_data.names, found.torque_error.tolist(), strict=True)),
        },
        lambda file, name: FrameMeasuring(robot).save_payload(file, name, found),
    )


MEASURES: Final[Mapping[str, Callable[[argparse.Namespace], Measured]]] = {
    'tool': measure_tool,
    'base': measure_base,
    'payload': measure_payload,
}


def _touched(
    robot: BaseRobotModel, points: Mapping[str, TaughtPoint], names: Mapping[Touched, Sequence[str]]
) -> FrameMeasuring:
    measuring = FrameMeasuring(robot)
    for sequence, ones in names.items():
        for name in ones:
            if name not in points:
                raise OptionError(f'no point is named {name!r}; points are {", ".join(points)}')
            measuring.touch(sequence, points[name].q)
    return measuring


def _frames_file(options: argparse.Namespace) -> Path:
    """The one that is named, or the one beside the points; beside no bag."""
    beside = Path() if options.what == 'payload' else options.file.parent
    return Path(options.frames or beside / FRAMES_FILE)


def _points(file: Path, robot: BaseRobotModel) -> Mapping[str, TaughtPoint]:
    if not file.is_file():
        raise UnreadableFileError(f'there is no points file {file}')
    return read_points(file, robot.num_axes)


def _robot(options: argparse.Namespace) -> BaseRobotModel:
    """The robot that is named, or the one of the program beside the points file."""
    program = options.file.parent / f'{options.file.name.removesuffix(SUFFIX)}.lua'
    name = options.robot or (read_program_header(program).robot if program.is_file() else '')
    if not name:
        raise OptionError(f'no program {program} names the robot; name it: --robot NAME')
    return load_robot_model(name)


def _pose_rows(
    pose: Pose, robot: BaseRobotModel, std: Sequence[float], *, turned: bool
) -> list[tuple[str, str, str, str]]:
    lengths = millimetres(pose.r)
    errors = millimetres(std) if std else dict.fromkeys('xyz', '')
    rows = [(axis, lengths[axis], errors[axis], 'mm') for axis in 'xyz']
    if turned:
        angles = degrees(pose, robot.orientation_convention)
        rows += [(f'{name} ({angles["convention"]})', angles[name], '', 'deg') for name in 'abc']
    return rows


def _pose_data(pose: Pose) -> dict[str, Any]:
    return {'position': pose.r, 'quaternion': pose.quaternion()}


def recorded_motion(
    path: Path, *, robot: str = '', namespace: str = '/'
) -> tuple[BaseRobotModel, MotionSamples]:
    """The robot and the motion of a bag; see `recorded_robot`.

    Raises:
        RobotsError: it is no bag, names no robot, or has no torques.
    """
    bag, prefix = read_bag(path), namespace.rstrip('/') + '/'
    model = recorded_robot(bag, prefix, robot)
    rows = joint_rows(bag, f'{prefix}joint_states', model)
    q, _, tau = rows.values
    if q is None or tau is None:
        raise BagError(
            f'{path} has no torques (effort) in {prefix}joint_states; simulated drives of the level '
            'rigid_body measure them'
        )
    stamp, first = np.unique(rows.stamp, return_index=True)
    return model, MotionSamples.from_recording((stamp - stamp[0]) / NANOSECONDS, q[first], tau[first])
