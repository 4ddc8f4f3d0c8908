"""hardware_node: a real robot behind its driver, in the place of drive_node."""

from functools import partial
from typing import Any, Final

import numpy as np
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64
from trajectory_msgs.msg import JointTrajectory

from robots_core.blocks.drives.driver_drives import DriverDrives, DriverStop, stopping_trajectory
from robots_core.blocks.drives.supervised_drives import SupervisedDrives
from robots_core.cell_interface.driver_file import Driver, read_driver
from robots_core.defaults import RATE
from robots_core.message_builder import NONE
from robots_core.nodes.driver_action import DriverAction
from robots_core.nodes.shared_parameters import realtime_priority_parameter
from robots_core.periodic.realtime import processor_share
from robots_core.ros.messages import BUILD, NANOSECONDS
from robots_core.ros.peers.heartbeat import watchdog_parameter
from robots_core.ros.qos import SENSOR, STREAM, make_publisher, subscribe_any, subscribe_any_state
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.running.run import run
from robots_core.ros.streams.polled_subscription import PolledSubscription
from robots_core.ros.streams.serialized_readers import JointStateReader, ReferenceReader
from robots_core.validation import Array


class HardwareNode(RobotNode):
    """Forwards `joint_reference` to the joint_trajectory_controller of a driver, by its topic or its action.

    Each message, or goal, is a trajectory that starts at once, reaches the reference after `lead` and stops
    behind it. A goal that the driver refuses or ends is a stop of the robot, until its brakes have closed.
    References are refused, and end, as those of simulated drives (`SupervisedDrives`). `joint_states` of the
    driver are passed on where their topic is another one; its speed scaling and its stops are passed on as
    `speed_scaling` and `robot_running`.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__('hardware_node', **options)
        rate = self.parameter('rate', RATE, 'trajectories per second, Hz', bounds=(10.0, 1000.0))
        priority = realtime_priority_parameter(self)
        self._driver: Driver = self.parameter(
            'driver', '', "topics of the robot's driver (YAML)", read=_driver
        )
        action = self._driver.action
        self._to = self._driver.trajectory if action is None else action.name
        self._period, self._watchdog = 1.0 / rate, watchdog_parameter(self)
        self._axes = self.robot.axes_data
        names = self._axes.names
        self._drives: DriverDrives | None = None
        self._supervised: SupervisedDrives | None = None
        self._on, self._stop = True, DriverStop()
        self._joint_states = JointStateReader(names)
        self._reader = ReferenceReader(names, 'joint_reference')
        self._power = PolledSubscription(self, Bool, 'drives_on')
        self._references = PolledSubscription(self, JointTrajectory, 'joint_reference', raw=True)
        self._feedback = PolledSubscription(self, JointState, self._driver.joint_states, SENSOR, raw=True)
        own = self.resolve_topic_name('joint_states')
        self._passed_on = None if own == self._driver.joint_states else make_publisher(self, JointState, own)
        self._names = list(names)
        self._action: DriverAction | None = None
        if self._driver.action is None:
            self._publisher = self.create_publisher(JointTrajectory, self._driver.trajectory, STREAM)
        else:
            self._action = DriverAction(self, self._driver.action, self._fail)
        self._offer_state_of_robot()
        self._loop = self.start_loop(
            self._step, period=self._period, name='references', realtime_priority=priority
        )

    def _offer_state_of_robot(self) -> None:
        driver = self._driver
        if driver.running or driver.action is not None:
            self._running_publisher = make_publisher(self, Bool, 'robot_running')
        if driver.running:
            subscribe_any_state(self, Bool, driver.running, self._on_running)
        if driver.speed_scaling:
            self._scaling = -1.0
            self._scaling_publisher = make_publisher(self, Float64, 'speed_scaling')
            subscribe_any(self, Float64, driver.speed_scaling, self._on_scaling, STREAM)

    def _on_running(self, message: Bool) -> None:
        self._stop.follows = message.data
        self._publish_running()

    def _fail(self, reason: str) -> None:
        """The driver does not follow the goals of the action."""
        if self._stop.fail(reason, self.now()):
            self._publish_running()

    def _publish_running(self) -> None:
        self._running_publisher.publish(Bool(data=not self._stop.reason))

    def _on_scaling(self, message: Float64) -> None:
        scaling = float(np.clip(message.data / self._driver.full_speed, 0.0, 1.0))
        if np.isfinite(scaling) and scaling != self._scaling:
            self._scaling = scaling
            self._scaling_publisher.publish(Float64(data=scaling))

    # -- the loop's thread ---------------------------------------------------------------------------

    def _step(self, now: float) -> None:
        self._measure()
        references = [raw for raw, _ in self._references.take_all()]
        # After the reference: the controller switches the drives off before it sends one that stands still.
        power = self._power.take()
        if power is not None:
            self._on = power.data
        supervised, drives = self._supervised, self._drives
        if supervised is None or drives is None:
            self.report_problem(f'waiting for {self._driver.joint_states}', trajectory=self._to)
            return
        if self._stop.recover(now, braked=supervised.braked):
            self._publish_running()
        supervised.power(on=self._on and not self._stop.reason)
        supervised.follow(now, references, self._read, lambda: self._reader.lead)
        self._send(drives.command)
        problem = self._stop.reason or self._unserved or supervised.problem
        self.report_problem(problem, trajectory=self._to)

    def _read(self, raw: bytes) -> tuple[Array, Array, float] | None:
        """Position and velocity (n,) of a reference, and its stamp, s."""
        with self.refusing('joint_reference'):
            rows, stamp = self._reader.read(raw)
            return self._axes.check_position(rows[0], 'joint_reference'), rows[1], stamp
        return None

    def _send(self, command: tuple[Array, Array] | None) -> None:
        action, failed = self._action, bool(self._stop.failure)
        if action is not None:
            action.put(None if command is None or failed else self._trajectory(*command))
        elif command is not None:
            self._publisher.publish(self._trajectory(*command))

    @property
    def _unserved(self) -> str:
        action = self._action
        return '' if action is None or action.served else f'waiting for {self._to}'

    def _measure(self) -> None:
        raw = self._feedback.take()
        if raw is None:
            return
        with self.refusing('joint_states'):
            position = self._joint_states.position(raw)
            if self._passed_on is not None:
                self._passed_on.publish(raw)
            if self._drives is None:
                self._drives = DriverDrives(position)
                self._supervised = SupervisedDrives(
                    self._drives,
                    self._axes,
                    period=self._period,
                    timeout=np.inf if self.simulated_time else self._watchdog or np.inf,
                    processor_share=processor_share,
                )
            self._drives.position = position

    def _trajectory(self, q: Array, q_dot: Array) -> JointTrajectory:
        points = (
            (round(NANOSECONDS * time), position, velocity, NONE)
            for time, position, velocity in stopping_trajectory(q, q_dot, self._axes, self._driver.lead)
        )
        # No stamp: it starts when it is received, whatever the clocks are.
        return BUILD.joint_trajectory(0, self._names, points)


def _driver(path: str) -> Driver:
    return read_driver(path) if path else Driver()


main: Final = partial(run, HardwareNode)
