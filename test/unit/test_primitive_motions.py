"""A program's motions as sequences of primitives, with the driver played by the test."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache

import numpy as np
import pytest

from robots_controller.cell.path_switching import PathSwitching
from robots_controller.cell.primitive_motions import PrimitiveControl, PrimitiveMotions
from robots_controller.program.motions.motion_command import MotionCommand, OutputChange, PathSwitch
from robots_controller.program.motions.planned_primitive import PrimitivePlanner
from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.blocks.following.guide import Guide
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import PlanningError, ProgramError
from robots_core.validation import Array
from robots_planning.commands.motion_primitives import MotionPrimitive
from robots_planning.motion_kinds import CIRCLE, JOINT, JOINT_TO_POSE, LINE, SPLINE, MotionKind
from robots_planning.motion_settings import MotionSettings

HOME = np.radians([0.0, -90.0, 90.0, 0.0, 45.0, 0.0])
BLENDS = {'blend_zone': 0.02, 'joint_blend_zone': 0.05}


@cache
def robot() -> BaseRobotModel:
    return load_robot_model('ur5e')


class PlayedDriver:
    """See `PrimitiveDriver`: the test says how it goes on."""

    name = '/driver/motion_sequence'

    def __init__(self) -> None:
        self.served = True
        self.sequences: list[list[MotionPrimitive]] = []
        self.canceled = 0
        self.q: Array = HOME
        self.motions = PrimitiveMotions(robot(), self, lambda: self.q)
        self.control = PrimitiveControl(self.motions)
        self.results: list[MotionResult] = []
        self.switched: list[OutputChange] = []
        self.motions.on_result = self.results.append
        self.motions.switching = PathSwitching(robot().direct_kinematics, self.switched.append)

    def send(self, primitives: Sequence[MotionPrimitive]) -> None:
        self.sequences.append(list(primitives))

    def cancel(self) -> None:
        self.canceled += 1

    def wake(self) -> None:
        self.motions.step()

    @property
    def ended(self) -> list[tuple[str, str]]:
        return [(one.id, one.message) for one in self.results]


def tool(q: Array = HOME) -> Pose:
    return Pose(*robot().direct_kinematics(q))


def aside(*by: float) -> Pose:
    return Pose(tool().r + np.array(by), tool().T)


def commanded(
    kind: MotionKind, *target: Array | Pose, switches: tuple[PathSwitch, ...] = ()
) -> MotionCommand:
    (last,) = target[-1:]
    if not isinstance(last, Pose):
        return MotionCommand(kind, 1, 'f', q=last, switches=switches)
    poses = tuple(one for one in target if isinstance(one, Pose))
    return MotionCommand(kind, 1, 'f', pose=last, path=poses if len(poses) > 1 else (), switches=switches)


def send(driver: PlayedDriver, command: MotionCommand, **settings: object) -> str:
    """As `ProgramMotions` does."""
    motions = driver.motions
    assert motions.plans(command)
    refused: list[PlanningError] = []
    if motions.differs(settings):
        motions.configure(settings, lambda error: refused.append(error) if error else None, moving=True)
    assert not refused
    id_ = motions.next_id()
    assert motions.switching is not None
    motions.switching.sent(id_, command)
    motions.command(id_, command)
    return id_


def test_motions_become_primitives_with_the_speeds_of_the_program() -> None:
    driver = PlayedDriver()
    first = send(driver, commanded(JOINT, HOME + 0.1), speed_fraction=0.5, acceleration_fraction=0.25)
    ((ptp,),) = driver.sequences
    axes = robot().axes_data
    assert (ptp.kind, ptp.blend_radius) == (JOINT, 0.0)
    np.testing.assert_array_equal(np.asarray(ptp.target), HOME + 0.1)
    assert ptp.arguments == {
        'velocity': 0.5 * axes.velocity.max(),
        'acceleration': 0.25 * axes.acceleration.max(),
    }
    driver.motions.ended()
    driver.q = HOME
    second = send(
        driver, commanded(LINE, aside(0.0, 0.0, 0.1)), cartesian_speed=0.1, cartesian_acceleration=1.0
    )
    line = driver.sequences[-1][0]
    assert (line.kind, line.target) == (LINE, line.target)
    assert line.arguments == {'velocity': 0.1, 'acceleration': 1.0}
    driver.motions.ended()
    assert driver.ended == [(first, 'reached'), (second, 'reached')]


def test_poses_are_in_the_base_and_of_the_tool() -> None:
    driver = PlayedDriver()
    base, at = (0.3, 0.0, 0.1, 0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 1.0)
    settings = MotionSettings(base=base, tool=at)
    goal = aside(0.0, 0.05, 0.1) @ settings.tool_pose
    in_frame = Pose(goal.r - np.array(base[:3]), goal.T)
    send(driver, commanded(LINE, in_frame), base=base, tool=at)
    target = driver.sequences[0][0].target
    assert isinstance(target, Pose)
    np.testing.assert_allclose(target.r, goal.r, atol=1e-12)


def test_a_pose_is_reached_in_the_configuration_of_the_program() -> None:
    driver = PlayedDriver()
    pose = aside(0.0, 0.1, 0.0)
    send(driver, commanded(JOINT_TO_POSE, pose))
    ((ptp,),) = driver.sequences
    assert ptp.kind is JOINT
    np.testing.assert_allclose(tool(np.asarray(ptp.target)).r, pose.r, atol=1e-9)


def test_motions_that_blend_are_one_sequence() -> None:
    driver = PlayedDriver()
    ids = [
        send(driver, commanded(JOINT, HOME + 0.1 * np.eye(6)[1]), **BLENDS),
        send(
            driver,
            commanded(LINE, aside(0.0, 0.0, -0.1)),
            **BLENDS,
        ),
    ]
    assert not driver.sequences
    ids.append(send(driver, commanded(JOINT, HOME)))
    ((first, second, last),) = driver.sequences
    radius = MotionPrimitive.commanded(
        robot(), JOINT, HOME + 0.1 * np.eye(6)[1], MotionSettings(**BLENDS)
    ).blend_radius
    assert (first.blend_radius, second.blend_radius, last.blend_radius) == (radius, 0.02, 0.0)
    driver.motions.advanced(0)
    assert not driver.results
    driver.motions.advanced(2)
    assert driver.ended == [(ids[0], 'passed'), (ids[1], 'passed')]
    driver.motions.ended()
    assert driver.ended[-1] == (ids[2], 'reached')


def test_the_radius_of_a_joint_motion_is_read_back_as_its_zone() -> None:
    settings = MotionSettings(joint_blend_zone=0.05)
    primitive = MotionPrimitive.commanded(robot(), JOINT, HOME, settings)
    again = primitive.settings(robot(), MotionSettings(), last=False)
    assert again.joint_blend_zone == pytest.approx(0.05, rel=1e-12)


def test_a_motion_that_nothing_follows_is_sent_when_the_program_says_so() -> None:
    driver = PlayedDriver()
    send(driver, commanded(JOINT, HOME + 0.1), **BLENDS)
    assert not driver.sequences
    driver.motions.flush(BLENDS)
    ((only,),) = driver.sequences
    assert only.blend_radius == 0.0


def test_a_paused_robot_is_stopped_and_goes_on_with_what_is_left() -> None:
    driver = PlayedDriver()
    ids = [
        send(driver, commanded(LINE, aside(0.0, 0.0, 0.1)), **BLENDS),
        send(driver, commanded(JOINT, HOME)),
    ]
    driver.motions.advanced(1)
    driver.control.request('pause')
    driver.control.request('pause')
    assert driver.canceled == 1
    driver.motions.ended(canceled=True)
    assert len(driver.sequences) == 1
    driver.control.request('resume')
    assert [one.kind for one in driver.sequences[1]] == [JOINT]
    driver.motions.ended()
    assert driver.ended == [(ids[0], 'passed'), (ids[1], 'reached')]


def test_an_arc_goes_on_through_a_point_that_lies_ahead() -> None:
    driver = PlayedDriver()
    via, end = aside(0.1, 0.1, 0.0), aside(0.2, 0.0, 0.0)
    command = commanded(CIRCLE, via, end)
    planned = PrimitivePlanner(robot(), 'driver').plan('1', command, {}, HOME)
    send(driver, command)
    driver.control.request('pause')
    driver.q = planned.trajectory.sample(np.array([0.7 * planned.trajectory.duration]))[0][0]
    driver.motions.ended(canceled=True)
    driver.control.request('resume')
    ahead, last = driver.sequences[1][0].target  # type: ignore[misc]
    assert last is end
    centre = aside(0.1, 0.0, 0.0).r
    assert np.linalg.norm(ahead.r - centre) == pytest.approx(0.1, abs=1e-4)
    assert np.linalg.norm(ahead.r - end.r) < np.linalg.norm(tool(driver.q).r - end.r)


def test_a_cancellation_ends_all_motions() -> None:
    driver = PlayedDriver()
    ids = [send(driver, commanded(JOINT, HOME + 0.1)), send(driver, commanded(JOINT, HOME))]
    driver.control.request('cancel')
    driver.control.request('cancel')
    assert (driver.canceled, driver.results) == (1, [])
    driver.motions.ended(canceled=True)
    assert driver.ended == [(id_, 'canceled') for id_ in ids]
    assert not any(one.ok for one in driver.results)
    assert len(driver.sequences) == 1
    driver.control.request('cancel')  # nothing moves
    assert driver.canceled == 1


def test_a_cancellation_while_paused_ends_what_is_left() -> None:
    driver = PlayedDriver()
    id_ = send(driver, commanded(JOINT, HOME + 0.1))
    driver.control.request('pause')
    driver.motions.ended(canceled=True)
    driver.control.request('cancel')
    assert driver.ended == [(id_, 'canceled')]
    send(driver, commanded(JOINT, HOME + 0.1))  # the next program is not paused
    assert len(driver.sequences) == 2


@pytest.mark.parametrize(
    ('end', 'message'),
    [
        (lambda motions: motions.ended('protective stop'), 'protective stop'),
        (
            lambda motions: motions.ended(canceled=True),
            '/driver/motion_sequence has canceled the motion',
        ),
    ],
)
def test_a_motion_that_the_driver_ends_fails_with_those_after_it(
    end: Callable[[PrimitiveMotions], None], message: str
) -> None:
    driver = PlayedDriver()
    ids = [send(driver, commanded(JOINT, HOME + 0.1)), send(driver, commanded(JOINT, HOME))]
    end(driver.motions)
    assert driver.ended == [(id_, message) for id_ in ids]


def test_the_override_scales_the_sequences_that_follow_and_zero_holds_the_robot() -> None:
    driver = PlayedDriver()
    driver.control.set_override(0.5)
    send(driver, commanded(LINE, aside(0.0, 0.0, 0.1)), cartesian_speed=0.2)
    assert driver.sequences[0][0].arguments['velocity'] == pytest.approx(0.1)
    driver.control.set_override(0.0)
    driver.motions.ended(canceled=True)
    assert (driver.canceled, len(driver.sequences)) == (1, 1)
    driver.control.set_override(1.0)
    assert driver.sequences[1][0].arguments['velocity'] == pytest.approx(0.2)


def test_outputs_switch_where_the_robot_is_on_the_path() -> None:
    driver = PlayedDriver()
    switch = PathSwitch('distance_after_start', 0.05, 'digital', 3, 1.0)
    command = commanded(LINE, aside(0.0, 0.0, 0.1), switches=(switch,))
    planned = PrimitivePlanner(robot(), 'driver').plan('1', command, {}, HOME).trajectory
    send(driver, command)
    for part, switched in ((0.3, 0), (0.7, 1)):
        driver.q = planned.sample(np.array([part * planned.duration]))[0][0]
        driver.motions.check(0.0)
        assert len(driver.switched) == switched


@pytest.mark.parametrize(
    ('command', 'settings', 'complaint'),
    [
        (
            commanded(SPLINE, aside(0.1, 0.0, 0.0), aside(0.1, 0.1, 0.0)),
            {},
            'PTPCARTESIAN spline is no motion primitive',
        ),
        (commanded(JOINT, HOME + 9.0), {}, 'is outside its limits'),
        (commanded(LINE, aside(5.0, 0.0, 0.0)), {}, 'reach'),
        (commanded(JOINT, HOME + 0.1), {'avoid': True}, 'cannot go around obstacles'),
    ],
)
def test_what_is_no_primitive_or_breaks_a_limit_is_refused_before_anything_moves(
    command: MotionCommand, settings: dict[str, object], complaint: str
) -> None:
    driver = PlayedDriver()
    send(driver, command, **settings)
    (result,) = driver.results
    assert not result.ok
    assert complaint in result.message
    assert not driver.sequences


def test_settings_that_are_none_are_refused() -> None:
    driver = PlayedDriver()
    refused: list[PlanningError | None] = []
    driver.motions.configure({'cartesian_speed': 1e9}, refused.append, moving=False)
    assert '/driver/motion_sequence refuses the settings' in str(refused[0])


def test_a_robot_that_measures_nothing_is_not_moved() -> None:
    driver = PlayedDriver()
    driver.motions = PrimitiveMotions(robot(), driver, lambda: None)
    driver.motions.on_result = driver.results.append
    driver.motions.command('1', commanded(JOINT, HOME))
    assert 'no joint_states received' in driver.results[0].message


def test_nothing_guides_a_robot_that_takes_whole_motions() -> None:
    motions = PlayedDriver().motions
    motions.check_guide(Guide.NONE)
    for guide in (Guide.SENSOR, Guide.PERSON):
        with pytest.raises(ProgramError, match='takes motion primitives, and cannot be guided'):
            motions.check_guide(guide)
