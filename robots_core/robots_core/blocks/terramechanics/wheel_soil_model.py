"""WheelSoilModel: forces of soft soil on a rigid wheel."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import Final

import numpy as np

from robots_core.blocks.terramechanics.soil import Soil
from robots_core.errors import InvalidInputError
from robots_core.validation import Array, positive

NODES: Final = 24  # of the quadrature, on each side of the largest stress
_X, _W = np.polynomial.legendre.leggauss(NODES)
# The inverse gives the sinkage to this.
RESOLUTION: Final = 1e-12  # m


@dataclass(frozen=True, kw_only=True)
class Wheel:
    """A rigid cylinder.

    Attributes:
        radius: m.
        width: m.

    Raises:
        InvalidInputError: one that is not a finite number above 0.
    """

    radius: float
    width: float

    def __post_init__(self) -> None:
        positive(self.radius, 'radius', 'm')
        positive(self.width, 'width', 'm')


@dataclass(frozen=True)
class WheelForces:
    """What the soil does to a wheel, at its hub.

    Attributes:
        load: Upward force, N, which carries the wheel's vertical load.
        drawbar_pull: Forward force, N: what is left of the traction to pull with.
        torque: That the wheel's drive has to give, N m.
    """

    load: float
    drawbar_pull: float
    torque: float


class WheelSoilModel:
    """A driven wheel that rolls with a steady slip, by the stress below it.

    The normal stress follows M. G. Bekker's pressure-sinkage relation from the entry angle to its largest
    value, whose angle grows with slip, and falls to the exit angle (J. Y. Wong, A. R. Reece, Prediction of
    rigid wheel performance based on the analysis of soil-wheel stresses, part I, Journal of Terramechanics
    4(1), 1967). The shear stress follows Z. Janosi and B. Hanamoto (1961). Slip sinkage by lugs, bulldozing
    and lateral forces are not in it. For a braked wheel (slip below 0) the same formulas stand in.

    Args:
        wheel: The wheel.
        soil: The soil.
    """

    def __init__(self, wheel: Wheel, soil: Soil) -> None:
        self.wheel, self.soil = wheel, soil
        self._stiffness = (soil.k_c / wheel.width + soil.k_phi) * wheel.radius**soil.n

    def angles(self, sinkage: float, slip: float) -> tuple[float, float, float]:
        """Where the contact begins, where the normal stress is largest, and where it ends.

        Args:
            sinkage: Of the wheel's lowest point, m; from 0 to the radius.
            slip: 1 - v / (r omega) of a driven wheel, r omega / v - 1 of a braked one; -1 to 1.

        Returns:
            Angles from straight below the hub, forward, rad.

        Raises:
            InvalidInputError: a sinkage or slip out of its range.
        """
        radius, soil = self.wheel.radius, self.soil
        if not 0.0 <= sinkage <= radius:
            raise InvalidInputError(f'sinkage = {sinkage!r} m must be in [0, {radius:g}] m, the radius')
        if not -1.0 <= slip <= 1.0:
            raise InvalidInputError(f'slip = {slip!r} must be in [-1, 1]')
        entry = float(np.arccos(1.0 - sinkage / radius))
        leave = -float(np.arccos(1.0 - soil.rear_ratio * sinkage / radius))
        return entry, max(leave, (soil.c1 + soil.c2 * slip) * entry), leave

    def stresses(self, theta: Array, sinkage: float, slip: float) -> tuple[Array, Array]:
        """Normal and shear stress, (k,) Pa each, at angles theta (k,) rad from straight below, forward."""
        entry, largest, leave = self.angles(sinkage, slip)
        normal = self._normal(theta, entry, largest, leave)
        return normal, self._shear(theta, normal, entry, slip)

    def forces(self, sinkage: float, slip: float) -> WheelForces:
        """Forces on a wheel that rolls.

        Args:
            sinkage: See `angles`.
            slip: See `angles`.

        Raises:
            InvalidInputError: a sinkage or slip out of its range.
        """
        entry, largest, leave = self.angles(sinkage, slip)
        parts = [(leave, largest), (largest, entry)]
        theta = np.concatenate([0.5 * (b - a) * _X + 0.5 * (a + b) for a, b in parts])
        weight = np.concatenate([0.5 * (b - a) * _W for a, b in parts])
        normal = self._normal(theta, entry, largest, leave)
        shear = self._shear(theta, normal, entry, slip)
        cos, sin = np.cos(theta), np.sin(theta)
        area = self.wheel.radius * self.wheel.width
        return WheelForces(
            load=area * float(weight @ (normal * cos + shear * sin)),
            drawbar_pull=area * float(weight @ (shear * cos - normal * sin)),
            torque=area * self.wheel.radius * float(weight @ shear),
        )

    def standing(self, sinkage: float) -> WheelForces:
        """Forces on a wheel that stands: Bekker's pressure alone, the same before and behind the hub."""
        entry, _, _ = self.angles(sinkage, 0.0)
        theta = 0.5 * entry * (_X + 1.0)
        normal = self._stiffness * (np.cos(theta) - np.cos(entry)) ** self.soil.n
        area = self.wheel.radius * self.wheel.width
        return WheelForces(area * entry * float(_W @ (normal * np.cos(theta))), 0.0, 0.0)

    def sinkage(self, load: float, slip: float) -> float:
        """Sinkage, m, with which a rolling wheel carries a load, N.

        Raises:
            InvalidInputError: a load that is negative or that the soil does not carry.
        """
        most = self.forces(self.wheel.radius, slip).load
        if not 0.0 <= load <= most:
            raise InvalidInputError(
                f'load = {load!r} N must be in [0, {most:.6g}] N, where the wheel sinks to its hub'
            )
        # Imported on demand: it takes long to load, and only the inverse needs it.
        brentq = import_module('scipy.optimize').brentq
        return float(
            brentq(lambda z: self.forces(z, slip).load - load, 0.0, self.wheel.radius, xtol=RESOLUTION)
        )

    def _normal(self, theta: Array, entry: float, largest: float, leave: float) -> Array:
        # Behind the largest stress, what stands at the angle before it that has the same part of the way.
        behind = (theta - leave) / max(largest - leave, np.finfo(float).tiny)
        front = np.where(theta < largest, entry - behind * (entry - largest), theta)
        depth = np.clip(np.cos(front) - np.cos(entry), 0.0, None)
        return np.asarray(self._stiffness * depth**self.soil.n)

    def _shear(self, theta: Array, normal: Array, entry: float, slip: float) -> Array:
        way = self.wheel.radius * (entry - theta - (1.0 - slip) * (np.sin(entry) - np.sin(theta)))
        strength = self.soil.cohesion + normal * np.tan(self.soil.friction)
        return np.asarray(np.sign(way) * strength * -np.expm1(-np.abs(way) / self.soil.shear_modulus))
