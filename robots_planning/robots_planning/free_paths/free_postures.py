"""Free postures: what a motion may start from and end in, and why it may not."""

from __future__ import annotations

from typing import Final

import numpy as np

from robots_core.blocks.collision.along_paths.path_certificate import FREE
from robots_core.blocks.collision.results import RESOLUTION
from robots_core.blocks.collision_detection import CollisionDetection
from robots_core.validation import Array
from robots_planning.free_paths.errors import BlockedPostureError

SAME: Final = 1e-6  # rad (m)
JOGS: Final = (0.02, 0.05, 0.1, 0.2, 0.4, 0.8)  # rad (m) of one axis, tried to leave a contact


def check_start(detection: CollisionDetection, start: Array) -> None:
    """Pass a posture (n,) in which nothing is in contact: what is too close can be left, a contact cannot.

    Raises:
        BlockedPostureError: names the bodies, and the jog that leaves the contact.
    """
    closest = detection.distance(start)
    if closest is None or not closest.in_contact:
        return
    raise BlockedPostureError(
        f'the start collides: {closest.describe()}; {_way_out(detection, start)}',
        link=closest.first,
        obstacle=closest.second,
    )


def _way_out(detection: CollisionDetection, start: Array) -> str:
    """The smallest of a few jogs of one axis after which nothing is in contact, the farthest away first."""
    axes = detection.robot.axes_data
    for way in JOGS:
        best, text = 0.0, ''
        for axis in range(axes.num_axes):
            for signed in (way, -way):
                q = start.copy()
                q[axis] += signed
                if not axes.lower[axis] <= q[axis] <= axes.upper[axis]:
                    continue
                closest = detection.distance(q)
                if closest is not None and closest.distance > best:
                    best = closest.distance
                    text = f'jog {axes.names[axis]} by {signed:.6g} {axes.unit(axis)} to leave it'
        if text:
            return text
    return f'no jog of one axis by up to {JOGS[-1]:g} rad leaves it'


def blocked_target(
    detection: CollisionDetection, start: Array, target: Array, margin: float
) -> BlockedPostureError | None:
    """Why a motion from a posture may not end in another one, (n,) each; None if it may."""
    closest = detection.distance(target)
    if closest is None:
        return None
    if closest.in_contact:
        message = f'the target collides: {closest.describe()}'
    else:
        # Bodies that are closer than the margin at the start need not be farther apart at the end.
        pair = detection.certificate(start, margin=margin).posture(target)
        if pair == FREE:
            return None
        closest = detection.proximity(target, pair)
        message = f'the target is too close: {closest.describe(margin)}'
        if closest.distance >= margin:
            message += f', not {1e3 * RESOLUTION:g} mm more than the margin'
        message += f'; the margin is {1e3 * margin:g} mm'
    return BlockedPostureError(
        message,
        link=closest.first,
        obstacle=closest.second,
        distance=closest.distance,
        margin=margin,
    )


def distinct(postures: Array) -> Array:
    """Postures (k, n) without those that are the same as one before."""
    kept: list[Array] = []
    for q in postures:
        if all(np.abs(q - other).max() > SAME for other in kept):
            kept.append(q)
    return np.array(kept).reshape(-1, postures.shape[1])
