"""mujoco_model: any robot of the suite as a MuJoCo model, from its rigid-body model."""

import mujoco
import numpy as np

from robots_core.errors import InvalidInputError
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array


def mujoco_model(robot: BaseRobotModel, *, timestep: float) -> mujoco.MjModel:
    """Bodies, joints and torque motors of a robot; without shapes, so that nothing touches.

    Its joints have the rotors, friction and effort limits of the robot's `axes_data`, and are in its order.

    Args:
        robot: The robot; each of its bodies has a mass.
        timestep: Of MuJoCo, s.

    Raises:
        InvalidInputError: a body without mass, or with inertias that no body can have.
    """
    spec = mujoco.MjSpec()
    spec.option.timestep = timestep
    dynamics, axes = robot.rigid_dynamics_model, robot.axes_data
    spec.option.gravity = dynamics.gravity
    zero = np.zeros(robot.num_axes)
    origins, frames = robot.kinematic_model.frame_axes(zero)
    directions = np.split(robot.jacobian(zero), 2)  # of axes that slide, and of those that turn
    parent, r_parent, T_parent = spec.worldbody, np.zeros(3), np.eye(3)
    for i, name in enumerate(axes.names):
        r, T = origins[i], frames[i]
        body = parent.add_body(
            name=f'body_{name}',
            pos=T_parent.T @ (r - r_parent),
            quat=_quaternion(T_parent.T @ T),
            mass=dynamics.masses[i + 1],
            ipos=dynamics.centers_of_mass[i + 1],
            fullinertia=dynamics.inertias[i + 1][[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]],
            explicitinertial=True,
        )
        slides = axes.prismatic[i]
        body.add_joint(
            name=name,
            type=mujoco.mjtJoint.mjJNT_SLIDE if slides else mujoco.mjtJoint.mjJNT_HINGE,
            axis=T.T @ directions[0 if slides else 1][:, i],
            armature=axes.reflected_inertia[i],
            damping=axes.viscous_friction[i],
            frictionloss=axes.coulomb_friction[i],
        )
        motor = spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        motor.set_to_motor()
        motor.ctrllimited, motor.ctrlrange = True, (-axes.effort[i], axes.effort[i])
        parent, r_parent, T_parent = body, r, T
    try:
        return spec.compile()
    except ValueError as error:
        raise InvalidInputError(f'MuJoCo does not take {robot.name}: {error}') from error


def _quaternion(T: Array) -> Array:
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, T.flatten())
    return quaternion
