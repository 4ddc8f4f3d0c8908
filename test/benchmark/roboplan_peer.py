"""roboplan's RRT-Connect with its own shortcuts, on the problems of `collision_free_problems`.

roboplan has no margin: obstacles are larger by it. Its robots are read from the same URDF files.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pinocchio  # noqa: F401  # loads the libraries that roboplan links to
from collision_free_problems import MARGIN, Problem

from robots_core import BaseRobotModel, Pose
from robots_core.blocks import CollisionDetection
from robots_core.robot_model.shapes import Box, Capsule, Cylinder, Geometry

# Packages built with cmeel are in a prefix of the folder that they are installed to.
for folder in map(Path, tuple(sys.path)):
    inside = folder / 'cmeel.prefix' / 'lib' / f'python3.{sys.version_info.minor}' / 'site-packages'
    if (inside / 'roboplan').is_dir():
        sys.path.append(str(inside))

import roboplan.core as rc  # noqa: E402  # from there
import roboplan.rrt as rr  # noqa: E402

MODELS = Path(__file__).parents[2] / 'robots_models' / 'robots_models'
GROUP = 'arm'
COLOUR = np.array([0.5, 0.5, 0.5, 1.0])
MOST_NODES = 1_000_000
NEAR_LINKS = 3  # at the end of the arm, that may touch what it holds


def _matrix(pose: Pose) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = pose.T, pose.r
    return matrix


class RoboplanPeer:
    """A scene of roboplan, made before the clock starts.

    Args:
        robot: The robot.
        detection: Says which of its bodies are not checked.
        problem: The problem.
        step: Largest step of the checks of edges, rad.
        budget: Longest search, s of the clock.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        detection: CollisionDetection,
        problem: Problem,
        *,
        step: float,
        budget: float,
    ) -> None:
        urdf = MODELS / robot.name / 'robot.urdf'
        self._scene = rc.Scene('problem', rc.loadUrdfSceneDescription(str(urdf), [str(urdf.parent)]))
        self._names = self._scene.getJointNames()
        self._scene.addGroup(GROUP, self._names)
        self._scene.allowAdjacentLinkCollisions()
        links = list(dict.fromkeys(solid.name.partition('/')[0] for solid in detection._body))
        shapes = {link: [s.name for s in detection._body if s.name.startswith(f'{link}/')] for link in links}
        for i, one in enumerate(links):
            for other in links[i + 1 :]:
                pairs = [(a, b) for a in shapes[one] for b in shapes[other]]
                if all(detection.allowed_pairs.allows(a, b) for a, b in pairs):
                    self._scene.setCollisions(one, other, False)
        around: list[str] = []
        for item in problem.scene.objects:
            around += self._add(item.name, 'universe', item.geometry, _matrix(item.pose), MARGIN)
        apart = [(a, b) for i, a in enumerate(around) for b in (links[0], *around[:i])]
        self._scene.setCollisions(apart, False)  # shelves stand on one another, and the robot on the floor
        # On two of the robots, bodies that are fixed to tool0 were not found in contact.
        flange = self._scene.forwardKinematics(problem.start, 'tool0', links[-1])
        for item in problem.scene.attached:
            for name in self._add(item.name, links[-1], item.geometry, flange @ _matrix(item.pose), 0.0):
                for link in links[-NEAR_LINKS:-1]:
                    self._scene.setCollisions(link, name, False)
        self._planner = rr.RRT(
            self._scene,
            rr.RRTOptions(
                group_name=GROUP,
                max_nodes=MOST_NODES,
                collision_check_step_size=step,
                max_planning_time=budget,
                rrt_connect=True,
            ),
        )
        self._planner.setRngSeed(1)
        self._shortcutter = rc.PathShortcutter(
            self._scene, rc.PathShortcuttingOptions(group_name=GROUP, max_step_size=step, seed=1)
        )

    def _add(self, name: str, frame: str, geometry: Geometry, pose: np.ndarray, margin: float) -> list[str]:
        """Add a body that is larger by a margin; returns the names of its parts."""
        pose = np.asfortranarray(pose)
        match geometry:
            case Box(size):
                grown = rc.Box(*(value + 2.0 * margin for value in size))
                self._scene.addBoxGeometry(name, frame, grown, pose, COLOUR)
                return [name]
            case Cylinder(radius, length):
                grown = rc.Cylinder(radius + margin, length + 2.0 * margin)
                self._scene.addCylinderGeometry(name, frame, grown, pose, COLOUR)
                return [name]
            case Capsule(radius, length):
                middle = rc.Cylinder(radius + margin, length)
                self._scene.addCylinderGeometry(name, frame, middle, pose, COLOUR)
                names = [name]
                for end in (-0.5, 0.5):
                    at = pose.copy(order='F')
                    at[:3, 3] += end * length * pose[:3, 2]
                    names.append(f'{name}_{end:g}')
                    self._scene.addSphereGeometry(names[-1], frame, rc.Sphere(radius + margin), at, COLOUR)
                return names
        raise TypeError(f'{name} has a shape that is none of the problems: {geometry}')

    def plan(self, start: np.ndarray, target: np.ndarray) -> np.ndarray | None:
        """Postures (k, n) of a way between two postures; None if none was found."""
        ends = []
        for q in (start, target):
            ends.append(rc.JointConfiguration())
            ends[-1].joint_names, ends[-1].positions = self._names, q
        if any(self._scene.hasCollisions(q, True) for q in (start, target)):
            raise ValueError('the ends of a problem are free, but not in the scene made for roboplan')
        try:
            path = self._shortcutter.shortcut(self._planner.plan(*ends))
        except RuntimeError:
            return None
        return np.array(path.positions)
