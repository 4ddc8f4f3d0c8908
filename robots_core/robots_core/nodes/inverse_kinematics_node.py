"""inverse_kinematics_node: a reference pose in, a stream of joint references to the controller out."""

import gc
import math
import sys
import time
from collections import deque
from functools import partial
from typing import Any, Final

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseStamped, TwistStamped
from trajectory_msgs.msg import JointTrajectory

from robots_core.blocks.following.following_methods import LARGEST_DEVIATION, METHODS, RATE
from robots_core.blocks.following.realtime_movement import RealtimeMovement, RealtimeStep
from robots_core.blocks.following.sample_times import SampleTimes
from robots_core.blocks.following.sensor_guidance import SensorGuidance
from robots_core.blocks.inverse_kinematics.hold import check_hold
from robots_core.blocks.multibody.payload import CarriedPayload
from robots_core.cell_interface.operating_modes import sensor_guides
from robots_core.errors import RobotsError
from robots_core.nodes.shared_parameters import (
    NO_TOOL,
    carry_payload,
    pose_from_parameter,
    realtime_priority_parameter,
)
from robots_core.ros.joint_trajectories import single_point
from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.messages import nanoseconds, pose_in_base, twist_in_base
from robots_core.ros.peers.commander_watch import CommanderWatch
from robots_core.ros.qos import subscribe
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.running.run import run
from robots_core.ros.streams.polled_subscription import PolledSubscription
from robots_core.ros.streams.serialized_streams import ReferenceStream
from robots_core.validation import Array

REPORT_PERIOD = 0.1  # s
REFUSAL_SHOWN = 1.0  # s
SWITCH_INTERVAL = 1e-4  # s, as the controller's


class InverseKinematicsNode(RobotNode):
    """Follows `reference_pose` and publishes one-point `joint_trajectory` messages at its own rate.

    For sensor-guided motion: references may come at any rate and may jump; the robot follows inside its
    limits, of torques with the payload of `motion_settings`. Their stamps say when they were valid.
    `reference_twist` beside fresh poses says how they move; alone it is followed itself (servoing). When
    neither comes for `timeout` the robot brakes to a stop. Where `guide` is published, only while it is
    SENSOR, or while SENSOR is the commander.
    """

    diagnostics_group = 'motion'
    phase = Phase.GUIDANCE

    def __init__(self, **options: Any) -> None:
        super().__init__('inverse_kinematics_node', **options)
        method = self.parameter('method', METHODS[0], f'one of {", ".join(METHODS)}')
        hold = self.parameter(
            'hold', '', "one of pose, directions, position; '' for what the arm can", read=check_hold
        )
        rate = self.parameter('rate', RATE, 'joint references per second, Hz', bounds=(10.0, 1000.0))
        timeout = self.parameter(
            'timeout', 0.2, 'a reference older than this is stale, s', bounds=(0.01, 10.0)
        )
        tool = self.parameter(
            'tool', NO_TOOL, 'tool in tool0: x y z (m), quaternion x y z w', read=pose_from_parameter
        )
        largest_deviation = self.parameter(
            'largest_deviation',
            LARGEST_DEVIATION,
            "largest distance of the controller's reference to the one sent, rad",
            bounds=(1e-4, 3.0),
        )
        priority = realtime_priority_parameter(self, 40)
        self._method, self._dt = method, 1.0 / rate
        self._times = SampleTimes(timeout)
        movement = RealtimeMovement(
            self.robot, self._dt, self.robot.home, tool=tool, method=method, hold=hold, timeout=timeout
        )
        self._guidance = SensorGuidance(
            movement,
            reference=self._controller_reference,
            refused=self.refuse,
            largest_deviation=largest_deviation,
        )
        self._names = list(self.robot.axes_data.names)
        self._controller_state: Array | None = None
        self._last: RealtimeStep | None = None
        self._durations: deque[float] = deque(maxlen=round(10.0 * rate))
        self._refusal, self._refusal_time = '', -math.inf

        self._poses = PolledSubscription(self, PoseStamped, 'reference_pose')
        self._twists = PolledSubscription(self, TwistStamped, 'reference_twist')
        self._controller = PolledSubscription(self, JointTrajectory, 'joint_reference')
        carried = CarriedPayload(movement.load)
        subscribe(self, DiagnosticStatus, 'motion_settings', partial(carry_payload, carried))
        self.commanders = CommanderWatch(self)
        self._stream = ReferenceStream(self, 'joint_trajectory', self._names, time_from_start=self._dt)
        self.create_timer(REPORT_PERIOD, self._report, phase=Phase.OBSERVE)
        sys.setswitchinterval(SWITCH_INTERVAL)
        gc.freeze()
        self._received = False
        if self.participant is not None:
            for message_type, topic in ((PoseStamped, 'reference_pose'), (TwistStamped, 'reference_twist')):
                subscribe(self, message_type, topic, self._on_reference)
        self._loop = self.start_loop(
            self._step,
            period=self._dt,
            name='inverse kinematics',
            realtime_priority=priority,
            next_time=self._next_time,
        )

    # -- lock-step -----------------------------------------------------------------------------------

    def _on_reference(self, _message: object) -> None:
        self._received = True

    def _next_time(self) -> float:
        """When there is something to do, s; turns of the loop before it are left out."""
        now = self.now()
        return math.inf if not self._received and self._guidance.idle(now) else now

    # -- the loop's thread ---------------------------------------------------------------------------

    def _step(self, now: float) -> None:
        self._received = False
        watch = self.commanders
        guides = sensor_guides(commander=watch.commander, mode=watch.mode, guide=watch.guide)
        self._guidance.hand_over(handed_over=guides)
        self._take_references(now)
        start = time.thread_time()
        step = self._guidance.step(now)
        if step is not None:
            self._last = step
            self._stream.publish(np.array([step.q, step.q_dot, step.q_ddot]), now)
            self._durations.append(time.thread_time() - start)

    def _take_references(self, now: float) -> None:
        base_link = self.robot.base_link
        for message, _ in self._poses.take_all():
            with self.refusing('reference_pose'):
                pose = pose_in_base(message.header.frame_id, message.pose, base_link)
                self._guidance.put(pose, self._valid_at(message, now))
        for message, _ in self._twists.take_all():
            with self.refusing('reference_twist'):
                twist = twist_in_base(message, base_link)
                self._guidance.put_twist(twist, self._valid_at(message, now))

    def _valid_at(self, message: Any, now: float) -> float:
        """When a message was valid, s on the loop's clock; one without a stamp is valid now."""
        stamp = message.header.stamp
        if not stamp.sec and not stamp.nanosec:
            return now
        return self._times.valid_at(now, self.get_clock().now().nanoseconds - nanoseconds(stamp))

    def _controller_reference(self) -> Array | None:
        """The newest valid `joint_reference`, (3, n)."""
        message = self._controller.take()
        if message is not None:
            with self.refusing('joint_reference'):
                rows = single_point(message, self._names, 'joint_reference')
                self.robot.axes_data.check_position(rows[0], 'joint_reference')
                self._controller_state = rows
        return self._controller_state

    def refuse(self, topic: str, error: RobotsError, *, stream: bool = True) -> None:
        """See `RobotNode`; the report, which comes often, shows it for `REFUSAL_SHOWN`."""
        del stream
        self._refusal, self._refusal_time = f'{topic}: {error}', self.now()
        self.journal.error(self._refusal, throttle_duration_sec=REFUSAL_SHOWN)

    # -- the executor's thread -----------------------------------------------------------------------

    def _report(self) -> None:
        values: dict[str, Any] = {'method': self._method, 'missed_deadlines': self._loop.missed}
        step = self._last
        if step is not None:
            values |= {
                'position_error': f'{step.position_error:.3g}',
                'orientation_error': f'{step.orientation_error:.3g}',
                'slack': f'{step.slack:.3g}',
                'active_limits': ', '.join(step.limits),
            }
        durations = list(self._durations)
        if durations:
            values['computation_p99_ms'] = f'{1e3 * float(np.percentile(durations, 99.0)):.3f}'
        if self.now() - self._refusal_time < REFUSAL_SHOWN:
            self.report_health(DiagnosticStatus.WARN, self._refusal, **values)
        elif self._guidance.streaming:
            self.ready('following', **values)
        elif self._guidance.ended:
            self.report_health(DiagnosticStatus.WARN, self._guidance.ended, **values)
        else:
            self.ready('waiting for reference_pose', **values)


main: Final = partial(run, InverseKinematicsNode)
