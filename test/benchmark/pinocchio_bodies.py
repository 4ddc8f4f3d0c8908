"""The bodies of a robot and its scene in Pinocchio, and an independent check of whole paths with them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import pinocchio as pin

from robots_core import BaseRobotModel
from robots_core.blocks import CollisionDetection, Scene
from robots_core.blocks.collision.engine import CoalEngine
from robots_core.robot_model.urdf.urdf_chain import pinocchio_xml, read_urdf_chain


@dataclass(frozen=True)
class PinocchioBodies:
    """A Pinocchio model with the bodies, and the pairs to be checked, of a robot in a scene."""

    model: Any
    data: Any
    geometry: Any
    placed: Any

    @classmethod
    def of(cls, robot: BaseRobotModel, scene: Scene) -> Self:
        """The bodies as coal's; pairs are those of `CollisionDetection`."""
        model = pin.buildModelFromXML(pinocchio_xml(read_urdf_chain(robot.description)))
        geometry = pin.GeometryModel()
        table = CollisionDetection(robot, scene=scene)._set
        for k, solid in enumerate(table.solids):
            placement = pin.SE3(solid.pose.T, solid.pose.r)
            geometry.addGeometryObject(
                pin.GeometryObject(f'{k}', solid.frame, placement, CoalEngine.geometry(solid))
            )
        for a, b in zip(table.first, table.second, strict=True):
            geometry.addCollisionPair(pin.CollisionPair(int(a), int(b)))
        return cls(model, model.createData(), geometry, geometry.createData())

    def in_contact(self, q: np.ndarray) -> bool:
        """Whether anything is in contact at joint positions `q`, (n,) rad."""
        return bool(pin.computeCollisions(self.model, self.data, self.geometry, self.placed, q, True))

    def closest_pair(self, q: np.ndarray) -> int:
        """Which pair is the closest at joint positions `q`, (n,) rad."""
        return int(pin.computeDistances(self.model, self.data, self.geometry, self.placed, q))

    def path_in_contact(self, postures: np.ndarray, reach: float, step: float) -> bool:
        """Whether anything is in contact on a polyline, sampled so that no point moves farther than `step`.

        A pair is not checked where its last distance excludes a contact: two bodies that are `d` apart
        can meet after d / (2 step) samples at the earliest.

        Args:
            postures: Corners of the polyline, (k, n) rad.
            reach: Largest distance of any point of the robot from any of its axes, m.
            step: Largest motion of a point from sample to sample, m.
        """
        travel = np.r_[0.0, np.cumsum(reach * np.abs(np.diff(postures, axis=0)).sum(axis=1))]
        last = int(np.ceil(travel[-1] / step))
        due = np.zeros(len(self.geometry.collisionPairs), dtype=np.int64)
        while (sample := int(due.min())) <= last:
            q = np.array([np.interp(travel[-1] * sample / last, travel, axis) for axis in postures.T])
            pin.updateGeometryPlacements(self.model, self.data, self.geometry, self.placed, q)
            for pair in np.flatnonzero(due == sample):
                distance = pin.computeDistance(self.geometry, self.placed, int(pair)).min_distance
                if distance <= 0.0:
                    return True
                due[pair] = sample + max(1, int(distance / (2.0 * step)))
        return False
