"""Motions of programs in a simulated cell: drives, settings, blends, switches on the path, payloads."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from robots_controller.simulate import simulate
from robots_controller.simulation.record.events import OutputChanged
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core import load_robot_model
from robots_core.blocks.multibody.loaded_robot import loaded_robot
from robots_core.pose import Pose
from robots_planning.motion_settings import NOTHING

from .simulated_program import PERIOD, PROGRAMS, ROBOT, outputs, run_text


@pytest.fixture(scope='module')
def welding() -> SimulationRun:
    return simulate(PROGRAMS / 'welding.lua', robot=ROBOT, drive='ideal')


def test_drives_stand_at_the_targets_and_references_keep_the_plan(welding: SimulationRun):
    for motion in welding.motions:
        assert motion.plan is not None
        end = welding.position[np.searchsorted(welding.time, motion.ended)]
        assert end == pytest.approx(motion.plan.trajectory.position[-1], abs=1e-5)  # the goal tolerance
        # Smoothing takes the planned duration and its window, settling up to the next two feedbacks.
        late = motion.ended - motion.started - motion.plan.duration
        assert 0.0 <= late <= 0.02 + 4 * PERIOD


def test_rigid_body_drives_report_their_torques():
    run = simulate(PROGRAMS / 'welding.lua', robot=ROBOT, drive='rigid_body')
    assert run.ok
    assert run.torque is not None
    assert np.abs(run.torque).max() > 100.0  # N m: it carries its own weight


def test_elastic_gears_with_stiction_come_to_rest_at_the_target(tmp_path: Path):
    text = 'ptpJointSpaceAngles(60, -70, -35, 45, 110, 45)\nptpJointSpaceAngles(0, 20, 90, 0, 45, 0)\n'
    text += 'linearRelative(0, 0, -0.2, 0, 0, 0)\n'
    run = run_text(tmp_path, text, robot='manutec_r3', drive='rigid_body')
    assert run.ok, run.error
    assert len(run.motions) == 3


def test_settings_hold_as_long_as_the_program_says(tmp_path: Path):
    move = 'ptpJointSpaceAngles({}, -90, 90, 0, 90, 0)\n'
    run = run_text(tmp_path, move.format(0) + move.format(20) + 'setSpeed(0.1)\n' + move.format(0))
    fast, slow = (motion.plan for motion in run.motions[1:])
    assert fast is not None
    assert slow is not None
    assert slow.report.uses['velocity'].ratio == pytest.approx(0.1, rel=1e-3)  # the planner's margin
    assert slow.duration > 2.0 * fast.duration
    assert [motion.settings.speed_fraction for motion in run.motions] == [1.0, 1.0, 0.1]


def test_an_override_slows_the_motion_under_way(tmp_path: Path):
    move = 'ptpJointSpaceAngles(40, -90, 90, 0, 90, 0)'
    full, half = (run_text(tmp_path, f'{before} {move}') for before in ('', 'setOverride(0.5)'))
    assert half.motions[0].plan is not None
    # Twice as long except for smoothing and settling, which the override does not touch.
    assert half.duration == pytest.approx(full.duration + half.motions[0].plan.duration, abs=2 * PERIOD)


def test_blended_motions_run_through(tmp_path: Path):
    text = """
    ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)
    linearRelative(0, 0.3, 0, 0, 0, 0, {%s})
    linearRelative(0, 0, -0.3, 0, 0, 0)
    """
    stops, blends = (run_text(tmp_path, text % option) for option in ('', 'blend = 0.05'))
    assert stops.ok
    assert blends.ok
    assert [motion.message for motion in blends.motions] == ['reached', 'passed', 'reached']
    assert blends.motions[1].chain == (blends.motions[1].id, blends.motions[2].id)
    assert blends.motions[1].end_on_plan == blends.motions[2].start_on_plan
    assert blends.duration < stops.duration


def test_outputs_switch_on_the_path(tmp_path: Path):
    run = run_text(
        tmp_path,
        'ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)\n'
        'local place = {distance_before_end = 0.1, output = 1, value = true}\n'
        'linearRelative(0, 0, -0.4, 0, 0, 0, {on_path = place})',
    )
    (switched,) = outputs(run)
    motion = run.motions[-1]
    assert motion.started < switched[0] < motion.ended
    position = run.position[np.searchsorted(run.time, switched[0])]
    robot = load_robot_model(ROBOT)
    (r, _), (end, _) = (robot.direct_kinematics(q) for q in (position, run.position[-1]))
    # One period at the 0.5 m/s of the tool, and the smoothing's lag of 10 ms before which the plan is.
    assert np.linalg.norm(end - r) == pytest.approx(0.1, abs=0.5 * (PERIOD + 0.012))


def test_a_place_on_a_chain_is_that_of_its_motion_where_the_robot_comes_back(tmp_path: Path):
    run = run_text(
        tmp_path,
        """ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)
        local function go(x, z, output)
          linearRelative(x, 0, z, 0, 0, 0,
            {blend = 0.02, on_path = {distance_before_end = 0.1, output = output, value = true}})
        end
        go(0, -0.4, 1) go(0.2, 0, 2) go(-0.2, 0, 3) go(0, 0.2, 4)
        linearRelative(0, 0, 0.1, 0, 0, 0)""",
    )
    assert run.ok
    motions, robot = run.motions[1:], load_robot_model(ROBOT)
    assert all(len(motion.chain) == 5 for motion in motions)
    start = np.array(robot.direct_kinematics(np.radians([0, -90, 90, 0, 90, 0]))[0])
    corners = start + np.cumsum([[0, 0, -0.4], [0.2, 0, 0], [-0.2, 0, 0], [0, 0, 0.2]], axis=0)
    for (time, _), motion, corner in zip(outputs(run), motions, corners, strict=False):
        # Within its own motion, the smoothing's lag behind its plan.
        after = time - motion.started
        assert motion.start_on_plan < after < motion.end_on_plan
        position = run.position[np.searchsorted(run.time, time)]
        distance = np.linalg.norm(corner - robot.direct_kinematics(position)[0])
        # As above; and the blend is shorter than the corner, by less than its zone.
        assert distance == pytest.approx(0.1, abs=0.5 * (PERIOD + 0.012) + 0.02)


def test_drives_carry_the_cells_payload_and_then_that_of_the_program(tmp_path: Path):
    stand = 'ptpJointSpaceAngles(0, -60, 60, 0, 60, 0) wait(1)\n'
    text = stand + 'setPayload(0)\n' + 'ptpJointSpaceAngles(0, -60, 60, 0, 60, 1) wait(1)'
    payload = (80.0, 0.0, 0.0, 0.3)
    run = run_text(tmp_path, text, drive='rigid_body', payload=payload)
    assert run.ok
    assert run.torque is not None
    robot = load_robot_model(ROBOT)
    q, still = np.radians([0, -60, 60, 0, 60, 0]), np.zeros(6)
    empty, loaded = (loaded_robot(robot, p).rigid_dynamics(q, still, still)[0][1] for p in (NOTHING, payload))
    first = np.searchsorted(run.time, run.motions[0].ended + 0.9)
    # Friction holds a part, which is small beside the weight of 80 kg.
    assert run.torque[first, 1] == pytest.approx(loaded, abs=0.2 * abs(loaded - empty))
    assert run.torque[-1, 1] == pytest.approx(empty, abs=0.2 * abs(loaded - empty))


def test_ur_robots_are_programmed_with_rotation_vectors_as_their_maker_s(tmp_path: Path):
    text = """
        ptpJointSpacePosition(-0.45, -0.13, 0.45, 120, -125, 3)
        local p = getCartesianPosition()
        print(string.format('%.3f %.3f %.3f', p[4], p[5], p[6]))
        setOrientationConvention('zyx')
        ptpCartesianSpace(-0.45, -0.13, 0.4, table.unpack(getCartesianPosition(), 4))
    """
    run = run_text(tmp_path, text, robot='ur5e')
    assert run.state == 'FINISHED'
    assert run.printed == ('120.000 -125.000 3.000',)
    robot = load_robot_model('ur5e')
    T = [
        robot.direct_kinematics(run.reference[-1, 0])[1],
        Pose.from_angles(np.zeros(3), np.radians([120.0, -125.0, 3.0]), 'rotation_vector').T,
    ]
    np.testing.assert_allclose(T[0], T[1], atol=1e-6)


def test_equal_switches_of_two_motions_belong_to_their_own_lines(tmp_path: Path):
    text = """ptpJointSpaceAngles(0, -90, 90, 0, 45, 0)
        local on = {distance_after_start = 0.05, output = 1, value = 1}
        local off = {distance_before_end = 0.02, output = 1, value = 0}
        linearRelative(0, 0.2, 0, 0, 0, 0, {blend = 0.01, on_path = {on, off}})
        linearRelative(0, 0, 0.2, 0, 0, 0, {on_path = {on, off}})"""
    run = run_text(tmp_path, text)
    changes = [event for event in run.events if isinstance(event, OutputChanged)]
    assert [(change.value, change.line) for change in changes] == [(1.0, 4), (0.0, 4), (1.0, 5), (0.0, 5)]


def test_a_motion_that_would_take_days_fails_in_its_line(tmp_path: Path):
    run = run_text(tmp_path, 'setSpeed(1e-6)\nptpJointSpaceAngles(10, -80, 90, 0, 60, 0)')
    assert str(run.error).endswith(
        ':2: ptpJointSpaceAngles: the motion takes 348872 s or more; allowed are 3600 s'
    )
