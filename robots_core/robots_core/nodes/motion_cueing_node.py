"""motion_cueing_node: a cabin that follows the motion of a vehicle, which a person drives or a topic has."""

from functools import partial
from typing import Any, Final

from geometry_msgs.msg import PoseStamped, TwistStamped
from std_msgs.msg import String

from robots_core.blocks.following.following_methods import RATE
from robots_core.blocks.following.guide import Guide
from robots_core.blocks.motion_cueing.cabin import Cabin, read_cabin
from robots_core.blocks.motion_cueing.cockpit import Cockpit
from robots_core.blocks.motion_cueing.vehicle_inputs import INPUTS, read_input
from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.messages import BUILD, message_class
from robots_core.ros.qos import make_publisher, subscribe
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.running.run import run
from robots_core.ros.streams.polled_subscription import PolledSubscription

REASON_SHOWN: Final = 1.0  # s


class MotionCueingNode(RobotNode):
    """Publishes `reference_pose` and `reference_twist` while the program lets a sensor guide the robot.

    Takes the driver's inputs from `joy` (steering and pedal, each -1..1), or the motion of a vehicle that is
    simulated elsewhere from `vehicle_imu`. The cabin starts in its middle, and returns there when both fall
    silent.
    """

    diagnostics_group = 'motion'
    phase = Phase.CUEING

    def __init__(self, **options: Any) -> None:
        super().__init__('motion_cueing_node', **options)
        path = self.parameter('cabin', '', 'the cabin, its envelope and its cueing (YAML)')
        if path:
            self._open(read_cabin(path))
        self.ready('ready' if path else 'ready; parameter cabin is empty, nothing is cued')

    def _open(self, cabin: Cabin) -> None:
        self._cabin, self._cockpit = cabin, Cockpit(cabin, 1.0 / RATE)
        self._guiding = False
        self._inputs = {
            topic: PolledSubscription(self, message_class(kind), topic) for topic, kind in INPUTS.items()
        }
        self._poses = make_publisher(self, PoseStamped, 'reference_pose')
        self._twists = make_publisher(self, TwistStamped, 'reference_twist')
        subscribe(self, String, 'guide', self._on_guide)
        self.start_loop(self._step, period=1.0 / RATE, name='motion cueing')

    def _on_guide(self, message: String) -> None:
        self._guiding = message.data == Guide.SENSOR

    def _step(self, _now: float) -> None:
        messages = {topic: subscription.take() for topic, subscription in self._inputs.items()}
        self._cockpit.hand_over(handed_over=self._guiding)
        if not self._cockpit.handed_over:
            return
        for topic, message in messages.items():
            if message is not None:
                with self.refusing(topic):
                    self._cockpit.take(read_input(topic, message))
        step = self._cockpit.step()
        stamp = self.get_clock().now().to_msg()
        self._poses.publish(BUILD.pose_stamped(stamp, self._cabin.flange_of(step)))
        self._twists.publish(BUILD.twist_stamped(stamp, self._cabin.twist_of(step)))
        if step.limits:
            self.journal.info('; '.join(step.limits), throttle_duration_sec=REASON_SHOWN)


main: Final = partial(run, MotionCueingNode)
