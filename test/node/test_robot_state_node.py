"""robot_state_node: description and transforms; the messages of /tf are built from their definition here."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import SetParameters
from sensor_msgs.msg import JointState
from std_msgs.msg import Header, String

from bench import EVERY_STATE, Bench
from built_messages import build_messages
from robots_core import Pose, load_robot_model
from robots_core.blocks.link_frames import LinkFrames
from robots_core.nodes.robot_state_node import RobotStateNode
from robots_core.ros.messages import doubles
from robots_core.ros.qos import STATE

ROBOT = 'ur5e'
TF_MESSAGE = 'geometry_msgs/TransformStamped[] transforms\n'
ARRAY = 8  # ParameterType.PARAMETER_DOUBLE_ARRAY


@pytest.fixture(scope='module')
def built(tmp_path_factory: pytest.TempPathFactory) -> Any:
    uses = ('geometry_msgs', 'std_msgs', 'builtin_interfaces')
    return build_messages(tmp_path_factory.mktemp('tf2'), 'tf2_msgs', {'TFMessage': TF_MESSAGE}, uses)


@pytest.fixture
def tf_message(built: Any, monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    monkeypatch.syspath_prepend(str(built))
    from tf2_msgs.msg import TFMessage  # noqa: PLC0415  # built above

    yield TFMessage
    for name in [name for name in sys.modules if name.partition('.')[0] == 'tf2_msgs']:
        del sys.modules[name]


def pose_of(transform: Any) -> Pose:
    t, o = transform.transform.translation, transform.transform.rotation
    return Pose.from_quaternion([t.x, t.y, t.z], [o.x, o.y, o.z, o.w])


def test_the_description_is_latched_also_where_there_are_no_transforms(
    ros_nodes: Any, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setitem(sys.modules, 'tf2_msgs', None)
    bench = Bench(ros_nodes)
    bench.start_node(RobotStateNode, robot_model=ROBOT)
    texts = bench.collect('robot_description', String, EVERY_STATE, lambda message: message.data)
    bench.wait(lambda: texts, 'the description')
    assert texts == [load_robot_model(ROBOT).description]
    bench.until_health(DiagnosticStatus.OK, 'no transforms: tf2_msgs cannot be imported')


def test_transforms_of_all_links(ros_nodes: Any, tf_message: Any):
    robot = load_robot_model(ROBOT)
    bench = Bench(ros_nodes)
    bench.start_node(RobotStateNode, robot_model=ROBOT, tool=[0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 1.0])
    static = bench.collect('/tf_static', tf_message, EVERY_STATE)
    moving = bench.collect('/tf', tf_message)
    q = robot.home + 0.1
    state = JointState(
        header=Header(stamp=Time(sec=3, nanosec=4)),
        name=list(robot.axes_data.names)[::-1],
        position=doubles(q[::-1]),
    )
    bench.publish('joint_states', state, STATE)
    bench.wait(lambda: static and moving, 'the transforms')
    frames = LinkFrames(robot.description)
    wanted = list(frames.moving(dict(zip(robot.axes_data.names, q, strict=True))))
    assert [(one.header.frame_id, one.child_frame_id) for one in moving[0].transforms] == [
        (frame.parent, frame.child) for frame in wanted
    ]
    for one, frame in zip(moving[0].transforms, wanted, strict=True):
        assert one.header.stamp == Time(sec=3, nanosec=4)
        assert pose_of(one).distance_to(frame.pose) == pytest.approx((0.0, 0.0), abs=1e-9)
    parents = {one.child_frame_id: one.header.frame_id for one in static[0].transforms}
    assert parents == {
        'tool0': 'link_6',
        'base': 'base_link',  # the root
        'flange': 'tool0',
        'tool': 'tool0',
        'work': 'base',
    }

    value = ParameterValue(type=ARRAY, double_array_value=[1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0])
    request = SetParameters.Request(parameters=[Parameter(name='work', value=value)])
    (answer,) = bench.call('robot_state_node/set_parameters', request, SetParameters).results
    assert answer.successful, answer.reason
    bench.wait(lambda: len(static) == 2, 'the work frame')
    (work,) = (one for one in static[-1].transforms if one.child_frame_id == 'work')
    np.testing.assert_allclose(pose_of(work).r, [1.0, 2.0, 0.0])


def test_two_robots_share_the_tree_by_their_namespaces(ros_nodes: Any, tf_message: Any):
    bench = Bench(ros_nodes)
    ros_nodes.add(RobotStateNode(namespace='left', **ros_nodes.options(robot_model=ROBOT)))
    static = bench.collect('/tf_static', tf_message, EVERY_STATE)
    bench.wait(lambda: static, 'the transforms')
    names = {name for one in static[0].transforms for name in (one.header.frame_id, one.child_frame_id)}
    assert all(name.startswith('left/') for name in names)
