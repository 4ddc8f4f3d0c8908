"""planning_node and controller_node where an obstacle stops a motion: messages and services."""

from __future__ import annotations

from typing import Any

import numpy as np
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.parameter import Parameter

from robots_core.motion_result import MotionResult
from robots_core.ros.messages import motion_result_from_message, motion_result_message, stamp_id
from robots_planning.motion_results import BLOCKED

from .planning_bench import ROBOT, PlanningBench

SETTINGS = {'avoid': True, 'on_blocked': 'replan', 'most_replans': 1}


def test_a_blocked_motion_is_sent_again_under_its_id_and_ended_when_it_was_too_often(ros_nodes: Any) -> None:
    bench = PlanningBench(ros_nodes)
    start, target = bench.robot.home, bench.robot.home + 0.3
    bench.stand(start)
    parameters = [Parameter(name, value=value).to_parameter_msg() for name, value in SETTINGS.items()]
    client = bench.peer.create_client(SetParametersAtomically, 'planning_node/set_parameters_atomically')
    bench.wait(client.service_is_ready, 'the parameters are served')
    done = client.call_async(SetParametersAtomically.Request(parameters=parameters))
    bench.wait(done.done, 'the settings are set')
    id_ = bench.command('ptpjoint_joint', target, 5)
    bench.planned()
    blocked = MotionResult(id_, ok=False, message=BLOCKED, details={'progress': '0.4'}, blocked=True)
    assert motion_result_from_message(motion_result_message(blocked, ROBOT)) == blocked
    stands = start + 0.1
    bench.stand(stands)
    bench.publish('motion_result', motion_result_message(blocked, ROBOT))
    around = bench.planned(2)
    assert [stamp_id(message.header.stamp) for message in bench.trajectories] == [id_, id_]
    np.testing.assert_allclose(around.position[[0, -1]], [stands, target], atol=1e-9)
    bench.publish('motion_result', motion_result_message(blocked, ROBOT))
    bench.wait(lambda: bench.results and not bench.results[-1].blocked, 'the last result')
    assert 'again, after 1 ways around' in bench.results[-1].message
    assert len(bench.trajectories) == 2
    assert not bench.node.planner.moving
