"""Effort limits of a robot whose maker published none, or none that carries it, from its masses."""

from dataclasses import replace
from typing import Final

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robots_core.robot_model.urdf.substitutions import Substitutions
from robots_core.robot_model.urdf.urdf_chain import SUBSTITUTE_EFFORT, UrdfChain
from robots_core.validation import Array

SAMPLES: Final = 200
RESERVE: Final = 1.5  # for payloads, of the largest torque that the robot itself needs
SMALLEST: Final = 1.0  # N m (N)


def with_known_efforts(chain: UrdfChain, model: pin.Model, substitutions: Substitutions) -> UrdfChain:
    """The chain with estimates in the place of efforts that are unknown, or too small to carry the robot."""
    unknown = np.array(chain.unknown_effort, dtype=bool)
    lacking = 'no effort limit above 0, as effort in <limit> or as max_effort in joint_limits.yaml'
    if sum(body.mass for body in list(model.inertias)[1:]) == 0.0:
        if unknown.any():
            substitutions.add(
                f'{_names(chain, unknown)}: {lacking}',
                f'{SUBSTITUTE_EFFORT:g} N m (N of axes that slide), as no masses are known',
            )
        return chain
    effort = chain.axes_data.effort
    weight = _largest_torques(chain, model, moving=0.0)
    weak = ~unknown & (effort < weight)
    if not (unknown | weak).any():
        return chain
    needed = np.maximum(RESERVE * _largest_torques(chain, model), SMALLEST)
    effort = np.where(unknown | weak, needed, effort)
    carry = (
        f'an effort limit of {_figures(chain.axes_data.effort[weak])} does not carry the robot itself, whose '
        f'weight needs {_figures(weight[weak])} N m (N)'
    )
    for which, what in ((unknown, lacking), (weak, carry)):
        if which.any():
            substitutions.add(
                f'{_names(chain, which)}: {what}',
                f'{_figures(effort[which])} N m (N of axes that slide), {RESERVE:g} times what the robot '
                'itself needs',
            )
    return replace(chain, axes_data=replace(chain.axes_data, effort=effort))


def _names(chain: UrdfChain, which: NDArray[np.bool_]) -> str:
    return ', '.join(np.array(chain.axes_data.names)[which])


def _figures(values: Array) -> str:
    return ', '.join(f'{value:.3g}' for value in values)


def _largest_torques(chain: UrdfChain, model: pin.Model, *, moving: float = 1.0) -> Array:
    """The largest torques of random samples at this part of speed and acceleration, (n,) N m (N)."""
    axes, data = chain.axes_data, model.createData()
    low, high = axes.one_turn
    random = np.random.default_rng(0)
    torques = [
        pin.rnea(model, data, q, moving * velocity * axes.velocity, moving * acceleration * axes.acceleration)
        for q, velocity, acceleration in zip(
            random.uniform(low, high, (SAMPLES, axes.num_axes)),
            random.choice((-1.0, 1.0), (SAMPLES, axes.num_axes)),
            random.choice((-1.0, 1.0), (SAMPLES, axes.num_axes)),
            strict=True,
        )
    ]
    return np.asarray(np.abs(torques).max(axis=0))
