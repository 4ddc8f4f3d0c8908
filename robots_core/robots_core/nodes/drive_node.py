"""drive_node: simulated drives that follow `joint_reference` and report `joint_states`."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from functools import partial
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import WrenchStamped
from std_msgs.msg import Bool
from trajectory_msgs.msg import JointTrajectory

from robots_core.blocks.drives.drive_choice import check_level, drive_train
from robots_core.blocks.drives.drive_faults import DriveFaults, FaultInjection, known_axes
from robots_core.blocks.drives.drive_levels import DRIVE_LEVELS
from robots_core.blocks.drives.supervised_drives import SupervisedDrives
from robots_core.blocks.multibody.payload import CarriedPayload, Payload
from robots_core.blocks.multibody.tool_wrench import joint_torques
from robots_core.defaults import RATE
from robots_core.nodes.shared_parameters import (
    carry_payload,
    payload_from_parameters,
    realtime_priority_parameter,
    resting_rate_parameter,
)
from robots_core.periodic.realtime import processor_share
from robots_core.periodic.resting_rate import RestingRate
from robots_core.periodic.watchdog import CHECKS
from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.managed_node import INACTIVE, ManagedNode
from robots_core.ros.messages import wrench_from_message
from robots_core.ros.peers.heartbeat import watchdog_parameter
from robots_core.ros.running.run import run
from robots_core.ros.streams.polled_subscription import Arrivals, PolledSubscription
from robots_core.ros.streams.serialized_readers import ReferenceReader
from robots_core.ros.streams.serialized_streams import JointStateStream
from robots_core.ros.timed_node import SELDOM
from robots_core.validation import Array

if TYPE_CHECKING:
    from robots_core.nodes.rendezvous_topics import RendezvousTopics

FAULTS = {
    'fault_stopped': 'axes whose drives do not follow any more',
    'fault_frozen': 'axes whose encoders report one position from now on',
    'fault_lost': 'axes that are missing in joint_states',
}
# Periods. With references that come as often, feedback is sent when they come and not in between.
PATIENCE: Final = 2


class DriveRest:
    """See `Rest`: periods without a message to take or to send are left out once the axes have settled.

    Args:
        supervised: The drives.
        resting: When their feedback is sent.
        arrivals: Of all that a step takes.
        period: Of the loop, s.
        watchdog: Of the references, s, which looks several times within that; 0 for none.
    """

    def __init__(
        self,
        supervised: SupervisedDrives,
        resting: RestingRate,
        arrivals: Arrivals,
        *,
        period: float,
        watchdog: float,
    ) -> None:
        self._supervised, self._resting, self.wait = supervised, resting, arrivals.wait
        self._most = max(0, int(watchdog / (CHECKS * period)) - 1) if watchdog else sys.maxsize

    def periods(self) -> int:
        """See `Rest`."""
        if not self._supervised.settled or not (ahead := self._resting.ahead):
            return 0
        return min(ahead + PATIENCE, self._most)

    def left_out(self, periods: int) -> None:
        """See `Rest`."""
        self._resting.pass_over(periods)


class DriveNode(ManagedNode):
    """The drives in the place of a real robot, stepped in real time, at the level of parameter `level`.

    `rigid_body` feels `measured_wrench` on the tool, and reports the torques of the motors, as effort. The
    parameters `fault_...` may be set at any time: axes that stop following, whose encoders freeze or that
    vanish from `joint_states`, and noise.
    """

    phase = Phase.DRIVES
    heartbeat_period = SELDOM

    def __init__(self, **options: Any) -> None:
        super().__init__('drive_node', **options)
        rate = self.parameter('rate', RATE, 'steps per second, Hz', bounds=(10.0, 2000.0))
        priority = realtime_priority_parameter(self)
        self._resting = resting_rate_parameter(self, 'joint_states', rate)
        level = self.parameter('level', 'second_order', f'one of {", ".join(DRIVE_LEVELS)}', read=check_level)
        bandwidth = self.parameter(
            'bandwidth',
            [15.0],
            'second_order: natural frequency of the drives, Hz; one number or one per axis',
            bounds=(0.01, 1000.0),
        )
        damping = self.parameter(
            'damping',
            [1.0],
            'second_order: damping ratio; one number or one per axis',
            bounds=(0.01, 100.0),
        )
        payload: Payload = payload_from_parameters(self)
        feed_forward = self.parameter(
            'feed_forward', True, 'rigid_body: torques for robot, payload and reference are fed forward'
        )
        start = self.parameter(
            'initial_position', [float('nan')], "joint positions at start, rad; the robot's home by default"
        )
        orbit = self.parameter('orbit', '', 'orbit in which the base floats (YAML); empty: it stands')
        axes = self.robot.axes_data
        q = self.robot.home if np.isnan(start).all() else axes.check_position(start, 'initial_position')
        self._period = 1.0 / rate
        self._drives = drive_train(
            level,
            self.robot,
            q,
            period=self._period,
            bandwidth=bandwidth,
            damping=damping,
            payload=payload,
            feed_forward=feed_forward,
            orbit=orbit,
        )
        self._carried = CarriedPayload(self._drives.load)
        self._settings = PolledSubscription(self, DiagnosticStatus, 'motion_settings')
        self._injection = FaultInjection(axes.names)
        self._declare_faults()
        watchdog = watchdog_parameter(self)
        lasting = self.simulated_time and self.participant is None  # a clock that runs away from its nodes
        self._supervised = SupervisedDrives(
            self._drives,
            axes,
            period=self._period,
            timeout=np.inf if lasting or watchdog == 0.0 else watchdog,
            **({} if self.simulated_time else {'processor_share': processor_share}),
        )
        pushed = self._drives.can_be_pushed
        self._wrenches = PolledSubscription(self, WrenchStamped, 'measured_wrench') if pushed else None
        self._powered = True
        self._figures = {'rate': rate, 'drives': level}
        bodies = self._drives.rendezvous
        self._bodies: RendezvousTopics | None = None
        if bodies is not None:  # imported on demand: only a base that floats needs it
            topics = import_module('robots_core.nodes.rendezvous_topics')
            self._bodies = topics.RendezvousTopics(self, bodies)
        self._power = PolledSubscription(self, Bool, 'drives_on')
        self._references = PolledSubscription(self, JointTrajectory, 'joint_reference', raw=True)
        self._reader = ReferenceReader(axes.names, 'joint_reference')
        self._rows: Array | None = None  # of the last valid reference
        self._reference = q, np.zeros_like(q)
        self._states = JointStateStream(self, 'joint_states')
        if self.simulated_time:  # the controller's first period needs to find the robot where it is
            self._report(q, np.zeros_like(q))
        self._loop = self.start_loop(
            self._step,
            period=self._period,
            name='drives',
            realtime_priority=priority,
            rest=self._rest(watchdog) if self._bodies is None else None,
        )
        self._report_problem()

    def _rest(self, watchdog: float) -> DriveRest:
        taken = (self._references, self._power, self._settings, self._wrenches)
        arrivals = Arrivals(self, [one for one in taken if one is not None])
        return DriveRest(self._supervised, self._resting, arrivals, period=self._period, watchdog=watchdog)

    def _declare_faults(self) -> None:
        check = partial(known_axes, self.robot.axes_data.names)
        for name, what in FAULTS.items():
            # An empty list has no type in ROS; an empty name is no axis.
            self.parameter(name, [''], f'for tests: {what}', read=check)
        self.parameter(
            'fault_noise',
            0.0,
            'for tests: standard deviation of the reported positions, rad',
            bounds=(0.0, np.pi),
        )
        self._use_faults()
        self.add_post_set_parameters_callback(lambda _: self._use_faults())

    def _use_faults(self) -> None:
        names, noise = self.robot.axes_data.names, self.get_parameter('fault_noise').value
        stopped, frozen, lost = (known_axes(names, self.get_parameter(name).value) for name in FAULTS)
        self._injection.faults = DriveFaults(stopped, frozen, lost, noise)

    def _carry(self) -> None:
        """Take over the payload that programs set, between two steps."""
        message = self._settings.take()
        if message is not None:
            with self.refusing('motion_settings'):
                carry_payload(self._carried, message)

    def _feel(self) -> None:
        """Load the drives with what presses on the tool."""
        message = None if self._wrenches is None else self._wrenches.take()
        if message is not None:
            with self.refusing('measured_wrench'):
                wrench = wrench_from_message(message)
                self._drives.push(joint_torques(self.robot, self._drives.position, wrench))

    def _step(self, now: float) -> None:
        self._carry()
        self._feel()
        references = [raw for raw, _ in self._references.take_all()]
        # After the reference: the controller switches the drives off before it sends one that stands still.
        power = self._power.take()
        if power is not None:
            self._powered = power.data
        self._supervised.power(on=self._powered and self.active)
        if self._bodies is not None:
            self._bodies.before_step()
        measured = self._supervised.follow(now, references, self._read, lambda: self._reader.lead)
        if self._resting.due(resting=self._supervised.standing, early=bool(references)):
            self._report(*measured)
        if self._bodies is not None:
            self._bodies.after_step()
        self._report_problem()

    @property
    def moving(self) -> bool:
        """The axes move, or are moved."""
        return not self._supervised.standing

    def _report_problem(self) -> None:
        self.report_problem(self._supervised.problem if self.active else INACTIVE, **self._figures)

    def _report(self, q: Array, q_dot: Array) -> None:
        q, q_dot, reporting = self._injection.feedback(q, q_dot)
        torque = self._drives.torque
        names: Sequence[str] = self.robot.axes_data.names
        values = [q, q_dot] if torque is None else [q, q_dot, torque]
        if len(reporting) != q.size:
            names, values = [names[i] for i in reporting], [one[reporting] for one in values]
        self._states.publish(names, values)

    def _read(self, raw: bytes) -> tuple[Array, Array, float] | None:
        """Position and velocity (n,) of a reference, as they reach the drives, and its stamp, s."""
        with self.refusing('joint_reference'):
            rows, stamp = self._reader.read(raw)
            if rows is not self._rows:
                self._reference = self.robot.axes_data.check_position(rows[0], 'joint_reference'), rows[1]
                self._rows = rows
            return *self._injection.reference(*self._reference), stamp
        return None


main: Final = partial(run, DriveNode)
