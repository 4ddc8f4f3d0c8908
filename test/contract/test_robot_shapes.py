"""Every robot: shapes for the eye and for collision checks."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from robots_core import BaseRobotModel, Pose
from robots_core.robot_model.shapes import Shape
from robots_core.robot_model.urdf.triangle_mesh import triangle_mesh

KINDS = ('visualization', 'collision_model')


@pytest.fixture(params=KINDS)
def shapes(request: pytest.FixtureRequest, robot: BaseRobotModel) -> tuple[Shape, ...]:
    return getattr(robot, request.param).shapes


def test_names_are_unique(shapes: tuple[Shape, ...]):
    names = [shape.name for shape in shapes]
    assert all(names)
    assert len(set(names)) == len(names)


def test_every_shape_hangs_on_a_frame_of_the_robot(robot: BaseRobotModel, shapes: tuple[Shape, ...]):
    assert all(0 <= shape.frame <= robot.num_axes for shape in shapes)


def test_every_shape_is_a_surface(shapes: tuple[Shape, ...]):
    for shape in shapes:
        mesh = triangle_mesh(shape.geometry)
        assert len(mesh.faces) >= 4, shape.name
        assert np.isfinite(mesh.vertices).all(), shape.name
        assert mesh.area > 0.0, shape.name


def test_colours_are_colours(robot: BaseRobotModel):
    for shape in robot.visualization.shapes:
        assert len(shape.colour) == 4
        assert all(0.0 <= channel <= 1.0 for channel in shape.colour), shape.name
        assert shape.colour[3] > 0.0, shape.name


@pytest.mark.parametrize('kind', KINDS)
def test_every_body_has_a_shape(robot: BaseRobotModel, kind: str):
    frames = {shape.frame for shape in getattr(robot, kind).shapes}
    assert frames == set(range(robot.num_axes + 1))


@pytest.mark.parametrize('kind', KINDS)
def test_shapes_are_as_large_as_the_robot(robot: BaseRobotModel, kind: str):
    """No shape is in millimetres, or far from the chain of axes."""
    r, T = robot.kinematic_model.frame_axes(robot.home)
    tool0, _ = robot.direct_kinematics(robot.home)
    chain = np.vstack([np.zeros(3), r, tool0])
    length = np.linalg.norm(np.diff(chain, axis=0), axis=1).sum()
    positions, orientations = np.vstack([np.zeros((1, 3)), r]), np.vstack([np.eye(3)[None], T])
    points = np.vstack(
        [
            positions[shape.frame]
            + (shape.pose.r + triangle_mesh(shape.geometry).vertices @ shape.pose.T.T)
            @ orientations[shape.frame].T
            for shape in getattr(robot, kind).shapes
        ]
    )
    low, high = points.min(axis=0), points.max(axis=0)
    # Rails are as long as what slides on them.
    chain = np.vstack([chain, *_ends_of_sliding_axes(robot)])
    # A body reaches at most about a quarter of the stretched robot beyond its axes.
    assert (low > chain.min(axis=0) - 0.25 * length).all()
    assert (high < chain.max(axis=0) + 0.25 * length).all()
    assert np.linalg.norm(high - low) > 0.5 * np.linalg.norm(np.ptp(chain, axis=0))


def test_home_is_free_of_collisions_between_bodies_that_are_no_neighbours(robot: BaseRobotModel):
    r, T = robot.kinematic_model.frame_axes(robot.home)
    manager = trimesh.collision.CollisionManager()
    frame_of = {}
    for shape in robot.collision_model.shapes:
        frame = Pose.identity() if shape.frame == 0 else Pose(r[shape.frame - 1], T[shape.frame - 1])
        pose = frame @ shape.pose
        placement = np.eye(4)
        placement[:3, :3], placement[:3, 3] = pose.T, pose.r
        manager.add_object(shape.name, triangle_mesh(shape.geometry), placement)
        frame_of[shape.name] = shape.frame
    _, pairs = manager.in_collision_internal(return_names=True)
    assert {pair for pair in pairs if abs(frame_of[pair[0]] - frame_of[pair[1]]) > 1} == set()


def _ends_of_sliding_axes(robot: BaseRobotModel) -> list[np.ndarray]:
    axes = robot.axes_data
    frames = []
    for index in np.flatnonzero(axes.prismatic):
        for end in (axes.lower[index], axes.upper[index]):
            q = robot.home.copy()
            q[index] = end
            frames.append(robot.kinematic_model.frame_axes(q)[0])
    return frames
