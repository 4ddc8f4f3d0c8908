"""robot_facts: figures of a robot by which it is chosen."""

from dataclasses import asdict, is_dataclass
from typing import Any, Final

import numpy as np

from robots_core.errors import NoAnalyticInverseKinematicsError
from robots_core.robot_model.base_robot_model import BaseRobotModel

TRIES: Final = 25
"""Positions of an axis that are tried for the greatest reach."""
ROUNDS: Final = 3


def robot_facts(robot: BaseRobotModel) -> dict[str, Any]:
    """Facts of a robot, in SI units and radians.

    Returns:
        name, number of axes, reach (m), rated payload (kg, None where not stated), closed_form (of the
        inverse kinematics), mass (kg), home, joints, dimensions, substitutions and source.
    """
    axes = robot.axes_data
    data = robot.structural_data
    stated = asdict(data) if is_dataclass(data) else {}
    source = stated.pop('source', '')
    quantities = ('lower', 'upper', 'velocity', 'acceleration', 'jerk', 'effort')
    return {
        'name': robot.name,
        'axes': axes.num_axes,
        'reach': reach(robot),
        'payload': stated.get('rated_payload_kg'),
        'closed_form': has_closed_form(robot),
        'mass': float(robot.rigid_dynamics_model.masses.sum()),
        'home': robot.home,
        'joints': [
            {
                'name': name,
                'prismatic': axes.prismatic[index],
                **{quantity: float(getattr(axes, quantity)[index]) for quantity in quantities},
            }
            for index, name in enumerate(axes.names)
        ],
        'dimensions': stated,
        'substitutions': list(robot.substitutions),
        'source': source,
    }


def reach(robot: BaseRobotModel) -> float:
    """Greatest distance of tool0 from the origin of the base, m; each axis is tried in turn, from home."""
    low, high = robot.axes_data.one_turn
    q = robot.home.copy()
    best = float(np.linalg.norm(robot.direct_kinematics(q)[0]))
    for _ in range(ROUNDS):
        for index in range(robot.num_axes):
            for value in np.linspace(low[index], high[index], TRIES):
                tried = q.copy()
                tried[index] = value
                distance = float(np.linalg.norm(robot.direct_kinematics(tried)[0]))
                if distance > best:
                    best, q = distance, tried
    return best


def has_closed_form(robot: BaseRobotModel) -> bool:
    """Whether the robot has all solutions of its inverse kinematics in closed form."""
    try:
        robot.inverse_kinematics_analytic(*robot.direct_kinematics(robot.home))
    except NoAnalyticInverseKinematicsError:
        return False
    return True
