"""What a program sets for its motions, and motions that blend, against a planner played by the test."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from rcl_interfaces.msg import SetParametersResult

from robots_controller.cell.program_motions import MOST_SENT
from robots_core.ros.messages import diagnostic_values

from .lua_bench import MOVE, LuaBench, SettingsBench, ignore


def test_settings_come_before_the_motion_and_end_with_the_program(ros_nodes: Any, tmp_path: Path):
    bench = SettingsBench(ros_nodes, tmp_path)
    bench.start(f'{MOVE} setSpeed(0.5, 0.25) setTool(0, 0, 0.2, 0, 0, 0) {MOVE} setSpeed(0.25) {MOVE}')
    bench.wait_for_state('FINISHED')
    assert [s['speed_fraction'] for s in bench.settings] == [0.8, 0.5, 0.25]
    assert [s['cartesian_speed'] for s in bench.settings] == [0.5, 0.25, 0.25]
    assert [s['tool'][2] for s in bench.settings] == [0.0, 0.2, 0.2]
    bench.settings.clear()
    bench.start(MOVE)
    bench.wait_for_state('FINISHED')
    assert (bench.settings[0]['speed_fraction'], bench.settings[0]['tool'][2]) == (0.8, 0.0)


def test_a_tool_and_its_payload_are_chosen_by_name(ros_nodes: Any, tmp_path: Path):
    bench = SettingsBench(ros_nodes, tmp_path)
    (tmp_path / 'frames.yaml').write_text(
        'tools:\n  gripper: {position: [0, 0, 0.25], payload: [12.5, 0, 0, 0.1]}\n'
        'bases:\n  table: {position: [1, 0, 0.5]}\n'
    )
    bench.planner.declare_parameter('base', [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
    bench.planner.declare_parameter('payload', [0.0, 0.0, 0.0, 0.0])
    bench.start(f"setTool('gripper') setBase('table') {MOVE}")
    bench.wait_for_state('FINISHED')
    (settings,) = bench.settings
    assert list(settings['tool'][:3]) == [0.0, 0.0, 0.25]
    assert list(settings['base'][:3]) == [1.0, 0.0, 0.5]
    assert list(settings['payload']) == [12.5, 0.0, 0.0, 0.1]
    bench.start(f"setTool('griper') {MOVE}")
    error = bench.wait_for_state('FAILED')['error']
    assert error == "test.lua:1: setTool: no tool is named 'griper' in frames.yaml; tools are gripper"


def test_setting_that_the_planner_refuses_fails_the_motion(ros_nodes: Any, tmp_path: Path):
    bench = SettingsBench(ros_nodes, tmp_path)
    bench.planner.add_on_set_parameters_callback(
        lambda _: SetParametersResult(successful=False, reason='not today')
    )
    bench.start(f'setSpeed(0.5) {MOVE}')
    error = bench.wait_for_state('FAILED')['error']
    assert error == 'test.lua:1: ptpJointSpaceAngles: planning_node refuses the settings: not today'
    assert bench.commands == []


def test_setting_that_the_planner_has_not_is_named(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path)
    bench.start(f'setBase(1, 0, 0, 0, 0, 0) {MOVE}')
    assert 'planning_node has no base' in bench.wait_for_state('FAILED')['error']


def test_blended_motions_are_sent_at_once_and_the_last_one_is_released(ros_nodes: Any, tmp_path: Path):
    bench = SettingsBench(ros_nodes, tmp_path)
    bench.on_command = ignore
    line = 'ptpCartesianSpace({1.5, 0, 1.5, 0, 90, 0}, {blend = 0.05})'
    bench.start(f'{line}\n{line}\nwait(0)')
    bench.wait(lambda: len(bench.commands) == 2, 'both motions')
    assert [s['blend_zone'] for s in bench.settings] == [0.05, 0.05]
    ros_nodes.wait_for(
        lambda: bench.planner.get_parameter('blend_zone').value == 0.0, what='the end of the chain'
    )
    bench.answer(bench.command_id())
    bench.wait_for_state('FINISHED')
    bench.wait(lambda: bench.states[-1] == 'IDLE', 'IDLE')


def test_many_blended_motions_are_held_back_and_none_is_lost(ros_nodes: Any, tmp_path: Path):
    count = MOST_SENT + 20
    bench = SettingsBench(ros_nodes, tmp_path)
    bench.on_command = ignore
    bench.start(
        f'for i = 1, {count} do\n'
        '  ptpJointSpaceAngles({i / 10, -90, 45, 0, 45, 0}, {jointBlend = 1})\n'
        'end\n'
        'ptpJointSpaceAngles(0, -90, 45, 0, 45, 0)'
    )
    bench.runner.wait_for(lambda: len(bench.commands) == MOST_SENT, what='as many as are on their way')
    bench.on_command = bench.answer
    bench.answer(bench.command_id())  # and all before it
    bench.wait_for_state('FINISHED')
    turned = [np.degrees(message.position[0]) for _, message in bench.commands]
    np.testing.assert_allclose(turned, [*(0.1 * np.arange(1, count + 1)), 0.0], atol=1e-9)


def test_the_status_has_the_line_of_the_motion_that_was_sent(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path)
    (tmp_path / 'part.lua').write_text(f'wait(0)\n{MOVE}\n')
    bench.on_command = ignore  # each motion lasts until its line was reported
    bench.start(f'{MOVE}\ncall("part")\n')
    for number, place in enumerate((('test.lua', '1'), ('part.lua', '2')), 1):
        bench.wait(lambda number=number: len(bench.commands) == number, f'motion {number}')

        def reported(place: tuple[str, str] = place) -> bool:
            values = diagnostic_values(bench.status[-1])
            return tuple(values.get(name) for name in ('motion', 'motion_file', 'motion_line')) == (
                bench.command_id(),
                *place,
            )

        bench.wait(reported, f'the place of motion {number}')
        bench.answer(bench.command_id())
    bench.wait_for_state('FINISHED')


def test_arcs_and_splines_are_paths(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path)
    bench.start("""
        circCartesianSpace({1, 0, 1, 0, 90, 0}, {1, 0.5, 1, 0, 90, 0})
        splineCartesianSpace({1, 0, 1, 0, 90, 0}, {1, 0.5, 1, 0, 90, 0}, {1, 1, 1, 0, 90, 0})""")
    bench.wait_for_state('FINISHED')
    (circ, arc), (spline, curve) = bench.commands
    assert (circ, spline) == ('circcartesian', 'splinecartesian')
    assert [len(arc.poses), len(curve.poses)] == [2, 3]
    assert curve.poses[1].pose.position.y == 0.5
    assert 'TRAJECTORY' in bench.states
