"""Effort limits of a robot whose maker published none, from its masses."""

from typing import Final

import numpy as np
import pinocchio as pin

from robots_core.robot_model.urdf.substitutions import Substitutions
from robots_core.robot_model.urdf.urdf_chain import SUBSTITUTE_EFFORT, UrdfChain, with_efforts
from robots_core.validation import Array

SAMPLES: Final = 200
RESERVE: Final = 1.5  # for payloads, of the largest torque that the robot itself needs
SMALLEST: Final = 1.0  # N m (N)


def with_known_efforts(chain: UrdfChain, model: pin.Model, substitutions: Substitutions) -> UrdfChain:
    """The chain with estimates in the place of efforts that are unknown.

    Args:
        chain: The chain.
        model: Its model.
        substitutions: Receives what is substituted.
    """
    unknown = np.array(chain.unknown_effort, dtype=bool)
    if not unknown.any():
        return chain
    names = ', '.join(np.array(chain.joints)[unknown])
    lacking = f'{names}: no effort limit above 0, as effort in <limit> or as max_effort in joint_limits.yaml'
    if sum(body.mass for body in list(model.inertias)[1:]) == 0.0:
        substitutions.add(
            lacking, f'{SUBSTITUTE_EFFORT:g} N m (N of axes that slide), as no masses are known'
        )
        return chain
    needed = np.maximum(RESERVE * _largest_torques(chain, model), SMALLEST)
    effort = np.where(unknown, needed, chain.axes_data.effort)
    figures = ', '.join(f'{value:.3g}' for value in effort[unknown])
    substitutions.add(
        lacking, f'{figures} N m (N of axes that slide), {RESERVE:g} times what the robot itself needs'
    )
    return with_efforts(chain, effort)


def _largest_torques(chain: UrdfChain, model: pin.Model) -> Array:
    """The largest torques of random samples at full speed and acceleration, (n,) N m (N)."""
    axes, data = chain.axes_data, model.createData()
    low, high = axes.one_turn
    random = np.random.default_rng(0)
    torques = [
        pin.rnea(model, data, q, velocity * axes.velocity, acceleration * axes.acceleration)
        for q, velocity, acceleration in zip(
            random.uniform(low, high, (SAMPLES, axes.num_axes)),
            random.choice((-1.0, 1.0), (SAMPLES, axes.num_axes)),
            random.choice((-1.0, 1.0), (SAMPLES, axes.num_axes)),
            strict=True,
        )
    ]
    return np.asarray(np.abs(torques).max(axis=0))
