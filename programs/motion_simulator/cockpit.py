"""A node that cues the motion of a vehicle as it comes: `vehicle_imu` in, `reference_pose` and its twist out.

Run `PYTHONPATH=$PYTHONPATH:programs python -m motion_simulator.cockpit` beside a cell with the program
`programs/motion_simulator/cockpit.lua` and the option `--guided constrained`.
"""

from __future__ import annotations

import sys
from functools import partial
from typing import Any, Final

import numpy as np
from geometry_msgs.msg import PoseStamped, TwistStamped
from sensor_msgs.msg import Imu
from std_msgs.msg import String

from motion_simulator.cabin import ENVELOPE, RATE, SETTINGS, flange, flange_twist
from robots_core.blocks import MotionCueing, VehicleMotion
from robots_core.blocks.following.guide import Guide
from robots_core.errors import InvalidInputError
from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.messages import pose_stamped_message, twist_stamped_message
from robots_core.ros.polled_subscription import PolledSubscription
from robots_core.ros.qos import COMMAND, STREAM, subscribe_state
from robots_core.ros.run import run
from robots_core.ros.timed_node import TimedNode

REASON_SHOWN: Final = 1.0  # s


class Cockpit(TimedNode):
    """Publishes `reference_pose` and `reference_twist` while the program lets a sensor guide the robot.

    The cabin starts in its middle.
    """

    phase = Phase.ENVIRONMENT

    def __init__(self, **options: Any) -> None:
        super().__init__('cockpit', **options)
        self._cueing = MotionCueing(SETTINGS, ENVELOPE, 1.0 / RATE)
        self._guiding = self._moved = False
        self._motions = PolledSubscription(self, Imu, 'vehicle_imu', STREAM)
        self._poses = self.create_publisher(PoseStamped, 'reference_pose', COMMAND)
        self._twists = self.create_publisher(TwistStamped, 'reference_twist', COMMAND)
        subscribe_state(self, String, 'guide', self._on_guide)
        self.start_loop(self._step, period=1.0 / RATE, name='cockpit')

    def _on_guide(self, message: String) -> None:
        self._guiding = message.data == Guide.SENSOR

    def _step(self, _now: float) -> None:
        message = self._motions.take()
        if not self._guiding:
            if self._moved:
                self._cueing.reset()
            self._moved = False
            return
        self._moved = True
        step = self._cueing.step(None if message is None else self._motion(message))
        stamp = self.get_clock().now().to_msg()
        self._poses.publish(pose_stamped_message(stamp, flange(step)))
        self._twists.publish(twist_stamped_message(stamp, flange_twist(step)))
        if step.limits:
            self.journal.info('; '.join(step.limits), throttle_duration_sec=REASON_SHOWN)

    def _motion(self, message: Imu) -> VehicleMotion | None:
        """The motion of a message; none if its numbers are not finite."""
        f, w = message.linear_acceleration, message.angular_velocity
        try:
            return VehicleMotion(np.array([f.x, f.y, f.z]), np.array([w.x, w.y, w.z]))
        except InvalidInputError as error:
            self.journal.error(f'vehicle_imu: {error}', throttle_duration_sec=REASON_SHOWN)
            return None


main: Final = partial(run, Cockpit)

if __name__ == '__main__':
    sys.exit(main())
