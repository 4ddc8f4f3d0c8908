"""Cockpit: what a person in a cabin does, or a vehicle simulation says, becomes the motion of the cabin."""

from __future__ import annotations

import numpy as np

from robots_core.blocks.motion_cueing.cabin import Cabin
from robots_core.blocks.motion_cueing.driven_vehicle import DrivenVehicle, DriverInputs
from robots_core.blocks.motion_cueing.motion_cueing import CueingStep, MotionCueing
from robots_core.blocks.motion_cueing.vehicle_motion import VehicleMotion


class Cockpit:
    """Cues the motion of the vehicle that a person drives, or of one that is simulated elsewhere.

    A driver's inputs hold until the next ones, and for the timeout of the cueing at most; then the car stands
    and the cabin returns to its middle. Motions of a vehicle take precedence over inputs while both come.
    Where they come more rarely than the steps, each is approached linearly within the time since the one
    before: held values would be stairs, which the person would feel.

    Args:
        cabin: The cabin.
        dt: Period, s.

    Raises:
        InvalidInputError: a period that is not positive.
    """

    def __init__(self, cabin: Cabin, dt: float) -> None:
        self.cabin, self._dt = cabin, dt
        self._cueing = MotionCueing(cabin.washout, cabin.envelope, dt)
        self._vehicle = DrivenVehicle(cabin.vehicle, dt)
        self._longest = round(cabin.washout.timeout / dt)
        self.handed_over = False
        """The cabin is moved."""
        self.reset()

    def hand_over(self, *, handed_over: bool) -> None:
        """The cabin is moved from now on, or not any more: then it starts again in its middle."""
        if self.handed_over and not handed_over:
            self.reset()
        self.handed_over = handed_over

    def reset(self) -> None:
        """Start again with a cabin that stands in its middle, and a car that stands."""
        self._cueing.reset()
        self._vehicle.stop()
        self._inputs: DriverInputs | None = None
        self._age = 0.0
        self._motion, self._aim = np.zeros((2, 6))  # of the vehicle: specific force, angular velocity
        self._left, self._since = 0, self._longest  # steps: to the aim, since the last one came

    def take(self, value: DriverInputs | VehicleMotion) -> None:
        """Take inputs of the driver, or a motion of the vehicle."""
        if isinstance(value, VehicleMotion):
            self._aim = np.concatenate([value.specific_force, value.angular_velocity])
            self._left = self._since if 0 < self._since < self._longest else 1
            self._since = 0
        else:
            self._inputs, self._age = value, 0.0

    def step(self) -> CueingStep:
        """Motion of the cabin at the end of the next period."""
        motion = self._approached()
        if self._inputs is not None:
            driven = self._vehicle.step(self._inputs)
            motion = motion or driven
            self._age += self._dt
            if self._age > self.cabin.washout.timeout:
                self._inputs = None
                self._vehicle.stop()
        return self._cueing.step(motion)

    def _approached(self) -> VehicleMotion | None:
        """The motion of the vehicle; None if nothing new of it has come."""
        self._since += 1
        if self._left == 0:
            return None
        self._motion = self._motion + (self._aim - self._motion) / self._left
        self._left -= 1
        return VehicleMotion(self._motion[:3], self._motion[3:])
