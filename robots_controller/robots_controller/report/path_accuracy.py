"""Path accuracy: how far points are from a path of points."""

from __future__ import annotations

from typing import Final

import numpy as np
from scipy.spatial import cKDTree

from robots_core.validation import Array

NEIGHBOURS: Final = 3
"""Nearest points whose segments are looked at: where a path turns sharply the nearest alone may mislead."""


def distance_to_path(points: Array, path: Array) -> Array:
    """Distances (m,) of points (m, 3) to the nearest place of a path through points (k, 3), k >= 1.

    The path is straight between its points.
    """
    near = cKDTree(path).query(points, k=min(NEIGHBOURS, len(path)))[1].reshape(len(points), -1)
    best = np.linalg.norm(points - path[near[:, 0]], axis=1)
    if len(path) < 2:
        return np.asarray(best)
    for first in (near - 1, near):
        begin = np.clip(first, 0, len(path) - 2)
        chord = path[begin + 1] - path[begin]
        squared = np.maximum((chord**2).sum(axis=2), np.finfo(np.float64).tiny)
        along = np.clip(((points[:, None] - path[begin]) * chord).sum(axis=2) / squared, 0.0, 1.0)
        away = np.linalg.norm(points[:, None] - path[begin] - along[:, :, None] * chord, axis=2)
        best = np.minimum(best, away.min(axis=1))
    return np.asarray(best)
