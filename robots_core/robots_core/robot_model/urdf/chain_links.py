"""A serial chain as rows of numbers, for compiled direct kinematics."""

import numpy as np
import pinocchio as pin

from robots_core.validation import Array


def links_of(model: pin.Model, tool0: int) -> Array:
    """The chain of a model with one position per joint, as `tool_pose` takes it.

    Each joint gets a frame whose z axis is that of the joint; a row holds the transform from the frame
    before: its rotation, row by row, its translation, and 1 if the axis slides.

    Args:
        model: A single chain.
        tool0: Index of the tool's frame, which the last joint carries.

    Returns:
        (n + 1, 13); the last row leads to the tool.
    """
    data = model.createData()
    pin.computeJointJacobians(model, data, np.zeros(model.nq))
    rows = []
    before = pin.SE3.Identity()
    for joint in range(1, model.njoints):
        columns = pin.getJointJacobian(model, data, joint, pin.ReferenceFrame.LOCAL)
        column = columns.reshape(6, model.nv)[:, joint - 1]  # a single column is returned as a vector
        slides = not column[3:].any()
        axis = column[:3] if slides else column[3:]
        turned = pin.SE3(pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), axis).matrix(), np.zeros(3))
        link = before.actInv(model.jointPlacements[joint] * turned)
        rows.append([*link.rotation.ravel(), *link.translation, float(slides)])
        before = turned
    link = before.actInv(model.frames[tool0].placement)
    rows.append([*link.rotation.ravel(), *link.translation, 0.0])
    return np.array(rows)
