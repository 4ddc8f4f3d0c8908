"""wheel_soil_node: a wheel on simulated soil, in the place of a force/torque sensor at a real tool."""

from functools import partial
from typing import Any, Final

from geometry_msgs.msg import WrenchStamped
from sensor_msgs.msg import JointState

from robots_controller.cell.contact_setup import ContactSetup, read_contact
from robots_controller.nodes.ports.io_images import OutputImages
from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.messages import BUILD, joint_values
from robots_core.ros.qos import make_publisher, subscribe
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.running.run import run


class WheelSoilNode(RobotNode):
    """Publishes `measured_wrench` for every `joint_states`."""

    phase = Phase.ENVIRONMENT

    def __init__(self, **options: Any) -> None:
        super().__init__('wheel_soil_node', **options)
        path = self.parameter('contact', '', 'wheel, soil and force control (YAML)')
        if path:
            self._open(read_contact(path))
        self.ready('ready' if path else 'ready; parameter contact is empty, nothing is measured')

    def _open(self, setup: ContactSetup) -> None:
        self._setup, self._contact = setup, setup.contact()
        self._names = list(self.robot.axes_data.names)
        self._outputs = OutputImages(self, [setup.slip], lambda: None)
        self._publisher = make_publisher(self, WrenchStamped, 'measured_wrench')
        subscribe(self, JointState, 'joint_states', self._measure)

    def _measure(self, message: JointState) -> None:
        q = joint_values(message.name, message.position, self._names, 'joint_states')
        self._contact.slip = self._outputs.value(self._setup.slip) or 0.0
        wrench = self._contact.of_robot(self.robot, q).wrench
        self._publisher.publish(BUILD.wrench_stamped(message.header.stamp, wrench))


main: Final = partial(run, WheelSoilNode)
