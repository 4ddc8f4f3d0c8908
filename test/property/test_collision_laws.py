"""Laws of collision detection: against brute-force sampling, between engines, and along paths."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import trimesh
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.blocks import AttachedObject, CollisionDetection, JointPath, Proximity, Scene, SceneObject
from robots_core.robot_model.shapes import Box, Capsule, Cylinder, Geometry, Mesh, Sphere
from robots_core.robot_model.urdf.triangle_mesh import triangle_mesh

ENGINES = ('fcl', 'coal')
# Engines are believed to 1e-5 m; corrected answers are better.
ENGINE_TOLERANCE = 1e-5  # m
SPACING = 0.03  # m, of brute-force points
REACH = SPACING / np.sqrt(3.0)  # m, from a point of a triangle with such edges to a vertex, at most


@cache
def robot() -> BaseRobotModel:
    return load_robot_model('debris_arm')


lengths = st.floats(0.02, 0.4)
seeds = st.integers(0, 2**32 - 1)


def bowl() -> trimesh.Trimesh:
    """A box without its lid: concave, one piece, open above."""
    outer = trimesh.creation.box((0.4, 0.3, 0.2))
    return trimesh.Trimesh(outer.vertices, outer.faces[outer.face_normals[:, 2] < 0.5])


@st.composite
def geometries(draw: st.DrawFn) -> Geometry:
    kind = draw(st.sampled_from(('box', 'sphere', 'cylinder', 'capsule', 'hull', 'bowl')))
    a, b, c = draw(lengths), draw(lengths), draw(lengths)
    match kind:
        case 'box':
            return Box((a, b, c))
        case 'sphere':
            return Sphere(a)
        case 'cylinder':
            return Cylinder(a, b)
        case 'capsule':
            return Capsule(a, b)
        case 'hull':
            points = np.random.default_rng(draw(seeds)).normal(size=(20, 3)) * [a, b, c]
            hull = trimesh.convex.convex_hull(points)
            return Mesh(hull.vertices, hull.faces)
    shell = bowl()
    return Mesh(shell.vertices * [1.0, 1.0 + a, 1.0 + b], shell.faces)


@st.composite
def poses(draw: st.DrawFn, spread: float = 0.6) -> Pose:
    rng = np.random.default_rng(draw(seeds))
    position = rng.uniform(-spread, spread, 3)
    if draw(st.booleans()):  # faces and edges that are parallel on purpose
        return Pose(np.round(position, 1), np.eye(3))
    return Pose(position, Rotation.random(random_state=rng).as_matrix())


# Far from the robot's own body, which these laws leave out.
PLACE = Pose(np.array([20.0, 0.0, 0.0]), np.eye(3))


def two_objects(attached: Geometry, at: Pose, standing: Geometry, pose: Pose) -> Scene:
    """One attached and one standing object, by their poses where the robot is at home."""
    tool0 = Pose(*robot().direct_kinematics(robot().home))
    return Scene(
        (SceneObject('obstacle', standing, pose),),
        (AttachedObject('tool', attached, tool0.inverse() @ at),),
        frozenset(('tool', shape.name) for shape in robot().collision_model.shapes),
    )


def pair(
    first: Geometry, second: Geometry, pose: Pose, engine: str
) -> tuple[CollisionDetection, np.ndarray, Pose, Pose]:
    """A detection of one attached and one standing object, a posture, and the objects' poses."""
    scene = two_objects(first, PLACE, second, PLACE @ pose)
    return CollisionDetection(robot(), scene=scene, engine=engine), robot().home, PLACE, PLACE @ pose


def proximity(detection: CollisionDetection, q: np.ndarray) -> Proximity:
    (found,) = (
        item for item in detection.distances(q, 10.0) if (item.first, item.second) == ('tool', 'obstacle')
    )
    return found


def cloud(geometry: Geometry, pose: Pose) -> np.ndarray:
    """Points on a geometry's surface, at most `SPACING` apart; all of them in the geometry."""
    mesh = triangle_mesh(geometry)
    vertices, _ = trimesh.remesh.subdivide_to_size(mesh.vertices, mesh.faces, SPACING, max_iter=20)
    return pose.r + vertices @ pose.T.T


def depth(geometry: Geometry, local: np.ndarray) -> float:
    """How far a point is outside of a convex geometry, m, in at least one direction; below 0 inside."""
    x, y, z = local
    match geometry:
        case Box(size):
            return float((np.abs(local) - 0.5 * np.array(size)).max())
        case Sphere(radius):
            return float(np.linalg.norm(local) - radius)
        case Cylinder(radius, length):
            return float(max(np.hypot(x, y) - radius, abs(z) - 0.5 * length))
        case Capsule(radius, length):
            return float(np.linalg.norm([x, y, max(abs(z) - 0.5 * length, 0.0)]) - radius)
        case Mesh():
            mesh = triangle_mesh(geometry)
            if mesh.is_watertight:
                planes = np.einsum('ij,ij->i', local - mesh.triangles[:, 0], mesh.face_normals)
                return float(planes.max())
            return float(trimesh.proximity.closest_point_naive(mesh, local[None])[1][0])
    raise AssertionError(geometry)


@settings(max_examples=50)
@given(geometries(), geometries(), poses(), st.sampled_from(ENGINES))
def test_distance_agrees_with_points_all_over_both_surfaces(
    first: Geometry, second: Geometry, pose: Pose, engine: str
):
    detection, q, at_first, at_second = pair(first, second, pose, engine)
    found = proximity(detection, q)
    points_first, points_second = cloud(first, at_first), cloud(second, at_second)
    sampled = float(cKDTree(points_second).query(points_first)[0].min())
    # All sampled points belong to the bodies: none can be closer than the distance.
    assert found.distance <= sampled + ENGINE_TOLERANCE
    if not found.in_contact:
        # Nearest points have samples within reach; chords of 32 sections cut off r (1 - cos(pi / 32)).
        sagitta = 0.05 * max(getattr(body, 'radius', 0.0) for body in (first, second))
        assert found.distance >= sampled - 2.0 * (REACH + sagitta)
    assert found.in_contact == (('tool', 'obstacle') in detection.contacts(q))


@settings(max_examples=50)
@given(geometries(), geometries(), poses(), st.sampled_from(ENGINES))
def test_nearest_points_lie_on_both_bodies_at_their_distance(
    first: Geometry, second: Geometry, pose: Pose, engine: str
):
    detection, q, at_first, at_second = pair(first, second, pose, engine)
    found = proximity(detection, q)
    assume(not found.in_contact)
    between = float(np.linalg.norm(found.point_second - found.point_first))
    assert abs(between - found.distance) <= ENGINE_TOLERANCE
    for geometry, at, point in (
        (first, at_first, found.point_first),
        (second, at_second, found.point_second),
    ):
        local = at.T.T @ (point - at.r)
        # Not outside, and not inside either: nearest points are on the surface.
        assert abs(depth(geometry, local)) <= 2.0 * ENGINE_TOLERANCE


@settings(max_examples=30)
@given(geometries(), geometries(), poses())
def test_libraries_find_contacts_alike(first: Geometry, second: Geometry, pose: Pose):
    fcl, coal = (pair(first, second, pose, engine) for engine in ENGINES)
    if proximity(fcl[0], fcl[1]).distance > ENGINE_TOLERANCE:  # touching bodies may count as either
        assert fcl[0].contacts(fcl[1]) == coal[0].contacts(coal[1])


@settings(max_examples=30)
@given(geometries(), geometries(), poses(), seeds)
def test_distance_does_not_depend_on_where_both_stand(
    first: Geometry, second: Geometry, pose: Pose, seed: int
):
    """Moved together as one body, two objects keep their distance; exchanged too."""
    rng = np.random.default_rng(seed)
    moved = Pose(PLACE.r + rng.uniform(-1.0, 1.0, 3), Rotation.random(random_state=rng).as_matrix())
    distances = []
    for a, b, relative, place in (
        (first, second, pose, PLACE),
        (first, second, pose, moved),
        (second, first, pose.inverse(), moved),
    ):
        detection = CollisionDetection(robot(), scene=two_objects(a, place, b, place @ relative))
        distances.append(proximity(detection, robot().home).distance)
    assert np.ptp(distances) <= 2.0 * ENGINE_TOLERANCE


# -- paths -----------------------------------------------------------------------------------------------

TOOL = AttachedObject('tool', Capsule(0.02, 0.2), Pose(np.array([0.0, 0.0, 0.15]), np.eye(3)))


@st.composite
def paths(draw: st.DrawFn) -> JointPath:
    """Quintics through random points, as bent as a robot's motion or more."""
    axes = robot().axes_data
    low, high = np.maximum(axes.lower, -2.5), np.minimum(axes.upper, 2.5)
    rng = np.random.default_rng(draw(seeds))
    count = draw(st.integers(2, 4))
    n = robot().num_axes
    return JointPath(
        np.concatenate([[0.0], np.cumsum(rng.uniform(0.1, 1.0, count - 1))]),
        rng.uniform(low, high, (count, n)),
        rng.uniform(-2.0, 2.0, (count, n)),
        rng.uniform(-5.0, 5.0, (count, n)),
    )


@settings(max_examples=30)
@given(paths(), st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_axes_turn_no_farther_than_the_bounds(path: JointPath, one: float, other: float):
    low, high = sorted((one * path.end, other * path.end))
    middle = 0.5 * (low + high)
    turn = path.turn(low, middle, high)
    q = np.array([path.sample(t) for t in np.linspace(low, high, 50)])
    # Rounding of sums of some hundred steps.
    assert (np.abs(q - path.sample(middle)).max(axis=0) <= turn + 1e-12).all()


@settings(max_examples=30)
@given(paths(), st.floats(0.02, 0.98), poses(0.0), st.sampled_from((1e-3, 1e-4, 1e-5)))
def test_no_obstacle_is_so_thin_that_it_is_jumped_over(
    path: JointPath, part: float, turned: Pose, thickness: float
):
    """A sheet that the tool cuts through somewhere is found, and not later than there."""
    time = part * path.end
    centre = Pose(*robot().direct_kinematics(path.sample(time))) @ TOOL.pose
    sheet = SceneObject('sheet', Box((thickness, 0.05, 0.05)), Pose(centre.r, turned.T))
    detection = CollisionDetection(robot(), scene=Scene((sheet,), (TOOL,)))
    found = detection.first_approach(path)
    assert found is not None
    assert found.time <= time + 1e-9
    closest = detection.closest_approach(path)
    assert closest is not None
    assert closest.proximity.distance <= 1e-3  # its tolerance


@settings(max_examples=15)
@given(paths(), geometries(), poses(1.5), st.floats(0.0, 0.1))
def test_what_passes_keeps_the_margin_everywhere(
    path: JointPath, geometry: Geometry, pose: Pose, margin: float
):
    detection = CollisionDetection(robot(), scene=Scene((SceneObject('obstacle', geometry, pose),), (TOOL,)))
    place = detection.first_approach(path, margin=margin)
    start = detection.distance(path.sample(path.start))
    assert start is not None
    # What is closer at the start already may leave: its own distance is kept then.
    kept = min(margin, start.distance)
    end = path.end if place is None else place.time
    for time in np.linspace(path.start, end, 100)[:-1]:
        near = detection.distance(path.sample(time))
        assert near is not None
        # 1e-3: a little later than the first instant may count, by 1e-4 m of travel and the bend of the path.
        assert near.distance > 0.0 or kept == 0.0 or end - time < 1e-3 * path.end
        assert near.distance >= kept - 1e-3 or end - time < 1e-3 * path.end
    if place is not None:
        assert place.proximity.distance <= margin + 1e-3


@settings(max_examples=15)
@given(paths(), geometries(), poses(1.5))
def test_closest_approach_is_the_smallest_distance_of_the_path(
    path: JointPath, geometry: Geometry, pose: Pose
):
    detection = CollisionDetection(robot(), scene=Scene((SceneObject('obstacle', geometry, pose),), (TOOL,)))
    closest = detection.closest_approach(path, tolerance=1e-3)
    assert closest is not None
    sampled = [detection.distance(path.sample(t)) for t in np.linspace(path.start, path.end, 60)]
    smallest = min(item.distance for item in sampled if item is not None)
    assert closest.proximity.distance <= smallest + 1e-3 + ENGINE_TOLERANCE
    there = detection.distance(path.sample(closest.time))
    assert there is not None
    assert closest.proximity.distance == pytest.approx(there.distance, abs=1e-12)
    assert closest.fraction == pytest.approx(path.fraction(closest.time))
