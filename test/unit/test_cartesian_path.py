"""Cartesian paths: derivatives next to differences, ends, shapes, and points that determine no path."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation, RotationSpline

from robots_core import Pose
from robots_core.errors import InvalidInputError
from robots_planning.paths.cartesian_line import CartesianLine
from robots_planning.paths.cartesian_path import CartesianPath
from robots_planning.paths.circular_arc import CircularArc
from robots_planning.paths.pose_spline import PoseSpline


def random_poses(seed: int, count: int) -> list[Pose]:
    rng = np.random.default_rng(seed)
    turns = Rotation.from_rotvec(0.6 * rng.normal(size=(count, 3))).as_matrix()
    return [Pose(r, T) for r, T in zip(rng.normal(size=(count, 3)), turns, strict=True)]


def points(*positions: tuple[float, float, float]) -> list[Pose]:
    return [Pose(np.array(r), np.eye(3)) for r in positions]


def paths() -> dict[str, CartesianPath]:
    a, b, c, d, e = random_poses(3, 5)
    still = Pose(d.r, c.T)
    return {
        'line': CartesianLine(a, b),
        'arc': CircularArc(a, b, c),
        'circle': CircularArc(a, b, a, second_via=c),
        'spline of 2': PoseSpline([a, b]),
        'spline of 3': PoseSpline([a, b, c]),
        'spline': PoseSpline([a, b, c, d, e]),
        'spline that turns and moves in turn': PoseSpline([a, Pose(a.r, b.T), b, c, still, Pose(e.r, c.T)]),
    }


PATHS = paths()


@pytest.mark.parametrize('name', PATHS)
def test_derivatives_are_those_of_the_poses(name: str) -> None:
    path = PATHS[name]
    h = 1e-4
    middles = np.linspace(0.0, 1.0, 43)[1:-1] + 1e-3
    # Differences across a break would see its jump of the third derivative.
    near_break = np.abs(middles[:, None] - path.breaks[1:-1]).min(axis=1, initial=1.0) < 2.0 * h
    s = middles[~near_break & (middles < 1.0 - h)]
    before, here, after = (path.sample(s + offset) for offset in (-h, 0.0, h))
    scale = 1.0 + np.abs(here.x_ss).max()
    # Central differences: step squared times the third derivative, and rounding over the step.
    tolerance = 1e-5 * scale
    np.testing.assert_allclose((after.r - before.r) / (2.0 * h), here.x_s[:, :3], atol=tolerance)
    turns = Rotation.from_matrix(after.T @ before.T.transpose(0, 2, 1)).as_rotvec()
    np.testing.assert_allclose(turns / (2.0 * h), here.x_s[:, 3:], atol=tolerance)
    np.testing.assert_allclose((after.x_s - before.x_s) / (2.0 * h), here.x_ss, atol=tolerance)


@pytest.mark.parametrize('name', PATHS)
def test_is_continuous_with_two_derivatives(name: str) -> None:
    path = PATHS[name]
    inner = path.breaks[1:-1]
    before, after = path.sample(inner - 1e-12), path.sample(inner)
    for quantity in ('r', 'T', 'x_s', 'x_ss'):
        # The iteration for angular velocities ends at 1e-12; a piece may be a hundredth of the path.
        jump = np.abs(getattr(before, quantity) - getattr(after, quantity)).max(initial=0.0)
        assert jump <= 1e-9 * (1.0 + np.abs(getattr(after, quantity)).max(initial=0.0))


@pytest.mark.parametrize('name', PATHS)
@pytest.mark.parametrize(('begin', 'end'), [(0.2, 0.9), (0.8, 0.1), (0.0, 1.0), (0.4, 0.4)])
def test_a_part_has_the_poses_of_the_whole(name: str, begin: float, end: float) -> None:
    path = PATHS[name]
    part, span, s = path.part(begin, end), end - begin, np.linspace(0.0, 1.0, 41)
    ours, theirs = part.sample(s), path.sample(begin + span * s)
    scale = 1.0 + np.abs(theirs.x_ss).max()
    for mine, whole in (
        (ours.r, theirs.r),
        (ours.T, theirs.T),
        (ours.x_s, span * theirs.x_s),
        (ours.x_ss, span**2 * theirs.x_ss),
    ):
        np.testing.assert_allclose(mine, whole, atol=1e-12 * scale)
    assert part.kind == path.kind


@pytest.mark.parametrize('name', PATHS)
def test_length_and_angle_are_those_of_a_fine_polygon(name: str) -> None:
    path = PATHS[name]
    samples = path.sample(np.linspace(0.0, 1.0, 20001))
    length = np.linalg.norm(np.diff(samples.r, axis=0), axis=1).sum()
    angle = np.linalg.norm(
        Rotation.from_matrix(samples.T[1:] @ samples.T[:-1].transpose(0, 2, 1)).as_rotvec(), axis=1
    ).sum()
    # A polygon is shorter by the step squared; a speed with a kink where the path stands still.
    assert path.length == pytest.approx(length, rel=1e-4)
    assert path.angle == pytest.approx(angle, rel=1e-4, abs=1e-12)


def test_a_line_is_straight_and_turns_about_one_axis() -> None:
    start, end = random_poses(5, 2)
    line = CartesianLine(start, end)
    s = np.linspace(0.0, 1.0, 11)
    samples = line.sample(s)
    np.testing.assert_allclose(samples.r, start.r + s[:, None] * (end.r - start.r), atol=1e-15)
    vectors = Rotation.from_matrix(samples.T @ start.T.T).as_rotvec()
    np.testing.assert_allclose(vectors, s[:, None] * line.rotation, atol=1e-14)
    assert end.distance_to(line.end)[1] < 1e-14


def test_a_line_has_the_rates_of_any_path() -> None:
    line, s = PATHS['line'], np.linspace(0.0, 1.0, 7)
    for own, found in zip(line.travel(s), CartesianPath.travel(line, s), strict=True):
        np.testing.assert_allclose(own, found, atol=1e-12)


def test_an_arc_passes_start_via_and_end_in_order_on_one_circle() -> None:
    start, via, end = random_poses(6, 3)
    arc = CircularArc(start, via, end)
    samples = arc.sample(np.linspace(0.0, 1.0, 2001))
    np.testing.assert_allclose(np.linalg.norm(samples.r - arc.center, axis=1), arc.radius, rtol=1e-12)
    np.testing.assert_allclose((samples.r - arc.center) @ arc.normal, 0.0, atol=1e-12)
    assert max(arc.start.distance_to(start)) < 1e-12
    assert max(arc.end.distance_to(end)) < 1e-12
    # A grid point is at most half a step away.
    assert np.linalg.norm(samples.r - via.r, axis=1).min() <= arc.length / 2000.0


def test_the_other_via_point_makes_the_other_arc() -> None:
    start, via, end, other = points((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0), (0.0, -1.0, 0.0))
    assert CircularArc(start, via, end).arc_angle == pytest.approx(np.pi)
    long_way = CircularArc(start, end, via)
    assert long_way.arc_angle == pytest.approx(1.5 * np.pi)
    np.testing.assert_allclose(long_way.normal, [0.0, 0.0, -1.0], atol=1e-15)
    np.testing.assert_allclose(CircularArc(start, other, end).pose(0.5).r, other.r, atol=1e-15)


def test_a_full_circle_passes_both_via_points_in_order_and_closes() -> None:
    start, via, second = points((1.0, 0.0, 0.5), (0.0, 1.0, 0.5), (-1.0, 0.0, 0.5))
    circle = CircularArc(start, via, start, second_via=second)
    assert circle.length == pytest.approx(2.0 * np.pi)
    for s, pose in ((0.25, via), (0.5, second), (1.0, start)):
        np.testing.assert_allclose(circle.pose(s).r, pose.r, atol=1e-15)


def test_a_spline_passes_every_pose() -> None:
    poses = random_poses(8, 7)
    spline = PoseSpline(poses)
    for s, pose in zip(spline.parameters, poses, strict=True):
        assert max(spline.pose(float(s)).distance_to(pose)) < 1e-13


def test_a_spline_through_poses_of_a_line_is_the_line() -> None:
    line = CartesianLine(*random_poses(9, 2))
    spline = PoseSpline([line.pose(s) for s in (0.0, 0.2, 0.35, 0.8, 1.0)])
    s = np.linspace(0.0, 1.0, 50)
    np.testing.assert_allclose(spline.sample(s).r, line.sample(s).r, atol=1e-13)
    np.testing.assert_allclose(spline.sample(s).T, line.sample(s).T, atol=1e-12)


@pytest.mark.parametrize('count', [2, 3, 4, 5, 12])
def test_a_spline_is_that_of_scipy(count: int) -> None:
    rng = np.random.default_rng(count)
    r, T = rng.normal(size=(count, 3)), np.empty((count, 3, 3))
    T[0] = np.eye(3)
    for k, turn in enumerate(Rotation.from_rotvec(0.5 * rng.normal(size=(count - 1, 3))).as_matrix()):
        T[k + 1] = turn @ T[k]
    spline = PoseSpline([Pose(*pose) for pose in zip(r, T, strict=True)])
    s = np.linspace(0.0, 1.0, 100)
    samples = spline.sample(s)
    np.testing.assert_allclose(samples.r, CubicSpline(spline.breaks, r)(s), atol=1e-13)
    by_scipy = RotationSpline(spline.breaks, Rotation.from_matrix(T))
    # SciPy's iteration ends after ten steps, or when angular velocities change by less than 1e-9.
    np.testing.assert_allclose(samples.T, by_scipy(s).as_matrix(), atol=1e-8)
    np.testing.assert_allclose(
        samples.x_s[:, 3:], np.einsum('mij,mj->mi', samples.T, by_scipy(s, 1)), atol=1e-6
    )


def test_a_spline_whose_orientation_is_not_smooth_is_refused() -> None:
    turns = np.array([[0.0, 2.0, 0.0], [0.0, 3.0, 0.0], [3.0, 0.0, 0.0]])
    poses = [Pose.identity()]
    for distance, turn in zip((1.0, 100.0, 100.0), Rotation.from_rotvec(turns).as_matrix(), strict=True):
        poses.append(Pose(poses[-1].r + np.array([distance, 0.0, 0.0]), turn @ poses[-1].T))
    with pytest.raises(
        InvalidInputError, match='is not smooth: it turns by 3 rad from pose 1 to pose 2; put a'
    ):
        PoseSpline(poses)


@pytest.mark.parametrize(
    ('positions', 'message'),
    [
        ([(0.0, 0.0, 1.0), (0.0, 0.0, 2.0), (0.0, 0.0, 3.0)], r'lie on a line .* move via aside'),
        ([(0.0, 0.0, 1.0), (0.0, 0.0, 3.0), (0.0, 0.0, 2.0)], r'\(0\.0000, 0\.0000, 3\.0000\) m'),
        ([(1.0, 0.0, 0.0), (1.0, 0.0, 0.0), (2.0, 0.0, 0.0)], 'start and via of the arc coincide at'),
        ([(1.0, 0.0, 0.0), (2.0, 0.0, 0.0), (2.0, 0.0, 0.0)], 'via and end of the arc coincide at'),
        ([(1.0, 0.0, 0.0), (2.0, 0.0, 0.0), (1.0, 0.0, 0.0)], 'a full circle needs a second via point'),
    ],
)
def test_points_that_make_no_arc_are_named(positions: list[tuple[float, float, float]], message: str) -> None:
    start, via, end = points(*positions)
    with pytest.raises(InvalidInputError, match=message):
        CircularArc(start, via, end)


def test_a_circle_that_does_not_close_is_refused() -> None:
    start, via, second = points((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0))
    with pytest.raises(InvalidInputError, match=r'is 2 m off'):
        CircularArc(start, via, second, second_via=points((0.0, -1.0, 0.0))[0])
    with pytest.raises(InvalidInputError, match='second via'):
        CircularArc(start, via, start, second_via=via)


def test_a_spline_needs_different_poses() -> None:
    a, b = random_poses(10, 2)
    with pytest.raises(InvalidInputError, match='at least 2 poses, got 1'):
        PoseSpline([a])
    with pytest.raises(InvalidInputError, match=r'poses 1 and 2 of the spline coincide at \('):
        PoseSpline([a, b, b, a])
