"""The errors a user can cause: each names the value, the bound and what would be valid.

Each class has a code, which stays the same, and a remedy; `docs/reference/errors.md` and `robots explain`
show both.
"""

from typing import ClassVar


class RobotsError(Exception):
    """Base of every error that Robots raises for its user.

    Args:
        message: One sentence for a person: what came, the bound it breaks, what would be valid.
        details: The same facts for a program (joint names, SI values), as they travel in messages. `key` is
            what happened, among the errors of one code; texts in other languages are found by it.

    Attributes:
        code: Of its kind, the same in every version.
        remedy: What to do about errors of its class.
    """

    code: str = 'R000'
    remedy: ClassVar[str] = 'Read the message: it names what came and what would be valid.'

    def __init__(self, message: str, **details: str | float) -> None:
        super().__init__(message)
        self.message = message
        self.details = details

    @property
    def line_for_person(self) -> str:
        """The line that a command or node ends with."""
        return f'error: {self} [{self.code}]'


class InvalidInputError(RobotsError, ValueError):
    """An argument of the wrong shape, not finite, or outside its range."""

    code = 'R100'
    remedy = (
        'Give a value that the message names as valid; lengths are metres, angles radians (in '
        'robot programs degrees).'
    )


class JointNamesError(InvalidInputError):
    """A message that lacks a joint of the robot, or names one twice."""

    code = 'R104'
    remedy = 'Name each joint of the robot once; `robots show NAME` lists them.'


class UnknownRobotError(RobotsError, LookupError):
    """No installed plugin has that robot name, or the URDF cannot be made a robot."""

    code = 'R106'
    remedy = '`robots list` shows the installed robots, `robots check FILE.urdf` what a file lacks.'


class JointLimitError(InvalidInputError):
    """A joint value outside the axis' limits."""

    code = 'R105'
    remedy = (
        'Choose a position inside the limits; `robots show NAME` lists them. In robot programs '
        'angles are degrees.'
    )

    def __init__(self, joint: str, value: float, lower: float, upper: float, *, unit: str = 'rad') -> None:
        super().__init__(
            f'{joint} = {value:.9g} {unit} is outside its limits [{lower:.9g}, {upper:.9g}] {unit}',
            joint=joint,
            value=value,
            lower=lower,
            upper=upper,
            unit=unit,
        )


class NoAnalyticInverseKinematicsError(RobotsError):
    """The robot offers no closed-form inverse kinematics; use a numerical block instead."""

    code = 'R301'
    remedy = 'Use a numerical method, such as `DampedLeastSquares` or `--guided constrained`.'


class UnreachablePoseError(RobotsError):
    """No joint configuration inside the limits reaches the pose."""

    code = 'R302'
    remedy = (
        'Move the target or the robot nearer, or turn the tool; check the units (metres, '
        'degrees), tool and base. `robots show NAME` states the reach.'
    )


class PlanningError(RobotsError):
    """A motion cannot be planned as commanded."""

    code = 'R300'
    remedy = (
        'Change the motion as the message says: its target, speed, blend zone, or what precedes '
        'it. `check_program --walk` finds such motions before anything moves.'
    )


class MotionEndedError(RobotsError):
    """A motion that ended before its target: it was stopped, or a fault or an obstacle stopped it."""

    code = 'R308'
    remedy = (
        'Remove the cause that the message names, reset the controller after a fault '
        '(`docs/reference/stops.md`), and command the motion again.'
    )


class TrajectoryRefusedError(RobotsError):
    """The controller does not accept a trajectory."""

    code = 'R400'
    remedy = (
        'Begin the trajectory where the robot is, at rest, within all limits; reset the '
        'controller after a stop.'
    )


class CommandRefusedError(RobotsError):
    """Another commander owns the robot, or its operating mode excludes the sender."""

    code = 'R401'
    remedy = (
        'Wait until the other commander has ended, or change the operating mode '
        '(`docs/how_to/operating_modes.md`).'
    )


class ProgramError(RobotsError):
    """A robot program that cannot be loaded or failed while running.

    Args:
        message: What went wrong, for a person.
        file: The program's file name.
        line: The program's line, counted from 1; 0 where no line is known.
    """

    code = 'R200'
    remedy = (
        'Change the program at the line that the message names; `check_program` finds most such '
        'mistakes before it runs.'
    )

    def __init__(self, message: str, *, file: str = '', line: int = 0, **details: str | float) -> None:
        where = f'{file}:{line}: ' if file and line else f'{file}: ' if file else ''
        super().__init__(f'{where}{message}', **details)
        self.file = file
        self.line = line
        self.reason = message


class OptionError(InvalidInputError):
    """An option or argument of a command that is unknown, missing or not valid."""

    code = 'R101'
    remedy = 'Correct the option as the message says; `--help` after the command lists all.'


class UnreadableFileError(InvalidInputError):
    """A file that does not exist, cannot be read or written, or is too large."""

    code = 'R102'
    remedy = 'Check the path, seen from the current folder, and the permissions of the file.'


class FileContentError(InvalidInputError):
    """A YAML file whose content is not valid at a line."""

    code = 'R103'
    remedy = 'Change the file at the line that the message names.'


class MeasurementError(InvalidInputError):
    """Points or a motion from which a tool, base or payload cannot be determined well enough."""

    code = 'R109'
    remedy = 'Take the point or motion again that the message names (`docs/how_to/tools_and_bases.md`).'


class BagError(RobotsError):
    """A recorded bag that cannot be read or written, or lacks what is needed."""

    code = 'R107'
    remedy = 'Name the folder of a bag, or its .mcap or .db3 file, with the topics that the message names.'


class InstallationError(RobotsError):
    """Something that is not installed, built or free on this machine."""

    code = 'R108'
    remedy = 'Install or build what the message names: `make build`, then `source environment.bash`.'


class NotNowError(RobotsError):
    """Something that cannot be done in the present state of the cell."""

    code = 'R402'
    remedy = 'Remove the cause that the message names, then try again.'


class NoAnswerError(RobotsError):
    """A node that does not answer, or sends nothing."""

    code = 'R403'
    remedy = 'Start the cell, and use its ROS domain and namespace.'
