"""CellMonitor reports every command, whichever node sends it."""

from __future__ import annotations

from typing import Any

import pytest
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path
from sensor_msgs.msg import JointState

from robots_controller.live_cell.cell_events import Event, MotionCommanded
from robots_controller.live_cell.cell_monitor import CellMonitor
from robots_core.pose import Pose
from robots_core.ros.messages import stamp_id
from robots_planning.motion_kinds import KIND_OF_TOPIC

STAMP = Time(sec=12, nanosec=34)


def pose_at(x: float) -> PoseStamped:
    message = PoseStamped()
    message.header.stamp = STAMP
    message.pose.position.x = x
    return message


def joints() -> JointState:
    message = JointState(name=['a', 'b'], position=[0.25, 0.5])
    message.header.stamp = STAMP
    return message


def path() -> Path:
    message = Path(poses=[pose_at(0.1), pose_at(0.75)])
    message.header.stamp = STAMP
    return message


COMMANDS = {
    'ptpjoint_joint': (joints, 'PTPJOINT_JOINT'),
    'ptpjoint_cartesian': (lambda: pose_at(0.75), 'PTPJOINT_CARTESIAN'),
    'ptpcartesian': (lambda: pose_at(0.75), 'PTPCARTESIAN'),
    'circcartesian': (path, 'PTPCARTESIAN circle'),
    'splinecartesian': (path, 'PTPCARTESIAN spline'),
}


def test_all_commands_are_here() -> None:
    assert set(COMMANDS) == set(KIND_OF_TOPIC)


@pytest.mark.parametrize('topic', COMMANDS)
def test_a_command_is_an_event_with_its_target(ros_nodes: Any, topic: str) -> None:
    make, kind = COMMANDS[topic]
    monitor = ros_nodes.add(CellMonitor(namespace='/', context=ros_nodes.context))
    node = ros_nodes.create_node()
    message = make()
    publisher = node.create_publisher(type(message), topic, 10)
    ros_nodes.wait_for(publisher.get_subscription_count, what='the monitor')
    if isinstance(message, Path):
        publisher.publish(Path())  # leads nowhere: no motion
    publisher.publish(message)
    events: list[Event] = []

    def reported() -> bool:
        events.extend(monitor.take())
        return bool(events)

    ros_nodes.wait_for(reported, what='the command')
    (event,) = events
    assert isinstance(event, MotionCommanded)
    assert (event.id, event.kind) == (stamp_id(STAMP), kind)
    if isinstance(event.target, Pose):
        assert event.target.r.tolist() == [0.75, 0.0, 0.0]
    else:
        assert event.target.tolist() == [0.25, 0.5]
