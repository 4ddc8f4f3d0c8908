"""The nodes in lock-step and the simulation do the same, to the last bit."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from guiding_messages import joy, twists
from press_zone import PRESS_ZONE
from robots_core import load_robot_model
from robots_core.blocks import ZoneDetection, read_scene
from robots_core.blocks.collision.scene import Scene
from robots_core.blocks.drives.drive_choice import drive_train
from robots_core.blocks.drives.drive_levels import DRIVE_LEVELS
from short_programs import PROGRAMS, SHORTENED, SHORTEST, short_copy
from written_bags import write_bag

from .bag_checks import read_messages
from .both_cells import FIRST, check_both_cells
from .lockstep_runs import COMPARED_RATE, FULL, LockstepRuns

NAMES = sorted(file.name for file in PROGRAMS.glob('*.lua'))
NAMES += ['language/three_axes.lua', 'motion_simulator/on_linear_axis.lua']
CASES = [(name, drive) for name in NAMES for drive in DRIVE_LEVELS]
# Those of one robot, which one cell runs in a row.
EXAMPLES = sorted({file.stem for file in (PROGRAMS / 'language').glob('*.lua')} - {'three_axes'})
NO_TORQUES = 'getJointTorques: the robot measures no torques'
WITHOUT_TORQUES = {'search': NO_TORQUES, 'taught_points': NO_TORQUES}
# Each begins as a program of its own does, without what the one before it has set, and ends as expected.
ALL_EXAMPLES = """-- Robot: kuka_kr210_r2700  IO: ../io/language.yaml  References: guides
local errors = {%s}
for _, name in ipairs{%s} do
  setTool(0, 0, 0, 0, 0, 0)
  setBase(0, 0, 0, 0, 0, 0)
  setPayload(0)
  wait(1) -- for what the PLC does later
  for _, output in ipairs{"gripper", "lamp"} do setDigitalOutput(output, false) end
  setAnalogOutput("valve", 0)
  wait(0.1)
  local ended, found = pcall(call, name)
  local expected = errors[name]
  local as_expected = expected and not ended and found:find(expected, 1, true) or not expected and ended
  assert(as_expected, name .. ": " .. tostring(found))
end
"""


@pytest.mark.parametrize(('name', 'drive'), CASES)
def test_both_cells_do_the_same(name: str, drive: str, lockstep_runs: LockstepRuns, tmp_path: Path) -> None:
    run = lockstep_runs.run(name, drive)
    check_both_cells(run, drive, tmp_path / 'bag')
    # welding_collision.lua commands a motion through the pillar, which is refused.
    assert run.returncode == (1 if name == 'welding_collision.lua' else 0), run.text


@pytest.mark.longest
@pytest.mark.parametrize('drive', DRIVE_LEVELS)
def test_both_cells_do_the_same_in_all_examples(
    drive: str, lockstep_runs: LockstepRuns, tmp_path: Path
) -> None:
    texts = SHORTENED if drive == FULL else SHORTEST
    program = short_copy(tmp_path / 'programs', 'language/tasks.lua', texts).with_name('all.lua')
    # A simulation has neither a person nor a sensor, but recordings of them.
    guides = [*twists('/teach_twist', 'tool', 0.2), *twists('/reference_twist', 'base', 0.2)]
    write_bag(program.parent / 'guides', guides)
    robot = load_robot_model('kuka_kr210_r2700')
    errors = {} if drive_train(drive, robot, robot.home, period=0.01).torque is not None else WITHOUT_TORQUES
    expected = ', '.join(f'{name} = {text!r}' for name, text in errors.items())
    program.write_text(ALL_EXAMPLES % (expected, ', '.join(map(repr, EXAMPLES))))
    run = lockstep_runs.run_file(program, '--drive', drive, rate=COMPARED_RATE)
    assert run.returncode == 0, run.text
    check_both_cells(run, drive, tmp_path / 'bag')


@pytest.mark.parametrize('drive', DRIVE_LEVELS)
def test_both_cells_do_the_same_with_a_person_who_drives(
    drive: str, lockstep_runs: LockstepRuns, tmp_path: Path
) -> None:
    name = 'motion_simulator/cockpit.lua'
    texts = {'LONGEST = 3600': 'LONGEST = 1', 'Cabin: cabin.yaml': 'Cabin: cabin.yaml  References: driver'}
    program = short_copy(tmp_path / 'programs', name, {name: texts})
    write_bag(program.parent / 'driver', [joy(0.05 * k, 0.15, 1.0) for k in range(20)])
    run = lockstep_runs.run_file(program, '--drive', drive, rate=COMPARED_RATE)
    check_both_cells(run, drive, tmp_path / 'bag')
    assert run.returncode == 0, run.text


def test_both_cells_keep_a_speed_limit_alike(lockstep_runs: LockstepRuns, tmp_path: Path) -> None:
    program = tmp_path / 'limited.lua'
    program.write_text(
        '-- Robot: kuka_kr210_r2700\n'
        'ptpJointSpaceAngles(0, -90, 90, 0, 60, 0)\n'
        'setTool(0.1, 0, 0.3, 0, 0, 0)\n'
        'linearRelative(0, 0.2, 0, 0, 0, 0, {blend = 0.05})\n'
        'linearRelative(0, 0, -0.2, 0, 0, 0)\n'
    )
    run = lockstep_runs.run_file(program, '--tool-speed-limit', '0.5', '--operating-mode', 'T1')
    check_both_cells(run, 'second_order', tmp_path / 'bag', tool_speed_limit=0.5, operating_mode='T1')
    places = [message.points[0].positions for message in references(run.bag)]
    robot = load_robot_model('kuka_kr210_r2700')
    frames = np.array([robot.kinematic_model.frame_axes(np.asarray(q))[0] for q in places])
    assert 0.2 < np.linalg.norm(np.diff(frames, axis=0), axis=2).max() * run.rate < 0.25


def test_an_emergency_stop_does_the_same_in_both_cells(lockstep_runs: LockstepRuns, tmp_path: Path) -> None:
    (tmp_path / 'plc.yaml').write_text(
        'signals: {e_stop: digital_input.2}\nemergency_stop: {e_stop: off}\ninitial: {e_stop: 1}\n'
        'rules:\n  - {when: start, after: 0.5, set: {e_stop: 0}}\n'
    )
    program = tmp_path / 'program.lua'
    program.write_text(
        '-- Robot: kuka_kr210_r2700  IO: plc.yaml\nptpJointSpaceAngles(60, -80, 80, 0, 60, 0)\nwait(1)\n'
    )
    run = lockstep_runs.run_file(program)
    assert 'emergency stop by digital_input.2' in run.text
    check_both_cells(run, 'second_order', tmp_path / 'bag')


def test_contact_that_nobody_planned_stops_both_cells_alike(
    lockstep_runs: LockstepRuns, tmp_path: Path
) -> None:
    program = tmp_path / 'program.lua'
    program.write_text(
        f'-- Robot: kuka_kr210_r3100  Contact: {PROGRAMS}/wheel_laboratory/regolith_simulant.yaml\n'
        'setTool(0, 0, 0.39, 0, 0, 0)\n'
        'ptpJointSpacePosition(1.8, 0, 0.63, 90, 0, 180)\n'
        'setSpeed(nil, 0.1)\n'
        'linearRelative(0, 0, -0.1, 0, 0, 0)\n'
    )
    run = lockstep_runs.run_file(program)
    assert run.returncode == 1
    assert 'contact that was not planned: the force on the tool is ' in run.text
    check_both_cells(run, 'second_order', tmp_path / 'bag')


ZONES = PRESS_ZONE + '    closed_by: {press_open: off}\n'


def test_a_robot_waits_before_a_zone_alike_in_both_cells(lockstep_runs: LockstepRuns, tmp_path: Path) -> None:
    (tmp_path / 'scene.yaml').write_text(ZONES)
    (tmp_path / 'plc.yaml').write_text(
        'signals: {press_open: digital_input.1}\n'
        'rules:\n  - {when: start, after: 2.5, set: {press_open: 1}, for: 2.5}\n'
    )
    program = tmp_path / 'program.lua'
    program.write_text(
        '-- Robot: kuka_kr210_r2700  Scene: scene.yaml  IO: plc.yaml\n'
        'ptpJointSpaceAngles(-40, -90, 90, 0, 60, 0, {jointBlend = 5})\n'
        'ptpJointSpaceAngles(-20, -80, 90, 0, 60, 0)\n'
        'wait(2)\n'
        'ptpJointSpaceAngles(0, -90, 90, 0, 60, 0)\n'
    )
    run = lockstep_runs.run_file(program)
    # The zone closes while the robot is in it.
    assert "inside zone 'press'" in run.text
    check_both_cells(run, 'second_order', tmp_path / 'bag')
    zone = read_scene(tmp_path / 'scene.yaml').zones[0]
    robot = load_robot_model('kuka_kr210_r2700')
    clearance = ZoneDetection(robot, Scene(zones=(zone,))).clearance(zone)
    held = [
        clearance.closest(np.asarray(message.points[0].positions))[0]
        for message in references(run.bag)
        if message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec < FIRST + 2.4
    ]
    assert 0.0 < min(held) < 3e-3


def test_a_robot_goes_around_obstacles_alike_in_both_cells(
    lockstep_runs: LockstepRuns, tmp_path: Path
) -> None:
    (tmp_path / 'scene.yaml').write_text(
        'objects:\n  - name: post\n    capsule: {radius: 0.05, length: 1.6}\n'
        '    pose: {position: [1.2, -1.2, 1.0]}\n'
    )
    program = tmp_path / 'program.lua'
    program.write_text(
        '-- Robot: kuka_kr210_r2700  Scene: scene.yaml\n'
        'setAvoid(false, 0.4)\n'
        'ptpJointSpaceAngles(15, -70, 90, 0, 70, 0)\n'
        'ptpJointSpaceAngles({75, -70, 90, 0, 70, 0}, {avoid = true})\n'
        'setAvoid(true)\n'
        'ptpJointSpaceAngles({15, -70, 90, 0, 70, 0}, {jointBlend = 3})\n'
        'ptpJointSpaceAngles(15, -80, 90, 0, 70, 0)\n'
    )
    run = lockstep_runs.run_file(program)
    check_both_cells(run, 'second_order', tmp_path / 'bag')
    final = references(run.bag)[-1].points[0].positions
    np.testing.assert_allclose(np.degrees(final), [15, -80, 90, 0, 70, 0], atol=1e-6)


def references(bag: Path) -> list[Any]:
    return [message for _, message in read_messages(bag, ['/joint_reference'])['/joint_reference']]
