"""The tool centre point, from poses in which the tool's tip touches one fixed point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from robots_core.errors import MeasurementError
from robots_core.pose import Pose
from robots_core.validation import Array, positive, read_only

FEWEST_POSES: Final = 4
LARGEST_RESIDUAL: Final = 1e-3  # m
LARGEST_GAIN: Final = 8.0
"""Largest error of the tool centre point for an error of 1 of each touch."""


@dataclass(frozen=True, eq=False)
class ToolCenter:
    """A measured tool centre point; arrays are read-only.

    Attributes:
        r: The point in tool0, (3,), m.
        touched: The fixed point in the base frame, (3,), m.
        residuals: Distance of the tip from the fixed point, by pose, (k,), m.
        std: Standard deviation of `r`, (3,), m, by the residuals; 0 where the touches agree.
    """

    r: Array
    touched: Array
    residuals: Array
    std: Array


def measure_tool_center(poses: Sequence[Pose], *, largest_residual: float = LARGEST_RESIDUAL) -> ToolCenter:
    """The tool centre point from k >= 4 poses of tool0 with the tip at one fixed point (4-point method).

    Least squares of r_i + T_i r = touched for all poses i.

    Args:
        poses: tool0 in the base frame; orientations differ about at least two axes.
        largest_residual: Largest distance of the tip from the fixed point that is accepted, m.

    Raises:
        MeasurementError: fewer poses; orientations that differ too little, names the direction that they
            leave undetermined; or a larger residual, names the pose (`index`, from 0) that fits the others
            least.
    """
    positive(largest_residual, 'largest_residual', 'm')
    if len(poses) < FEWEST_POSES:
        raise MeasurementError(
            f'{len(poses)} points; the tool centre point needs at least {FEWEST_POSES}, each with another '
            'orientation of the flange',
            key='few_points',
            count=len(poses),
            fewest=FEWEST_POSES,
        )
    r, T = np.array([pose.r for pose in poses]), np.array([pose.T for pose in poses])
    turned = T - T.mean(axis=0)
    information = np.einsum('kji,kjl->il', turned, turned)  # of r in tool0, for touches with an error of 1
    strength, directions = np.linalg.eigh(information)
    if strength[0] * LARGEST_GAIN**2 < 1.0:
        raise MeasurementError(
            f'the orientations of the points differ too little: along {_direction(directions[:, 0])} of '
            f'tool0 the tool centre point would have over {LARGEST_GAIN:g} times the error of a touch; turn '
            'the flange further between points, about axes across this one',
            key='turned_too_little',
            direction=_direction(directions[:, 0]),
        )
    center, touched = _fit(r, T)
    residuals = _distances(r, T, center, touched)
    rms = float(np.sqrt((residuals**2).sum() / (3 * len(poses) - 6)))
    if residuals.max() > largest_residual:
        worst = _least_fitting(r, T)
        raise MeasurementError(
            f'the points do not meet: the largest residual is {1e3 * residuals.max():.2f} mm, valid is at '
            f'most {1e3 * largest_residual:g} mm; point {worst + 1} fits the others least, touch it again',
            key='points_apart',
            index=worst,
            point=worst + 1,
            residual=float(residuals.max()),
            bound=largest_residual,
        )
    std = rms * np.sqrt(np.diag(np.linalg.inv(information)))
    return ToolCenter(read_only(center), read_only(touched), read_only(residuals), read_only(std))


def _fit(r: Array, T: Array) -> tuple[Array, Array]:
    count = len(r)
    A = np.concatenate([T, np.broadcast_to(-np.eye(3), (count, 3, 3))], axis=2).reshape(3 * count, 6)
    found = np.linalg.lstsq(A, -r.ravel())[0]
    return found[:3], found[3:]


def _distances(r: Array, T: Array, center: Array, touched: Array) -> Array:
    return np.asarray(np.linalg.norm(r + T @ center - touched, axis=1))


def _least_fitting(r: Array, T: Array) -> int:
    """Index of the pose without which the others agree best."""

    def disagreement(without: int) -> float:
        others = np.delete(r, without, axis=0), np.delete(T, without, axis=0)
        return float((_distances(*others, *_fit(*others)) ** 2).sum())

    return min(range(len(r)), key=disagreement)


def _direction(vector: Array) -> str:
    largest = vector[np.abs(vector).argmax()]
    return f'[{", ".join(f"{value:.2f}" for value in np.sign(largest) * vector + 0.0)}]'
