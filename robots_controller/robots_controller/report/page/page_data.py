"""PageArrays: the numbers of a page, small, and exact enough for the eye."""

import base64
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike

TYPES: Final[dict[str, np.dtype[Any]]] = {
    'f4': np.dtype('<f4'),
    'i1': np.dtype('<i1'),
    'u2': np.dtype('<u2'),
    'u4': np.dtype('<u4'),
}

STEPS: Final = 65_535  # between the lowest and the highest value of a curve: finer than a screen shows


class PageArrays:
    """Collects arrays; each is referred to by its number."""

    def __init__(self) -> None:
        self.items: list[dict[str, str]] = []
        """All arrays: type and little-endian bytes in base64."""
        self._known: dict[tuple[str, bytes], int] = {}

    def add(self, values: ArrayLike, kind: str = 'f4') -> int:
        """Number of an array; one that is known already is not stored twice."""
        data = np.ascontiguousarray(values, dtype=TYPES[kind]).tobytes()
        key = kind, data
        if key not in self._known:
            self._known[key] = len(self.items)
            self.items.append({'type': kind, 'data': base64.b64encode(data).decode()})
        return self._known[key]


def series(
    arrays: PageArrays,
    name: str,
    time: ArrayLike,
    values: ArrayLike,
    colour: str,
    *,
    show: tuple[float, float, str] = (1.0, 0.0, ''),
) -> dict[str, Any]:
    """A curve of a panel.

    Args:
        arrays: Where its numbers go.
        name: For the legend.
        time: (m,) s.
        values: (m,).
        colour: CSS.
        show: Scale, offset and unit of the number that the legend shows at the cursor.
    """
    scale, offset, unit = show
    curve = np.asarray(values, dtype=np.float64)
    low, high = (float(curve.min()), float(curve.max())) if curve.size else (0.0, 0.0)
    packed = np.round((curve - low) * (STEPS / (high - low) if high > low else 0.0))
    return {
        'name': name,
        't': arrays.add(time),
        'y': arrays.add(packed, 'u2'),
        'low': low,
        'high': high,
        'colour': colour,
        'show': {'scale': scale, 'offset': offset, 'unit': unit},
    }
