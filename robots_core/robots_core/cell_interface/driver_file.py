"""Driver: how a robot's ROS driver is reached, from a YAML file."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final

from robots_core.files.yaml_section import YamlSection, read_yaml

TRAJECTORY: Final = '/joint_trajectory_controller/joint_trajectory'
JOINT_STATES: Final = '/joint_states'
LEAD: Final = 0.02  # s
LEADS: Final = (0.001, 0.5)  # s
ACTION_LEAD: Final = 0.1  # s
PERIOD: Final = 0.05  # s
PERIODS: Final = (0.01, 0.4)  # s
PERCENT: Final = 100.0
BASE_FRAME: Final = 'base'


@dataclass(frozen=True)
class DriverActionSettings:
    """The action FollowJointTrajectory of a driver.

    Attributes:
        name: Of the action.
        period: Time between goals, s.
    """

    name: str
    period: float = PERIOD


@dataclass(frozen=True)
class PrimitiveSettings:
    """The action ExecuteMotionPrimitiveSequence of a driver.

    Attributes:
        name: Of the action.
        frame: The robot's base, as the driver names it.
    """

    name: str
    frame: str = BASE_FRAME


@dataclass(frozen=True)
class Driver:
    """Topics of a driver of ros2_control.

    Attributes:
        trajectory: Of its `joint_trajectory_controller`; without effect where there is an action.
        joint_states: Of its `joint_state_broadcaster`.
        lead: Time in which the robot is to reach a reference, s: longer than messages take, and than a period
            of the driver, or between goals.
        speed_scaling: Part of the speed at which the robot executes trajectories; '' for none.
        full_speed: Value of that topic at full speed.
        running: `false` while the robot does not follow, after a stop of its own; '' for none.
        action: Where trajectories are sent to instead of the topic; None for the topic.
        primitives: Where motions of robot programs are sent to, for the robot's own controller to plan; None
            where the robot gets trajectories.
    """

    trajectory: str = TRAJECTORY
    joint_states: str = JOINT_STATES
    lead: float = LEAD
    speed_scaling: str = ''
    full_speed: float = PERCENT
    running: str = ''
    action: DriverActionSettings | None = None
    primitives: PrimitiveSettings | None = None


def read_driver(path: Path | str) -> Driver:
    """The driver of a YAML file; `docs/how_to/real_robots.md` describes the format.

    Raises:
        InvalidInputError: a file that is missing or describes no driver; names the file and the line.
    """
    section = read_yaml(path)
    primitives = _primitives(section)
    scaling = section.section('speed_scaling')
    action = _action(section)
    lead = section.number('lead', ACTION_LEAD if action else LEAD, low=LEADS[0], high=LEADS[1])
    if action is not None and lead <= action.period:
        raise section.error(
            f'lead is {lead:g} s, and must be above the period of the action, {action.period:g} s', 'lead'
        )
    driver = Driver(
        trajectory=_topic(section, 'trajectory', TRAJECTORY),
        joint_states=_topic(section, 'joint_states', JOINT_STATES),
        lead=lead,
        speed_scaling='' if scaling is None else _topic(scaling, 'topic'),
        full_speed=PERCENT if scaling is None else scaling.number('full', PERCENT, low=1e-3),
        running=_topic(section, 'running') if 'running' in section else '',
        action=action,
        primitives=primitives,
    )
    section.finish()
    return driver


def _action(section: YamlSection) -> DriverActionSettings | None:
    action = section.section('action')
    if action is None:
        return None
    if 'trajectory' in section:
        raise section.error('either the topic `trajectory` or the `action` is used, not both', 'trajectory')
    return DriverActionSettings(
        _topic(action, 'name'), action.number('period', PERIOD, low=PERIODS[0], high=PERIODS[1])
    )


def _primitives(section: YamlSection) -> PrimitiveSettings | None:
    primitives = section.section('primitives')
    if primitives is None:
        return None
    for key in ('trajectory', 'action', 'lead', 'speed_scaling'):
        if key in section:
            raise section.error(
                f'{key} is of drivers that take trajectories; with `primitives` it has no use', key
            )
    return PrimitiveSettings(_topic(primitives, 'name'), primitives.text('frame', BASE_FRAME))


def _topic(section: YamlSection, key: str, default: str | None = None) -> str:
    topic = section.text(key, default)
    if not topic.startswith('/') or topic.endswith('/') or ' ' in topic:
        raise section.error(f'{key} is {topic!r}, and must be a whole topic name such as {JOINT_STATES}', key)
    return topic
