"""Soil: parameters of soft soil under a wheel, and those of published soils."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import radians
from types import MappingProxyType
from typing import Final

from robots_core.errors import InvalidInputError
from robots_core.validation import positive

STEEPEST: Final = 1.5  # rad, of internal friction


@dataclass(frozen=True, kw_only=True)
class Soil:
    """Parameters of Bekker's pressure-sinkage, Wong and Reece's stress and Janosi and Hanamoto's shear.

    Attributes:
        k_c: Cohesive modulus of the pressure-sinkage relation, N/m^(n+1).
        k_phi: Its frictional modulus, N/m^(n+2).
        n: Its exponent.
        cohesion: Pa.
        friction: Angle of internal friction, rad.
        shear_modulus: Shear displacement K at 63 % of the strength, m.
        c1: Angle of the largest normal stress over the entry angle, without slip.
        c2: How much that ratio grows from slip 0 to 1.
        rear_ratio: Height of the soil behind the wheel, where it loses contact, over the sinkage; 0: the
            contact ends below the hub.

    Raises:
        InvalidInputError: a parameter out of its range.
    """

    k_c: float
    k_phi: float
    n: float
    cohesion: float
    friction: float
    shear_modulus: float
    c1: float
    c2: float
    rear_ratio: float = 0.0

    def __post_init__(self) -> None:
        for name, unit in (('k_phi', 'N/m^(n+2)'), ('n', ''), ('shear_modulus', 'm')):
            positive(getattr(self, name), name, unit)
        for name, high, unit in (
            ('k_c', float('inf'), ' N/m^(n+1)'),
            ('cohesion', float('inf'), ' Pa'),
            ('friction', STEEPEST, ' rad'),
            ('c1', 1.0, ''),
            ('c2', 1.0 - self.c1, ''),
            ('rear_ratio', 1.0, ''),
        ):
            value = getattr(self, name)
            if not 0.0 <= value <= high or value == float('inf'):
                bounds = 'at least 0' if high == float('inf') else f'in [0, {high:g}]'
                raise InvalidInputError(f'{name} = {value!r}{unit} must be a finite number {bounds}')


SOILS: Final[Mapping[str, Soil]] = MappingProxyType(
    {
        'regolith_simulant': Soil(
            k_c=1370.0,
            k_phi=8.14e5,
            n=1.0,
            cohesion=800.0,
            friction=radians(37.2),
            shear_modulus=0.036,
            c1=0.40,
            c2=0.15,
            rear_ratio=0.9,
        ),
        'dry_sand': Soil(
            k_c=990.0,
            k_phi=1528.43e3,
            n=1.1,
            cohesion=1040.0,
            friction=radians(28.0),
            shear_modulus=0.025,
            c1=0.18,
            c2=0.32,
        ),
    }
)
"""Published soils.

`regolith_simulant`: G. Ishigami, A. Miwa, K. Nagatani, K. Yoshida, Terramechanics-based model for steering
maneuver of planetary exploration rovers on loose soil, Journal of Field Robotics 24, 2007; for a wheel that
does not steer.
`dry_sand`: the sand of J. Y. Wong, Theory of Ground Vehicles, as in table 1 of L. Ding et al., 2015; c1 and
c2 of loose sand by J. Y. Wong and A. R. Reece, Journal of Terramechanics 4, 1967; K of loose sand.
The numbers were taken from public programs that quote these sources, not from the publications themselves.
"""
