"""What may change while nodes run, when, and in which operating mode: others keep the value of the start."""

from collections.abc import Mapping
from enum import StrEnum
from typing import Final

from robots_core.cell_interface.operating_modes import MODES, OperatingMode


class Change(StrEnum):
    """When a parameter may change."""

    ANYTIME = 'at any time'
    NEXT_MOTION = 'at any time; it holds for the motions that are commanded after it'
    NEXT_PROGRAM = 'at any time; it holds for the next program that is opened'
    STANDING = 'while the robot stands'


CHANGES: Final[Mapping[str, Mapping[str, Change]]] = {
    'planning_node': {
        **dict.fromkeys(('speed_fraction', 'acceleration_fraction'), Change.NEXT_MOTION),
        **dict.fromkeys(('cartesian_speed', 'cartesian_acceleration'), Change.NEXT_MOTION),
        **dict.fromkeys(('rotation_speed', 'rotation_acceleration'), Change.NEXT_MOTION),
        **dict.fromkeys(('jerk_limited', 'joint_planner', 'cartesian_planner'), Change.NEXT_MOTION),
        **dict.fromkeys(('configuration', 'hold', 'tool', 'base', 'payload'), Change.NEXT_MOTION),
        **dict.fromkeys(('avoid', 'avoid_budget', 'on_blocked', 'most_replans'), Change.NEXT_MOTION),
        **dict.fromkeys(('blend_zone', 'joint_blend_zone', 'new_command'), Change.NEXT_MOTION),
        **dict.fromkeys(('pendant.speed_fraction', 'pendant.acceleration_fraction'), Change.NEXT_MOTION),
        **dict.fromkeys(('pendant.cartesian_speed', 'pendant.rotation_speed'), Change.NEXT_MOTION),
        'collision_margin': Change.STANDING,
    },
    'controller_node': {'tool_speed_limit': Change.ANYTIME, 'operating_mode': Change.STANDING},
    'lua_program_node': {
        **dict.fromkeys(('program', 'points_file', 'frames_file'), Change.NEXT_PROGRAM),
        **dict.fromkeys(('breakpoints', 'step_mode', 'point'), Change.ANYTIME),
    },
    'direct_kinematics_node': {'tool': Change.ANYTIME},
    'robot_state_node': dict.fromkeys(('tool', 'work'), Change.ANYTIME),
    'dynamics_node': dict.fromkeys(('filter_time', 'base_orientation', 'payload'), Change.ANYTIME),
    'drive_node': dict.fromkeys(
        ('fault_stopped', 'fault_frozen', 'fault_lost', 'fault_noise'), Change.ANYTIME
    ),
}
"""By node and parameter. Programs change modal settings between motions that blend, while the robot moves."""

BESIDE_A_PERSON: Final[Mapping[str, Mapping[str, Change]]] = {
    'controller_node': {'tool_speed_limit': Change.STANDING},
}
"""What holds instead in the modes in which run is held: nothing becomes faster beside a person under way."""


def change_of(node: str, parameter: str, mode: OperatingMode | None) -> Change | None:
    """When a parameter may change.

    Args:
        node: Default name of its node.
        parameter: Its name.
        mode: The operating mode; None where no controller publishes one.

    Returns:
        None: never.
    """
    change = CHANGES.get(node, {}).get(parameter)
    if mode is None or not MODES[mode].held:
        return change
    return BESIDE_A_PERSON.get(node, {}).get(parameter, change)
