"""RecordedRun: a recorded program run as arrays on one time axis."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np

from robots_controller.io.io_image import IMAGES
from robots_controller.recording.bag_file import read_bag
from robots_controller.recording.joint_rows import JointRows, joint_rows, late_references, recorded_robot
from robots_controller.recording.motion_record import (
    MOTION_TOPICS,
    Messages,
    MotionRecord,
    recorded_motions,
    status_values,
)
from robots_core.errors import BagError
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, read_only

IO_TOPICS: Final = (*(f'lua_program_node/{image}' for image in IMAGES), *IMAGES)
IO_KINDS: Final = tuple(image.removesuffix('s') for image in IMAGES)
ENDED: Final = ('FINISHED', 'FAILED', 'STOPPED')
UNKNOWN_STATE: Final = 'unknown'
PARAMETERS: Final = '/parameter_events'
NANOSECONDS: Final = 1e-9  # s


@dataclass(frozen=True, eq=False)
class IoChannel:
    """A channel that changed, or that is not 0.

    Attributes:
        name: As everywhere: digital_input.1.
        time: When it got its values, (k,) s, the first at 0 or before.
        value: (k,); each holds until the next.
        label: Its own name, '' for none.
    """

    name: str
    time: Array
    value: Array
    label: str = ''


def io_channels(messages: Messages, labels: Mapping[str, str], end: float) -> tuple[IoChannel, ...]:
    """The channels of a bag with their own names, until the end of the run, s."""
    channels: list[IoChannel] = []
    for image in IMAGES:
        # The inputs as the program saw them, forced ones too; as they came from outside in older bags.
        rows = messages.get(f'lua_program_node/{image}') or messages.get(image) or ()
        if not rows:
            continue
        size = max(len(message.data) for _, message in rows)
        values = np.zeros((len(rows), size))
        for row, (_, message) in enumerate(rows):
            values[row, : len(message.data)] = message.data
        time = np.array([time for time, _ in rows])
        keep = time <= end
        for index in range(size):
            channel = _channel(image, index, time[keep], values[keep, index], labels)
            if channel is not None:
                channels.append(channel)
    return tuple(channels)


def _channel(
    image: str, index: int, time: Array, values: Array, labels: Mapping[str, str]
) -> IoChannel | None:
    if not values.any():
        return None
    if time[0] > 0.0:  # before the first message nothing was on
        time, values = np.concatenate([[0.0], time]), np.concatenate([[0.0], values])
    changed = np.concatenate([[True], np.diff(values) != 0.0])
    time, values = time[changed], values[changed]
    name = f'{image.removesuffix("s")}.{index + 1}'
    return IoChannel(name, read_only(time), read_only(values), labels.get(name, ''))


@dataclass(frozen=True)
class ProgramPoint:
    """Where the program was from a time on.

    Attributes:
        time: s.
        state: RUNNING, PAUSED, FINISHED ...
        file: The program or subprogram.
        line: From 1; 0 for none.
        source: The line's text.
    """

    time: float
    state: str
    file: str
    line: int
    source: str


@dataclass(frozen=True, eq=False)
class RecordedRun:
    """A run on one time axis, which begins with the program and ends when it and the robot have ended.

    Attributes:
        source: Where it comes from, for a person.
        robot: The robot.
        time: Instants of the references, (m,) s, increasing.
        period: Of the references, s.
        late: How much later each reference of a moving robot came than it should, (m,) s.
        reference: Position, velocity and acceleration of the references, (m, n) each.
        feedback: Position and velocity of the drives at these instants, (m, n) each.
        effort: Torques of the drives, (m, n) N m (N); None where they report none.
        motions: In order.
        program: Where the program was, by time.
        io: The channels in the bag.
        distance: (time, smallest distance in m), (k, 2), of `collision_node`; empty if it did not run.
        duration: Of the program, s.
        program_state: How it ended.
        program_error: Why it failed, or ''.
        problem: What is wrong with the bag, or ''.
    """

    source: str
    robot: BaseRobotModel
    time: Array
    period: float
    late: Array
    reference: tuple[Array, Array, Array]
    feedback: tuple[Array, Array]
    effort: Array | None
    motions: tuple[MotionRecord, ...]
    program: tuple[ProgramPoint, ...]
    io: tuple[IoChannel, ...]
    distance: Array
    duration: float
    program_state: str = UNKNOWN_STATE
    program_error: str = ''
    problem: str = field(default='')

    @property
    def finished(self) -> bool:
        """The program came to its end."""
        return self.program_state == 'FINISHED'

    @property
    def program_name(self) -> str:
        """File of the program; '' if none ran."""
        return next((point.file for point in self.program if point.file), '')

    def window(self, start: float, end: float) -> slice:
        """The samples of a span of time, s; at least one."""
        first = min(int(np.searchsorted(self.time, start)), self.time.size - 1)
        return slice(first, max(int(np.searchsorted(self.time, end, side='right')), first + 1))


def read_run(bag: Path | str, *, robot: str = '', namespace: str = '/', source: str = '') -> RecordedRun:
    """Read a run from a bag, live or simulated; as of `run_report`.

    Raises:
        RobotsError: not a readable bag, no references in it, or an unknown robot.
    """
    recorded = read_bag(bag)
    prefix = namespace.rstrip('/') + '/'
    topics = ('min_distance', *IO_TOPICS, *MOTION_TOPICS)
    found = recorded.deserialized([*(prefix + topic for topic in topics), PARAMETERS])
    parameters = [message for _, message in found[PARAMETERS]]
    if f'{prefix}joint_states' not in {topic for topic, _, _ in recorded.messages}:
        there = ', '.join(sorted(recorded.topics)) or 'nothing'
        raise BagError(f'{bag} holds no {prefix}joint_states; a report needs them. It holds {there}')
    model = recorded_robot(recorded, prefix, robot)
    references, states = (
        joint_rows(recorded, prefix + topic, model) for topic in ('joint_reference', 'joint_states')
    )
    problem = recorded.problem
    if not references.sent.size:
        references = _references_of(states)
        problem = problem or 'it holds no joint_reference; references are computed from the feedback'
    origin = _program_start(found[f'{prefix}program_status'], int(references.sent[0]))
    messages = {
        topic: [(NANOSECONDS * (stamp - origin), message) for stamp, message in found[prefix + topic]]
        for topic in topics
    }
    program = _program(messages['program_status'])
    motions = recorded_motions(messages, model)
    time, late, reference = _references(references, origin)
    ends = (point.time for point in program if point.state in ENDED)
    end = next(ends, max(float(time[-1]), 0.0))
    # A program that fails may end before the motion under way.
    rest = max([end, *(motion.end for motion in motions if motion.moved)])
    inside = (time >= 0.0) & (time <= rest)
    if not inside.any():  # a program that fails at once: where the robot stood then
        inside[np.argmin(np.abs(time))] = True
    time = read_only(time[inside])
    position, velocity, acceleration = (read_only(values[inside]) for values in reference)
    q, q_dot, effort = _feedback(states, origin, time)
    last = status_values(messages['program_status'][-1][1]) if messages['program_status'] else {}
    return RecordedRun(
        source=source or str(bag),
        robot=model,
        time=time,
        period=references.period,
        late=read_only(late[inside]),
        reference=(position, velocity, acceleration),
        feedback=(q, q_dot),
        effort=effort,
        motions=motions,
        program=program,
        io=io_channels(messages, _channel_labels(parameters), float(end)),
        distance=read_only(np.array([(t, m.data) for t, m in messages['min_distance']]).reshape(-1, 2)),
        duration=float(end),
        program_state=last.get('state', UNKNOWN_STATE),
        program_error=last.get('error', ''),
        problem=problem,
    )


def _channel_labels(events: Sequence[Any]) -> dict[str, str]:
    """Names of channels, from the parameters of lua_program_node where the bag has them."""
    labels: dict[str, str] = {}
    for event in events:
        for parameter in (*event.new_parameters, *event.changed_parameters):
            image = parameter.name.removesuffix('_names')
            if event.node.endswith('/lua_program_node') and image in IO_KINDS:
                names = enumerate(parameter.value.string_array_value, 1)
                labels |= {f'{image}.{index}': str(label) for index, label in names}
    return labels


def _program_start(statuses: Sequence[tuple[int, Any]], first_reference: int) -> int:
    running = (stamp for stamp, status in statuses if status_values(status).get('state') == 'RUNNING')
    return next(running, first_reference)


def _program(statuses: Sequence[tuple[float, Any]]) -> tuple[ProgramPoint, ...]:
    since_start = ((time, status_values(status)) for time, status in statuses if time >= 0.0)
    return tuple(
        ProgramPoint(
            time,
            values.get('state', UNKNOWN_STATE),
            values.get('file', ''),
            int(values.get('line') or 0),
            values.get('source', '').strip(),
        )
        for time, values in since_start
    )


def _references(rows: JointRows, origin: int) -> tuple[Array, Array, tuple[Array, Array, Array]]:
    time = _due(rows, origin)
    keep = np.concatenate([[True], np.diff(np.maximum.accumulate(time)) > 0.0])
    position, velocity, acceleration = rows.values
    if position is None or velocity is None or acceleration is None:
        raise BagError('joint_reference lacks positions, velocities or accelerations; a report needs them')
    return time[keep], late_references(rows)[keep], (position[keep], velocity[keep], acceleration[keep])


def _references_of(states: JointRows) -> JointRows:
    """The motion that was measured, where a robot's own controller records no references."""
    keep = np.concatenate([[True], np.diff(np.maximum.accumulate(states.stamp)) > 0])
    stamp, (position, velocity, _) = states.stamp[keep], states.values
    if position is None:
        raise BagError('joint_states lack positions; a report needs them')
    time = NANOSECONDS * (stamp - stamp[0])
    velocity = _derivative(position[keep], time) if velocity is None else velocity[keep]
    period = float(np.median(np.diff(time))) if time.size > 1 else NANOSECONDS
    rows = position[keep], velocity, _derivative(velocity, time)
    return JointRows(states.sent[keep], stamp, rows, period)


def _derivative(values: Array, time: Array) -> Array:
    return np.gradient(values, time, axis=0) if time.size > 1 else np.zeros_like(values)


def _feedback(rows: JointRows, origin: int, time: Array) -> tuple[Array, Array, Array | None]:
    at = _due(rows, origin)
    order = np.argsort(at, kind='stable')

    def on_grid(values: Array | None) -> Array | None:
        if values is None:
            return None
        columns = [np.interp(time, at[order], column) for column in values[order].T]
        return read_only(np.stack(columns, axis=1))

    q, q_dot, effort = map(on_grid, rows.values)
    if q is None:
        raise BagError('joint_states lack positions; a report needs them')
    if q_dot is None:
        q_dot = read_only(_derivative(q, time))
    return q, q_dot, effort


def _due(rows: JointRows, origin: int) -> Array:
    """When samples were due, (k,) s; when they were sent if their stamps are of another clock."""
    sent, due = (NANOSECONDS * (times - origin) for times in (rows.sent, rows.stamp))
    return np.where(np.abs(due - sent) < 1.0, due, sent)
