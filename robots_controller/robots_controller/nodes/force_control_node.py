"""force_control_node: presses the robot's tool by the force that a sensor measures."""

from functools import partial
from typing import Any, Final

from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import TwistStamped, WrenchStamped
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from robots_controller.cell.contact_setup import ContactSetup, read_contact
from robots_controller.cell.force_guide import PERIOD, ForceGuide
from robots_controller.nodes.ports.io_images import OutputImages
from robots_core.blocks.following.guide import Guide
from robots_core.periodic.realtime import processor_share
from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.messages import BUILD, wrench_from_message
from robots_core.ros.qos import make_publisher, subscribe
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.running.run import run
from robots_core.ros.streams.polled_subscription import PolledSubscription
from robots_core.ros.streams.serialized_readers import JointStateReader
from robots_core.status import Status
from robots_core.validation import Array


class ForceControlNode(RobotNode):
    """Publishes `reference_twist` while the program lets a sensor guide the robot.

    `contact_status` holds at all times what must stop the robot.
    """

    diagnostics_group = 'motion'
    phase = Phase.ENVIRONMENT

    def __init__(self, **options: Any) -> None:
        super().__init__('force_control_node', **options)
        path = self.parameter('contact', '', 'wheel, soil and force control (YAML)')
        if path:
            self._open(read_contact(path))
        else:
            self.ready('ready; parameter contact is empty, nothing is controlled')

    def _open(self, setup: ContactSetup) -> None:
        share = {} if self.simulated_time else {'share': processor_share}
        self._guide = ForceGuide(setup, self.robot, self._report, **share)
        self._channels = (setup.load, setup.speed, setup.slip)
        self._outputs = OutputImages(self, self._channels, lambda: None)
        self._joints = JointStateReader(self.robot.axes_data.names)
        self._position: Array | None = None
        self._status = make_publisher(self, DiagnosticStatus, 'contact_status')
        self._twists = make_publisher(self, TwistStamped, 'reference_twist')
        self._states = PolledSubscription(self, JointState, 'joint_states', raw=True)
        self._wrenches = PolledSubscription(self, WrenchStamped, 'measured_wrench')
        self._handed_over = False
        subscribe(self, String, 'guide', self._on_guide)
        self._report('')
        self.start_loop(self._step, period=PERIOD, name='force control')

    def _on_guide(self, message: String) -> None:
        self._handed_over = message.data == Guide.SENSOR

    def _report(self, problem: str) -> None:
        self._status.publish(BUILD.status(Status.of_problem('contact', problem), self.robot_name))
        if problem:
            self.report_health(DiagnosticStatus.WARN, problem)
            self.journal.error(problem)
        else:
            self.ready()

    def _step(self, now: float) -> None:
        raw, message = self._states.take(), self._wrenches.take()
        if raw is not None:
            with self.refusing('joint_states'):
                self._position = self._joints.position(raw)
        if message is not None and self._position is not None:
            with self.refusing('measured_wrench'):
                self._guide.measured(wrench_from_message(message), self._position)
        self._guide.hand_over(handed_over=self._handed_over)
        outputs = {channel: self._outputs.value(channel) or 0.0 for channel in self._channels}
        twist = self._guide.step(now, outputs)
        if twist is not None:
            self._twists.publish(BUILD.twist_stamped(self.get_clock().now().to_msg(), twist))


main: Final = partial(run, ForceControlNode)
