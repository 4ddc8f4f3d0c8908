"""StructuralData: the paper's free-form record of a robot's mechanical dimensions."""

from dataclasses import dataclass


@dataclass(frozen=True)
class StructuralData:
    """Base of a robot's own record of dimensions: lengths, offsets, masses.

    The paper prescribes no names here; a robot subclasses this with frozen fields and their units.
    `source` says where the figures come from and what is estimated.
    """

    source: str = ''
