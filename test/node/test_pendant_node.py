"""pendant_node: what is pressed reaches the nodes of a cell, and what they report is shown."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any
from urllib.request import urlopen

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rcl_interfaces.msg import Log
from rclpy.parameter import Parameter
from std_msgs.msg import Float64

from robots_controller.io.io_image import Channel
from robots_controller.nodes.pendant_node import PendantNode
from robots_controller.pendant.jog.held_button import MOVE_KEY, RUN_KEY, Sign
from robots_controller.pendant.message_log import Level
from robots_controller.pendant.permissions import Action, NotPermittedError
from robots_controller.program.run_state import RunState
from robots_controller.report.recorded_run import read_run
from robots_core.cell_interface.operating_modes import Commander, OperatingMode
from robots_core.errors import BagError, NotNowError, ProgramError, RobotsError
from robots_core.ros.messages import diagnostic_values
from robots_core.ros.qos import STATE
from robots_planning.motion_settings import DESCRIPTIONS

from .operated_cell import ME, OperatedCell
from .program_cell import CRAWL, MOVE, ROBOT

OUTPUT, INPUT = Channel('digital', 'output', 2), Channel('digital', 'input', 1)


@pytest.fixture(scope='module')
def cell(module_ros_nodes: Any, tmp_path_factory: pytest.TempPathFactory) -> OperatedCell:
    return OperatedCell(module_ros_nodes, tmp_path_factory.mktemp('programs'))


@pytest.fixture(autouse=True)
def in_t1(cell: OperatedCell) -> None:
    cell.operator.release(ME)
    cell.operator.take_control(ME, from_other=True)
    cell.set_mode(OperatingMode.T1)


@pytest.mark.parametrize('key', ['axes 1 +', 'tool 2 -', 'base 1 +'])
def test_the_robot_moves_while_a_button_is_held_and_stops_without_signs(cell: OperatedCell, key: str) -> None:
    cell.until_standing()
    start = np.array(cell.references[-1].positions)
    cell.hold(key, lambda: any(cell.references[-1].velocities), 'it moves')
    cell.until_standing()  # nobody has released it
    moved = np.array(cell.references[-1].positions) - start
    assert np.abs(moved).max() > 0.0
    assert key != 'axes 1 +' or np.flatnonzero(np.abs(moved) > 1e-9).tolist() == [1]


def test_a_release_stops_the_robot(cell: OperatedCell) -> None:
    cell.hold('axes 1 -', lambda: any(cell.references[-1].velocities), 'it moves')
    cell.operator.release(ME)
    cell.until_standing()


def settings(cell: OperatedCell) -> dict[str, Any]:
    return {name: cell.planner.get_parameter(name).value for name in DESCRIPTIONS}


@pytest.mark.parametrize(('key', 'step'), [('axes 1 +', 0.01), ('base 2 -', 0.001)])
def test_a_step_ends_just_there_and_leaves_the_settings_as_they_were(
    cell: OperatedCell, key: str, step: float
) -> None:
    robot, before = cell.node.robot, settings(cell)
    if key.startswith('base'):  # from a posture that is not singular
        for bent in ('axes 3 +', 'axes 4 +'):
            cell.step(bent, 0.15)
    cell.until_standing()
    start = np.array(cell.references[-1].positions)
    cell.step(key, step)
    cell.until_standing()
    q = np.array(cell.references[-1].positions)
    if key.startswith('axes'):
        np.testing.assert_allclose(q - start, [0.0, step, 0.0, 0.0, 0.0, 0.0], atol=1e-6)
    else:
        moved = robot.direct_kinematics(q)[0] - robot.direct_kinematics(start)[0]
        np.testing.assert_allclose(moved, [0.0, 0.0, -step], atol=1e-6)
    cell.wait(lambda: settings(cell) == before and cell.state.commander is Commander.NOBODY, 'the end')


def test_during_a_step_the_settings_of_programs_are_as_before(cell: OperatedCell) -> None:
    """So nothing remains of a pendant that is killed then."""
    before = settings(cell)
    cell.until_standing()
    cell.hold('axes 0 +', lambda: any(cell.references[-1].velocities), 'it moves', step=0.3)
    assert settings(cell) == before
    limit = cell.node.robot.axes_data.velocity
    assert (np.abs(cell.references[-1].velocities) <= 0.11 * limit).all()  # as slow as a jog
    own = cell.planner.get_parameter('pendant.speed_fraction').value
    assert own == pytest.approx(cell.state.jog_speeds.fraction)
    cell.operator.release(ME)
    cell.until_standing()
    assert settings(cell) == before


def test_a_motion_to_a_target_ends_when_its_button_is_released(cell: OperatedCell) -> None:
    cell.until_standing()
    goal = np.array(cell.references[-1].positions)
    goal[0] += 0.5
    found = cell.operator.preview(ME, 'joints', goal.tolist(), 0.1)
    assert found.duration > 1.0
    cell.hold(MOVE_KEY, lambda: any(cell.references[-1].velocities), 'it moves')
    assert cell.state.commander is Commander.PENDANT
    cell.operator.release(ME)
    cell.until_standing()
    assert abs(cell.references[-1].positions[0] - goal[0]) > 0.1
    cell.wait(lambda: cell.state.commander is Commander.NOBODY, 'its end')
    cell.hold('axes 0 -', lambda: any(cell.references[-1].velocities), 'a jog')


def test_previews_keep_the_distance_that_the_planner_keeps_now(cell: OperatedCell) -> None:
    cell.until_standing()
    cell.wait(lambda: not cell.planner.moving, 'the end of the jog before')
    cell.operator.preview(ME, 'joints', [*cell.references[-1].positions], 0.1)
    for margin in (0.02, 0.005):
        (result,) = cell.planner.set_parameters([Parameter('collision_margin', value=margin)])
        assert result.successful, result.reason
        cell.wait(lambda: cell.node._preview.collision_margin == margin, f'{margin} m')  # noqa: B023


def test_jogging_is_refused_where_the_mode_excludes_it(cell: OperatedCell) -> None:
    cell.set_mode(OperatingMode.AUTOMATIC)
    cell.presses += 1
    with pytest.raises(NotPermittedError, match='mode_excludes_pendant'):
        cell.operator.hold(Sign(ME, cell.presses, 'axes 0 +'))


def test_a_program_runs_while_run_is_held(cell: OperatedCell) -> None:
    path = cell.folder / 'move.lua'
    path.write_text(f'{CRAWL}setDigitalOutput(3, 1)\n{MOVE}')
    cell.operator.open_program(ME, str(path))
    cell.wait(lambda: cell.state.program.path == str(path), 'the program')
    cell.wait(lambda: cell.state.program.state is RunState.OPENED, 'a program that can run')

    def moved_by_the_program() -> bool:
        program = cell.state.program
        return (
            any(cell.references[-1].velocities)
            and cell.state.commander is Commander.PROGRAM
            and (program.motion_line, program.motion_file) == (3, 'move.lua')
        )

    cell.hold(RUN_KEY, moved_by_the_program, 'the motion of line 3')
    cell.operator.release(ME)
    cell.wait(lambda: cell.state.program.state is RunState.PAUSED, 'a held program')
    assert cell.state.program.hold == 'release'
    cell.stop()
    cell.until_done(lambda: cell.operator.act(ME, Action.REWIND))
    cell.wait(lambda: cell.state.program.state is RunState.OPENED, 'its start')
    cell.operator.set_override(ME, 1.0)
    cell.wait(lambda: cell.state.override == 1.0, 'the override')


def test_a_program_is_debugged(cell: OperatedCell) -> None:
    path = cell.folder / 'debugged.lua'
    path.write_text('local way = 3\nsetDigitalOutput(4, 1)\nsetDigitalOutput(4, 0)\n')
    cell.operator.open_program(ME, str(path))
    cell.wait(lambda: cell.state.program.path == str(path), 'the program')
    cell.operator.toggle_breakpoint(ME, 'debugged.lua', 2)
    cell.wait(lambda: cell.state.breakpoints == {'debugged.lua': {2}}, 'a breakpoint')
    cell.hold(RUN_KEY, lambda: cell.state.program.hold == 'breakpoint', 'a held program')
    stack = cell.operator.call_stack()
    assert (stack.frames[0].chunk, stack.frames[0].line) == ('debugged.lua', 2)
    assert [(one.name, one.value) for one in stack.frames[0].scopes['Locals']] == [('way', '3')]
    cell.step_program('over')
    cell.wait(lambda: cell.state.program.hold == 'step', 'the next line')
    assert cell.operator.call_stack().frames[0].line == 3
    cell.operator.toggle_breakpoint(ME, 'debugged.lua', 2)
    cell.wait(lambda: not cell.state.breakpoints, 'no breakpoint')
    cell.stop()


def test_a_program_that_waits_for_run_makes_one_step(cell: OperatedCell) -> None:
    path = cell.folder / 'stepped.lua'
    path.write_text('while true do\nwait(0.01)\nend\n')
    cell.operator.open_program(ME, str(path))
    cell.wait(lambda: cell.state.program.path == str(path), 'the program')
    cell.hold(RUN_KEY, lambda: cell.state.program.line == 2, 'its loop')
    cell.operator.release(ME)
    cell.wait(lambda: cell.state.program.waits_for_run, 'a held program')
    cell.step_program('over')
    cell.wait(lambda: cell.state.program.hold == 'step', 'a step')
    cell.stop()


def test_a_saved_program_is_open_and_its_mistakes_are_found(cell: OperatedCell) -> None:
    path = cell.folder / 'saved.lua'
    path.write_text('wait(1)\n')
    cell.operator.open_program(ME, str(path))
    cell.wait(lambda: cell.state.program.path == str(path), 'the program')
    found = cell.operator.save_program(ME, 'saved.lua', 'wait(1)\n', 'wait(1, 2, 3)\n')
    assert [(one.file, one.line) for one in found] == [('saved.lua', 1)]
    assert path.read_text() == 'wait(1, 2, 3)\n'
    with pytest.raises(ProgramError, match='changed by another one'):
        cell.operator.save_program(ME, 'saved.lua', 'wait(1)\n', 'wait(2)\n')
    cell.operator.undo(ME)
    assert path.read_text() == 'wait(1)\n'


def test_a_program_that_cannot_be_opened_is_shown_and_no_other_runs_in_its_place(cell: OperatedCell) -> None:
    good, broken = cell.folder / 'good.lua', cell.folder / 'broken.lua'
    good.write_text("print('good')\n")
    broken.write_text('for\n')
    cell.until_done(lambda: cell.operator.open_program(ME, str(good)))
    cell.wait(lambda: cell.state.program.path == str(good), 'the good one')
    with pytest.raises(NotNowError, match=r'broken\.lua:1: '):
        cell.operator.open_program(ME, str(broken))
    cell.wait(lambda: cell.state.program.path == str(broken), 'the broken one')
    program = cell.state.program
    assert (program.state, program.points_file) == (RunState.IDLE, str(broken.with_suffix('.points.yaml')))
    with pytest.raises(NotPermittedError, match='not_startable'):
        cell.operator.hold(Sign(ME, cell.presses + 1, RUN_KEY))
    cell.presses += 1
    cell.program.set_parameters([Parameter('program', value=str(good))])  # which alone opens nothing
    (found,) = cell.operator.save_program(ME, broken.name, 'for\n', 'for i\n')
    assert (found.file, found.line) == ('broken.lua', 1)
    assert cell.state.program.path == str(broken)
    assert not cell.operator.save_program(ME, broken.name, 'for i\n', "print('mended')\n")
    cell.wait(lambda: cell.state.program.state is RunState.OPENED, 'it is open')
    assert cell.state.program.path == str(broken)


def test_a_service_teaches_a_point(cell: OperatedCell) -> None:
    path = cell.folder / 'taught.lua'
    path.write_text('wait(1)\n')
    cell.operator.open_program(ME, str(path))
    cell.wait(lambda: cell.state.program.path == str(path), 'the program')
    cell.until_standing()
    cell.set_parameters(cell.program, point='pallet')
    cell.wait(lambda: cell.call('lua_program_node/teach').success, 'a taught point')
    points = cell.operator.teaching.points(path.with_suffix('.points.yaml'))
    np.testing.assert_allclose(points['pallet'].q, cell.references[-1].positions, atol=1e-3)


def test_what_a_node_refuses_is_raised(cell: OperatedCell) -> None:
    with pytest.raises(RobotsError, match=r'missing\.lua'):
        cell.operator.open_program(ME, str(cell.folder / 'missing.lua'))


def test_outputs_are_switched_and_inputs_forced(cell: OperatedCell) -> None:
    cell.operator.set_output(ME, OUTPUT, 1.0)
    cell.wait(lambda: cell.state.io.values['digital_outputs'][1] == 1.0, 'the output')
    cell.operator.force_input(ME, INPUT, 1.0)
    cell.wait(lambda: cell.state.io.forced == {'digital_input.1'}, 'a forced input')
    assert cell.state.io.values['digital_inputs'][0] == 1.0
    cell.operator.force_input(ME, INPUT, None)
    cell.wait(lambda: not cell.state.io.forced, 'its release')


def test_a_fault_is_shown_and_reset(cell: OperatedCell) -> None:
    cell.call('controller_node/emergency_stop')
    cell.wait(lambda: cell.state.fault, 'the fault')
    cell.presses += 1
    with pytest.raises(NotPermittedError, match='fault'):
        cell.operator.hold(Sign(ME, cell.presses, 'axes 0 +'))
    cell.operator.act(ME, Action.RESET)
    cell.wait(lambda: not cell.state.fault, 'its end')


def test_what_the_cell_reports_is_shown(cell: OperatedCell) -> None:
    robot = cell.node.robot
    cell.wait(lambda: cell.state.q is not None, 'positions')
    cell.publish('override', Float64(data=0.25), STATE)
    cell.wait(lambda: cell.state.override == 0.25, 'the override of another node')
    cell.publish('/rosout', Log(name='lua_program_node.print', msg='hello', level=Log.INFO))
    cell.publish('/rosout', Log(name='plc_node', msg='no signal', level=Log.WARN))
    cell.wait(lambda: [*cell.operator.prints][-1:] == ['hello'], 'a print')
    cell.wait(lambda: cell.operator.messages.shown(Level.WARNING, 'no signal'), 'a message')
    due = 1e-9 * cell.node.get_clock().now().nanoseconds + 1000.0
    pending = json.dumps([[due, 4, {'digital_input.1': 1.0}]])
    values = [KeyValue(key='script', value='press.yaml'), KeyValue(key='pending', value=pending)]
    cell.publish('plc_status', DiagnosticStatus(message='ready', values=values), STATE)
    cell.wait(lambda: cell.state.plc.script == 'press.yaml', 'a scripted PLC')
    ((time, line, inputs),) = cell.state.plc.pending
    assert time <= cell.operator.now() + 1000.0
    assert (line, inputs) == (4, {'digital_input.1': 1.0})
    status = DiagnosticStatus(name='/visualizer_node', values=[])
    cell.publish('/diagnostics', DiagnosticArray(status=[status]))
    assert cell.state.q.shape == (robot.num_axes,)
    assert cell.state.jog_speeds.fraction == 0.1


def test_what_happens_is_recorded_and_reported_on(cell: OperatedCell) -> None:
    recording = cell.operator.recording
    recording._folder = cell.folder / 'out'
    with pytest.raises(BagError, match='there is no bag in'):
        recording.report()
    recording.begin()
    bag = Path(recording.bag)
    with pytest.raises(NotNowError, match='is recorded already'):
        recording.begin()
    cell.wait((bag / 'metadata.yaml').is_file, 'the bag')
    cell.hold('axes 1 -', lambda: any(cell.references[-1].velocities), 'it moves')
    cell.until_standing()
    cell.wait(lambda: 'joint_reference' in (bag / 'metadata.yaml').read_text(), 'references in the bag')
    cell.wait(lambda: 'motion_result' in (bag / 'metadata.yaml').read_text(), 'results in the bag')
    cell.step('axes 1 -', 0.01)
    cell.until_standing()
    recording.end()
    assert recording.bag == ''
    assert '<html' in recording.report()
    motion = read_run(bag, robot=ROBOT).motions[-1]
    assert motion.settings.speed_fraction == pytest.approx(cell.state.jog_speeds.fraction)
    assert settings(cell)['speed_fraction'] != pytest.approx(cell.state.jog_speeds.fraction)


def test_health_has_the_address_of_the_page(cell: OperatedCell) -> None:
    cell.wait(lambda: any(one.name == '/pendant_node' for one in cell.health), 'health')
    status = [one for one in cell.health if one.name == '/pendant_node'][-1]
    url = diagnostic_values(status)['url']
    assert url.startswith('http://127.0.0.1:')
    with urlopen(url, timeout=240.0) as page:  # noqa: S310  # our own address
        assert cell.node.robot.name in page.read().decode()


def test_without_its_page_the_node_says_what_is_missing(
    ros_context: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, 'robots_controller.pendant.page.access.page_server', None)
    with pytest.raises(RobotsError, match=r'needs NiceGUI .*: pip install -r requirements-pendant\.txt'):
        PendantNode(context=ros_context)
