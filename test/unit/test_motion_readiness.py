"""MotionReadiness: a program starts by itself only when the robot can move."""

from __future__ import annotations

from robots_controller.cell.motion_readiness import MotionReadiness


def ready(*expected: str) -> MotionReadiness:
    """Planner and controller are well."""
    readiness = MotionReadiness(expected)
    readiness.reference = True
    for name in ('planning_node', 'controller_node'):
        readiness.report(name, '')
    return readiness


def missing(readiness: MotionReadiness, *, planner: bool = True, controller: bool = True) -> list[str]:
    return readiness.missing(planner=planner, controller=controller)


def test_planner_and_controller_are_needed_and_a_reference() -> None:
    readiness = MotionReadiness(())
    assert missing(readiness) == ['controller_node']
    readiness.reference = True
    assert missing(readiness) == []
    assert missing(readiness, planner=False) == ['planning_node']
    assert missing(readiness, controller=False) == ['controller_node']


def test_what_is_there_and_not_well_is_waited_for() -> None:
    readiness = ready()
    readiness.report('planning_node', 'waiting for joint_reference')
    assert missing(readiness) == ['planning_node (waiting for joint_reference)']
    assert missing(readiness, planner=False) == ['planning_node']
    readiness.report('planning_node', '')
    assert missing(readiness) == []


def test_expected_nodes_have_to_report_whatever_their_health_is() -> None:
    readiness = ready('collision_node')
    readiness.report('visualizer_node', '')
    assert missing(readiness) == ['collision_node']
    readiness.report('collision_node', 'no robot')
    assert missing(readiness) == []


def test_with_expected_nodes_the_controller_has_to_report_too() -> None:
    readiness = MotionReadiness(['collision_node'])
    readiness.reference = True
    readiness.report('collision_node', '')
    assert missing(readiness) == ['controller_node']
    readiness.report('controller_node', '')
    assert missing(readiness) == []
