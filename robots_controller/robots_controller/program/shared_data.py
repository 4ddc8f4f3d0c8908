"""SharedData: what a running program shares with the robot's side (paper, table 1)."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robots_controller.io.io_image import IoImage
from robots_controller.program.cell_port import CellPort
from robots_controller.program.motion_command import MotionCommand, OutputChange
from robots_controller.program.program_state import ProgramState
from robots_core.errors import InvalidInputError, RobotsError
from robots_core.pose import Pose
from robots_core.validation import Array
from robots_planning.robot_command_state import RobotCommandState


class SharedData:
    """The data core as its users see it; safe from any thread while the program runs.

    Args:
        state: Holds the data.
        cell: Gets the changes of outputs.
        prismatic: Per axis, whether it slides; () if unknown.
    """

    def __init__(self, state: ProgramState, cell: CellPort, prismatic: tuple[bool, ...]) -> None:
        self._state, self._cell, self._prismatic = state, cell, prismatic

    @property
    def num_axes(self) -> int:
        """Number of axes n; it cannot change while the program runs."""
        return self._state.num_axes

    @num_axes.setter
    def num_axes(self, num_axes: int) -> None:
        if self._prismatic and num_axes != len(self._prismatic):
            raise InvalidInputError(f'prismatic names {len(self._prismatic)} axes, num_axes = {num_axes}')
        self._state.set_num_axes(num_axes)

    @property
    def command_state(self) -> RobotCommandState:
        """What the robot is commanded to do; setting IDLE ends the motion as `finish_motion` does."""
        return self._state.command_state

    @command_state.setter
    def command_state(self, state: RobotCommandState | str) -> None:
        self._state.set_command_state(state)

    @property
    def motion(self) -> MotionCommand | None:
        """The oldest motion that is commanded and not finished."""
        return self._state.motion

    @property
    def motions(self) -> tuple[MotionCommand, ...]:
        """All of them, oldest first: there are several where motions blend."""
        return self._state.motions

    def finish_motion(self, error: RobotsError | None = None, command: MotionCommand | None = None) -> None:
        """End a commanded motion: the robot is at the target, or `error` says why not.

        Args:
            error: None if all is well; otherwise all commanded motions have ended.
            command: Which motion, the oldest by default; those before it have ended too.
        """
        self._state.finish_motion(error, command)

    def switch_output(self, change: OutputChange) -> None:
        """Switch an output for a motion on its way (see `PathSwitch`); from any thread."""
        if self._state.set_output(change.kind, change.index, change.value):
            self._cell.output_changed(change)

    @property
    def reference_cartesian_position(self) -> Pose | None:
        """Where the last commanded motion leads the tool, seen from the base.

        None before the first, and after a joint motion in a cell that has no kinematics.
        """
        return self._state.reference_pose

    @property
    def io(self) -> IoImage:
        """All inputs and outputs, by name too, to be set and forced."""
        return self._state.io

    @property
    def digital_inputs(self) -> NDArray[np.bool_]:
        """Image of the digital inputs; set 0s and 1s for inputs 1..k, further inputs keep theirs."""
        return self.io.bits('digital_inputs')

    @digital_inputs.setter
    def digital_inputs(self, values: ArrayLike) -> None:
        self.io.set_inputs('digital', values)

    @property
    def analog_inputs(self) -> Array:
        """Image of the analog inputs; set numbers for inputs 1..k, further inputs keep theirs."""
        return self.io.numbers('analog_inputs')

    @analog_inputs.setter
    def analog_inputs(self, values: ArrayLike) -> None:
        self.io.set_inputs('analog', values)

    @property
    def digital_outputs(self) -> NDArray[np.bool_]:
        """Image of the digital outputs; the first is output 1."""
        return self.io.bits('digital_outputs')

    @property
    def analog_outputs(self) -> Array:
        """Image of the analog outputs; the first is output 1."""
        return self.io.numbers('analog_outputs')

    @property
    def overrides(self) -> Array:
        """Speed scale factor per axis, (n,), 0..1."""
        return self._state.overrides

    @overrides.setter
    def overrides(self, values: ArrayLike) -> None:
        self._state.set_overrides(values)
