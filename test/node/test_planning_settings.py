"""The settings of planned motions, by topics and parameters of planning_node."""

from __future__ import annotations

from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.parameter import Parameter

from robots_core.errors import InvalidInputError
from robots_core.ros.messages import diagnostic_values
from robots_core.ros.qos import STATE
from robots_planning import LinearCartesianLimited, MotionSettings
from robots_planning.motion_settings import settings_from_text

from .planning_bench import PlanningBench


@pytest.fixture
def bench(ros_nodes: Any) -> PlanningBench:
    return PlanningBench(ros_nodes)


def test_modal_settings_hold_from_the_next_command_on(bench: PlanningBench) -> None:
    bench.stand(bench.robot.home)
    usual = LinearCartesianLimited(bench.robot).generate(bench.robot.home, bench.below()).duration
    bench.runner.wait_for(
        lambda: all(
            result.successful
            for result in bench.node.set_parameters(
                [Parameter('cartesian_speed', value=0.01), Parameter('speed_fraction', value=0.5)]
            )
        ),
        what='the settings are taken',
    )
    bench.command('ptpcartesian', bench.below(), 5)
    # 0.1 m at 0.01 m/s.
    assert bench.planned().duration > 10.0 > usual


@pytest.mark.parametrize('value', [0.0, -1.0, float('nan'), float('inf'), 2.0])
def test_invalid_settings_are_refused_and_change_nothing(bench: PlanningBench, value: float) -> None:
    result = bench.node.set_parameters_atomically(
        [Parameter('cartesian_speed', value=0.1), Parameter('speed_fraction', value=value)]
    )
    assert not result.successful
    assert 'speed_fraction' in result.reason
    assert bench.node.get_parameter('cartesian_speed').value == 0.5


def test_the_settings_are_published(ros_nodes: Any) -> None:
    tool = [0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 1.0]
    bench = PlanningBench(ros_nodes, tool=tool)
    published: list[MotionSettings] = []
    bench.peer.create_subscription(
        DiagnosticStatus,
        'motion_settings',
        lambda message: published.append(settings_from_text(diagnostic_values(message))),
        STATE,
    )
    bench.wait(lambda: published, 'the settings of the start')
    assert published == [MotionSettings(tool=tuple(tool))]
    bench.node.set_parameters([Parameter('new_command', value='queue')])  # no setting of a motion
    bench.node.set_parameters_atomically(
        [Parameter('cartesian_speed', value=0.1), Parameter('blend_zone', value=0.02)]
    )
    bench.wait(lambda: len(published) > 1, 'the change')
    assert published[1:] == [MotionSettings(tool=tuple(tool), cartesian_speed=0.1, blend_zone=0.02)]


def test_an_invalid_setting_at_start_is_reported(ros_nodes: Any) -> None:
    with pytest.raises(InvalidInputError, match='rotation_speed'):
        PlanningBench(ros_nodes, rotation_speed=-1.0)
