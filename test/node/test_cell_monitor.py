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
from robots_planning.motion_kinds import MOTION_KINDS, MotionKind

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


MESSAGES = {'joints': joints, 'pose': lambda: pose_at(0.75), 'poses': path}


@pytest.mark.parametrize('kind', MOTION_KINDS, ids=lambda kind: kind.topic)
def test_a_command_is_an_event_with_its_target(ros_nodes: Any, kind: MotionKind) -> None:
    monitor = ros_nodes.add(CellMonitor(namespace='/', context=ros_nodes.context))
    node = ros_nodes.create_node()
    message = MESSAGES[kind.target]()
    publisher = node.create_publisher(type(message), kind.topic, 10)
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
    assert (event.id, event.kind) == (stamp_id(STAMP), kind.title)
    if isinstance(event.target, Pose):
        assert event.target.r.tolist() == [0.75, 0.0, 0.0]
    else:
        assert event.target.tolist() == [0.25, 0.5]
