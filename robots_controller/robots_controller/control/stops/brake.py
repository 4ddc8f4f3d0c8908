"""Brake: stops the robot off its path."""

import numpy as np
from ruckig import ControlInterface, InputParameter, OutputParameter, Ruckig, Synchronization

from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array


class Brake:
    """Brakes every axis inside its limits, off the path (Ruckig, velocity control).

    The last resort, for when the path itself cannot be followed.

    Args:
        axes: The limits.
        reference: State to brake from, (3, n): position, velocity, acceleration.
        period: Time between two references, s.
        reason: Why it brakes, for a person.
    """

    def __init__(self, axes: AxesData, reference: Array, period: float, reason: str) -> None:
        self.reason = reason
        n = axes.num_axes
        self._otg = Ruckig(n, period)
        self._input, self._output = InputParameter(n), OutputParameter(n)
        self._input.control_interface = ControlInterface.Velocity
        self._input.synchronization = Synchronization.No
        self._input.current_position = reference[0].tolist()
        self._input.current_velocity = reference[1].tolist()
        self._input.current_acceleration = np.clip(
            reference[2], -axes.acceleration, axes.acceleration
        ).tolist()
        self._input.target_velocity = [0.0] * n
        self._input.target_acceleration = [0.0] * n
        self._input.max_acceleration = axes.acceleration.tolist()
        self._input.max_jerk = axes.jerk.tolist()

    def step(self) -> tuple[Array, bool]:
        """Next reference (3, n), and whether the robot stands."""
        self._otg.update(self._input, self._output)
        self._output.pass_to_input(self._input)
        reference = np.array(
            [self._output.new_position, self._output.new_velocity, self._output.new_acceleration]
        )
        return reference, self._output.time >= self._output.trajectory.duration
