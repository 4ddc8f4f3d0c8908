"""Quality of service of the suite's topics, in one table: nodes, bags and the documentation read it."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from robots_core.errors import InvalidInputError


@dataclass(frozen=True)
class Profile:
    """Quality of service, by name.

    Attributes:
        name: What code and documentation call it.
        what: What it means.
        depth: How many messages are kept.
        reliable: Every message arrives; otherwise nothing is sent again.
        latched: A subscriber that comes later gets the last messages.
    """

    name: str
    what: str
    depth: int = 1
    reliable: bool = True
    latched: bool = False


STATE: Final = Profile('STATE', 'late subscribers get the newest value', latched=True)
STREAM: Final = Profile('STREAM', 'the newest message alone, and the last is never missed')
SENSOR: Final = Profile(
    'SENSOR', 'the newest message alone; the next one replaces a lost one', reliable=False
)
REFERENCE: Final = Profile(
    'REFERENCE', 'the two newest messages; the next one replaces a lost one', depth=2, reliable=False
)
COMMAND: Final = Profile('COMMAND', 'every message, and none from before', depth=100)
EVENTS: Final = Profile('EVENTS', "every message: rclpy's profile of changed parameters", depth=1000)
LOG: Final = Profile(
    'LOG', "every message, also from before: rclpy's profile of logs", depth=1000, latched=True
)

PROFILES: Final = (STATE, STREAM, SENSOR, REFERENCE, COMMAND, EVENTS, LOG)


@dataclass(frozen=True)
class TopicQos:
    """Quality of service of one topic.

    A latched value only reaches a latched subscription, which does not match a publisher that latches nothing
    (most PLC bridges). Where anyone may publish a state there are therefore two subscriptions: the callback
    may get a message twice.

    Attributes:
        published: Of its publishers in the suite.
        subscribed: Of the subscriptions that a subscriber has at once.
        polled: Of the subscription of a loop that takes the newest message itself.
        unacknowledged: Publishers that are not reliable are received too, by one more subscription that is
            made when there is one.
    """

    published: Profile
    subscribed: tuple[Profile, ...]
    polled: Profile
    unacknowledged: bool = False

    @property
    def text(self) -> str:
        """As the documentation has it: the publisher's profile, and the subscribers' where they differ."""
        subscribed = ' and '.join(one.name for one in self.subscribed)
        subscribed += ', also best-effort' if self.unacknowledged else ''
        polled = '' if self.polled in self.subscribed else f'; polled {self.polled.name}'
        if subscribed + polled == self.published.name:
            return subscribed
        return f'{self.published.name} → {subscribed}{polled}'


def _one(profile: Profile) -> TopicQos:
    return TopicQos(profile, (profile,), profile)


_MEASURED: Final = TopicQos(STATE, (SENSOR,), SENSOR)
_STATE_OF_ANYONE: Final = TopicQos(STATE, (STREAM, STATE), STATE)
_REFERENCE_OF_ANYONE: Final = TopicQos(COMMAND, (SENSOR,), SENSOR)

_OWN_STATES: Final = (
    'robot_description',
    'tf_static',
    'motion_settings',
    'command_state',
    'guide',
    'stop_status',
    'commander',
    'operating_mode',
    'run_enabled',
    'drives_on',
    'zone_claims',
    'finished',
    'collision_status',
    'min_distance',
    'tcp_pose',
    'joint_torques',
    'bias_torques',
    'mass_matrix',
    'tcp_wrench',
    'base_wrench',
    'base_pose',
    'target_pose',
    'momentum',
    'grasp_status',
    'digital_outputs',
    'analog_outputs',
    'forced_inputs',
    'plc_status',
    'program_status',
)
_STATES_OF_ANYONE: Final = (
    'override',
    'speed_scaling',
    'robot_running',
    'emergency_stop',
    'contact_status',
    'ghost',
    'base_motion',
    'digital_inputs',
    'analog_inputs',
)
_COMMANDS: Final = (
    'joint_trajectory',
    'motion_plan',
    'motion_result',
    'hold_to_run',
    'trigger',
    'diagnostics',
    'tf',
)

_ROWS: Final[dict[str, TopicQos]] = {
    **dict.fromkeys(_OWN_STATES, _one(STATE)),
    **dict.fromkeys(_STATES_OF_ANYONE, _STATE_OF_ANYONE),
    **dict.fromkeys(_COMMANDS, _one(COMMAND)),
    # Drivers that send sensor data unacknowledged are received too. The next reference comes before a lost
    # one could be sent again, so its publisher need not ask again and again what has arrived.
    **dict.fromkeys(('joint_states', 'measured_wrench'), _MEASURED),
    # Of the first reference of a motion and the last one before it none is overwritten.
    'joint_reference': TopicQos(STATE, (SENSOR,), REFERENCE),
    'motion_progress': TopicQos(STATE, (STREAM,), STREAM),
    **dict.fromkeys(('teach_twist', 'teach_joints'), _one(STREAM)),
    # A trigger needs the pose that was sent last, perhaps once.
    'reference_pose': TopicQos(COMMAND, (STREAM,), SENSOR, unacknowledged=True),
    **dict.fromkeys(('reference_twist', 'joy', 'vehicle_imu'), _REFERENCE_OF_ANYONE),
    # COMMAND loses none of several objects that are sent one by one; STATE receives what is latched.
    'collision_objects': TopicQos(COMMAND, (COMMAND, STATE), STATE, unacknowledged=True),
    'heartbeat': _one(SENSOR),
    'parameter_events': _one(EVENTS),
    'rosout': TopicQos(LOG, (COMMAND,), COMMAND),
}
TOPIC_QOS: Final[Mapping[str, TopicQos]] = MappingProxyType(_ROWS)
"""By the last part of a topic's name."""


def add_commands(topics: Iterable[str]) -> None:
    """Add rows for topics of commands: for a table of another package that has more of them."""
    _ROWS.update(dict.fromkeys(topics, _one(COMMAND)))


def topic_qos(topic: str) -> TopicQos:
    """The quality of service of a topic of the suite, with or without namespace.

    Raises:
        InvalidInputError: it is none of the suite.
    """
    qos = TOPIC_QOS.get(topic.rpartition('/')[2])
    if qos is None:
        raise InvalidInputError(f'{topic} has no row in robots_core/cell_interface/topic_qos.py')
    return qos
