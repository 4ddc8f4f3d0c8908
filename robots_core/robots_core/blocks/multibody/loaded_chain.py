"""A robot's bodies with a payload on an inclined or accelerated base, for compiled code."""

from dataclasses import replace

import numpy as np

from robots_core.blocks.inverse_kinematics.chain_dynamics import ChainDynamics, chain_dynamics_of
from robots_core.blocks.multibody.base_motion import BaseMotion
from robots_core.blocks.multibody.payload import Payload, united
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import read_only


def loaded_chain(robot: BaseRobotModel, payload: Payload, base: BaseMotion) -> ChainDynamics:
    """The dynamics of a robot with its payload; rotation of the base is ignored.

    Raises:
        InvalidInputError: the robot's `rigid_dynamics` are not those of its bodies under gravity.
    """
    dynamics = chain_dynamics_of(robot)
    load = payload.seen_from(Pose(dynamics.chain.r, dynamics.chain.T))
    masses, centers, inertias = (np.array(a) for a in (dynamics.masses, dynamics.centers, dynamics.inertias))
    masses[-1], centers[-1], inertias[-1] = united(
        (masses[-1], centers[-1], inertias[-1]), (load.mass, load.center, load.inertia)
    )
    return replace(
        dynamics,
        masses=read_only(masses),
        centers=read_only(centers),
        inertias=read_only(inertias),
        gravity=read_only(base.free_fall(dynamics.gravity)),
    )
