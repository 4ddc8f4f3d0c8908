"""FclEngine: collision checks by python-fcl."""

from typing import Any

import fcl
import numpy as np

from robots_core.blocks.collision.engine import CollisionEngine
from robots_core.robot_model.shapes import Mesh


class FclEngine(CollisionEngine):
    """python-fcl, pair by pair: its broad-phase manager calls back into Python for each, which is slower."""

    library = fcl

    @staticmethod
    def hull(mesh: Mesh) -> Any:
        """See `CollisionEngine.hull`; a face is its number of corners, then their indices."""
        return fcl.Convex(mesh.vertices, len(mesh.faces), np.insert(mesh.faces, 0, 3, axis=1).ravel())

    @staticmethod
    def surface(mesh: Mesh) -> Any:
        """See `CollisionEngine.surface`."""
        model = fcl.BVHModel()
        model.beginModel(len(mesh.faces), len(mesh.vertices))
        model.addSubModel(mesh.vertices, mesh.faces)
        model.endModel()
        return model
