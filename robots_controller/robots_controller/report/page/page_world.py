"""What the page's 3D view shows: meshes, the robot's poses over time, the scene."""

from typing import Any, Final

import numpy as np

from robots_controller.report.page.page_data import PageArrays
from robots_controller.report.run_report import RunReport
from robots_core.blocks.collision.robot_solids import flange
from robots_core.blocks.collision.scene import AttachedObject, SceneObject
from robots_core.orientation import quaternions_of
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.shapes import Shape
from robots_core.robot_model.stretched_length import stretched_length
from robots_core.robot_model.urdf.triangle_mesh import shaded, triangle_mesh
from robots_core.validation import Array

POSES_PER_SECOND: Final = 30.0
MOST_POSES: Final = 1800  # of a run; between two of them the page interpolates
MOST_FACES: Final = 60_000  # of a robot; of one with finer meshes the collision shapes are shown
MOST_VERTICES: Final = 65_535  # of a mesh: WebGL 1 counts them with 16 bits
MOST_PATH_POINTS: Final = 4000
PATH_COLOURS: Final = ((0.04, 0.54, 0.51, 1.0), (0.88, 0.31, 0.12, 1.0))
GHOST: Final = (0.88, 0.42, 0.2)
GHOST_OPACITY: Final = 0.35

Colour = tuple[float, float, float, float]


def world(reports: tuple[RunReport, ...], arrays: PageArrays) -> dict[str, Any]:
    """The world of one run, or of two: the second robot is seen through."""
    meshes: list[dict[str, int]] = []
    robots = [_robot(report, number, arrays, meshes) for number, report in enumerate(reports)]
    return {
        'reach': max(stretched_length(report.run.robot) for report in reports),
        'meshes': meshes,
        'robots': robots,
    }


def _robot(
    report: RunReport, number: int, arrays: PageArrays, meshes: list[dict[str, int]]
) -> dict[str, Any]:
    run = report.run
    times, poses = _poses(report)
    parts = []
    for shape in _shapes(run.robot):
        colour = shape.colour if number == 0 else (*GHOST, GHOST_OPACITY)
        parts.append(_part(shape, (shape.frame, shape.pose), colour, arrays, meshes))
    if report.scene is not None:
        tool0 = flange(run.robot)
        if number == 0:
            parts += [_part(o, (0, o.pose), o.colour, arrays, meshes) for o in report.scene.objects]
        held = run.robot.num_axes
        parts += [_part(a, (held, tool0 @ a.pose), a.colour, arrays, meshes) for a in report.scene.attached]
    parts.sort(key=lambda part: -float(part['colour'][3]))  # what is seen through comes last
    step = max(1, run.time.size // MOST_PATH_POINTS)
    return {
        'times': arrays.add(times),
        'poses': arrays.add(poses),
        'frames': run.robot.num_axes,
        'path': arrays.add(report.signals.tool[::step]),
        'pathColour': PATH_COLOURS[number % len(PATH_COLOURS)],
        'parts': parts,
    }


def _poses(report: RunReport) -> tuple[Array, Array]:
    """Times (k,) s and poses (k, n, 7), position and quaternion of every axis frame."""
    run = report.run
    count = int(np.clip(np.ceil(run.duration * POSES_PER_SECOND) + 1, 2, MOST_POSES))
    rows = np.unique(np.linspace(0, run.time.size - 1, min(count, run.time.size)).astype(np.int64))
    frames = [run.robot.kinematic_model.frame_axes(q) for q in run.feedback[0][rows]]
    r, T = (np.array(parts) for parts in zip(*frames, strict=True))
    quaternions = quaternions_of(T.reshape(-1, 3, 3)).reshape(*r.shape[:2], 4)
    return run.time[rows], np.concatenate([r, quaternions], axis=2)


def _shapes(robot: BaseRobotModel) -> tuple[Shape, ...]:
    shapes = robot.visualization.shapes
    faces = sum(len(triangle_mesh(shape.geometry).faces) for shape in shapes)
    return shapes if 0 < faces <= MOST_FACES else robot.collision_model.shapes


def _part(
    item: Shape | SceneObject | AttachedObject,
    place: tuple[int, Pose],
    colour: Colour,
    arrays: PageArrays,
    meshes: list[dict[str, int]],
) -> dict[str, Any]:
    frame, pose = place
    mesh = shaded(item.geometry)
    if len(mesh.vertices) > MOST_VERTICES:
        mesh = mesh.convex_hull
    mesh.apply_transform(np.block([[pose.T, pose.r[:, None]], [np.zeros((1, 3)), np.ones((1, 1))]]))
    normals = np.zeros((len(mesh.vertices), 4), dtype=np.int8)  # vertices of 4 bytes, as WebGL needs them
    normals[:, :3] = np.round(127.0 * mesh.vertex_normals)
    stored = {
        'vertices': arrays.add(mesh.vertices),
        'normals': arrays.add(normals, 'i1'),
        'faces': arrays.add(mesh.faces, 'u2'),
    }
    if stored not in meshes:
        meshes.append(stored)
    return {'mesh': meshes.index(stored), 'frame': frame, 'colour': colour}
