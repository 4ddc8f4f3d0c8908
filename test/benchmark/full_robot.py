"""The motion and load of the Modelica Standard Library's example RobotR3.FullRobot, to compare with."""

from typing import Final

import numpy as np

from robots_core.blocks.drives.rigid_body_drive import RigidBodyDrive
from robots_core.blocks.multibody.payload import Payload
from robots_core.validation import Array, read_only
from robots_models.manutec_r3.model import ManutecR3

START: Final = read_only(ManutecR3.HOME)
END: Final = read_only(np.radians([60.0, -70.0, -35.0, 45.0, 110.0, 45.0]))
SPEED: Final = read_only([3.0, 1.5, 5.0, 3.1, 3.1, 4.1])  # rad/s
ACCELERATION: Final = read_only([15.0, 15.0, 15.0, 60.0, 60.0, 60.0])  # rad/s^2
SWING_TIME: Final = 0.5  # s, after the motion

# All axes in step: speed and acceleration of the common path coordinate 0..1, as in the library's
# KinematicPTP2.
_WAY: Final = END - START
_PATH_SPEED: Final = float((SPEED / np.abs(_WAY)).min())
_PATH_ACCELERATION: Final = float((ACCELERATION / np.abs(_WAY)).min())
_RAMP: Final = _PATH_SPEED / _PATH_ACCELERATION
DURATION: Final = 1.0 / _PATH_SPEED + _RAMP  # s

# The library gives bodies without one this inertia.
LOAD: Final = Payload(ManutecR3.DATA.load_mass, np.array(ManutecR3.DATA.load_centre), 1e-3 * np.eye(3))


def reference(t: float) -> tuple[Array, Array]:
    """Positions and velocities (6,) of the reference `t` seconds after its start."""
    if t < _RAMP:
        s, v = 0.5 * _PATH_ACCELERATION * t**2, _PATH_ACCELERATION * t
    elif t < DURATION - _RAMP:
        s, v = _PATH_SPEED * (t - 0.5 * _RAMP), _PATH_SPEED
    elif t < DURATION:
        rest = DURATION - t
        s, v = 1.0 - 0.5 * _PATH_ACCELERATION * rest**2, _PATH_ACCELERATION * rest
    else:
        s, v = 1.0, 0.0
    return START + s * _WAY, v * _WAY


def simulate(drive: RigidBodyDrive, period: float, end: float) -> tuple[Array, Array, Array]:
    """Let drives with this period follow the reference from the start.

    Returns:
        Times (m,), s; positions (m, 6), rad; torques of the motors at the joints (m, 6), N m.
    """
    q, tau = [drive.position], [drive.torque]
    for k in range(1, round(end / period) + 1):
        drive.step(*reference(k * period))
        q.append(drive.position)
        tau.append(drive.torque)
    time: Array = np.linspace(0.0, period * (len(q) - 1), len(q))
    return time, np.array(q), np.array(tau)
