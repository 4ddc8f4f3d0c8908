"""The errors a user can cause: each names the value, the bound and what would be valid."""


class RobotsError(Exception):
    """Base of every error that Robots raises for its user.

    Args:
        message: One sentence for a person: what came, the bound it breaks, what would be valid.
        details: The same facts for a program (joint names, SI values), as they travel in messages.
    """

    def __init__(self, message: str, **details: str | float) -> None:
        super().__init__(message)
        self.message = message
        self.details = details


class InvalidInputError(RobotsError, ValueError):
    """An argument of the wrong shape, not finite, or outside its range."""


class JointNamesError(InvalidInputError):
    """A message that lacks a joint of the robot, or names one twice."""


class UnknownRobotError(RobotsError, LookupError):
    """No installed plugin has that robot name, or the URDF cannot be made a robot."""


class JointLimitError(InvalidInputError):
    """A joint value outside the axis' limits."""

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


class UnreachablePoseError(RobotsError):
    """No joint configuration inside the limits reaches the pose."""


class PlanningError(RobotsError):
    """A motion cannot be planned as commanded."""


class TrajectoryRefusedError(RobotsError):
    """The controller does not accept a trajectory."""


class CommandRefusedError(RobotsError):
    """Another commander owns the robot, or its operating mode excludes the sender."""


class ProgramError(RobotsError):
    """A robot program that cannot be loaded or failed while running.

    Args:
        message: What went wrong, for a person.
        file: The program's file name.
        line: The program's line, counted from 1; 0 where no line is known.
    """

    def __init__(self, message: str, *, file: str = '', line: int = 0, **details: str | float) -> None:
        where = f'{file}:{line}: ' if file and line else f'{file}: ' if file else ''
        super().__init__(f'{where}{message}', **details)
        self.file = file
        self.line = line
        self.reason = message
