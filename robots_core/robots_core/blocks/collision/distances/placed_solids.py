"""Solids on the axes of a robot, compiled: where they are, and fast bounds on distances and motions."""

from math import sqrt

from robots_core.blocks.collision.distances.nearest_points import Indices, PartArrays
from robots_core.kernels.compiled import compiled
from robots_core.kernels.serial_chain import ChainArrays, next_frame
from robots_core.kernels.vectors import (
    Vector,
    add,
    dot,
    matrix_of,
    product,
    row_of,
    subtract,
    times,
    transposed,
)
from robots_core.validation import Array

SolidArrays = tuple[PartArrays, Indices, Array, Array, Array, Array, Indices, Array, Array]
"""Arrays of s solids with p parts; a convex solid has one part, a surface one per triangle.

The parts; first part of every solid (s + 1,); centres (p, 3) and radii (p,) of balls around the parts;
centres (s, 3) and half edges (s, 3) of boxes around the solids, in their own frames; the axis whose frame in
the chain each is fixed to (s,), counted from 1, and its pose there: orientation (s, 3, 3), position (s, 3).
Lengths in m.
"""
ReachArrays = tuple[Array, Array]
"""Eight points whose hull, grown by a radius, holds a solid, in its frame, (s, 8, 3) m; the radii (s,)."""
BallArrays = tuple[Array, Array]
"""Centres (s, 3) of balls around the solids in their own frames, and radii (s,), m."""
BodyArrays = tuple[SolidArrays, ChainArrays, ReachArrays, BallArrays, Indices, Indices]
"""The solids, fixed to the frames of the chain; the chain; how far the solids reach; balls around them; the
first solid of every pair, (p,), which is not moved by more axes than the second; the second."""
PlacedArrays = tuple[Array, Array, Array, Array, Array, Array, Array, Array, Array]
"""Origins (n, 3) and orientations (n, 3, 3) of the axes' frames, z along the axis; orientations (s, 3, 3) and
positions (s, 3) of the solids, those at rest filled in; the approach of each solid by the axes from one on,
(s, n), m; the direction that separated every pair last, (p, 3), 0 for none; centres (s, 3) of the balls
around the solids, m, those at rest filled in; the points that hold one solid, (8, 3) m; a result of
`solid_distance`, (8,)."""


@compiled(counted=False)
def place(body: BodyArrays, placed: PlacedArrays, q: Array) -> None:
    """Place the frames and the moved solids at joint positions `q`, (n,)."""
    solids, chain, centres = body[0], body[1], body[3][0]
    r, T, solid_R, solid_t, placed_centres = placed[0], placed[1], placed[2], placed[3], placed[6]
    R, t = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), (0.0, 0.0, 0.0)
    for i in range(q.size):
        _, R, t = next_frame(chain, i, q[i], R, t)
        r[i, 0], r[i, 1], r[i, 2] = t
        for row in range(3):
            T[i, row, 0], T[i, row, 1], T[i, row, 2] = R[row]
    for s in range(solids[6].size):
        k = solids[6][s] - 1
        if k < 0:
            continue
        turned = matrix_of(T[k])
        solid_t[s, 0], solid_t[s, 1], solid_t[s, 2] = add(row_of(r, k), times(turned, row_of(solids[8], s)))
        rows = product(turned, matrix_of(solids[7][s]))
        for row in range(3):
            solid_R[s, row, 0], solid_R[s, row, 1], solid_R[s, row, 2] = rows[row]
        placed_centres[s, 0], placed_centres[s, 1], placed_centres[s, 2] = add(
            row_of(solid_t, s), times(rows, row_of(centres, s))
        )


@compiled(counted=False)
def broad_distance(body: BodyArrays, placed: PlacedArrays, i: int, j: int, enough: float) -> float:
    """A fast lower bound of the distance of two solids, m; may be below 0, and less tight beyond `enough`."""
    radii, centres = body[3][1], placed[6]
    way = subtract(row_of(centres, i), row_of(centres, j))
    lower: float = sqrt(dot(way, way)) - radii[i] - radii[j]
    if lower <= enough:
        lower = max(lower, _outside(body, placed, i, row_of(centres, j)) - radii[j])
    if lower <= enough:
        lower = max(lower, _outside(body, placed, j, row_of(centres, i)) - radii[i])
    return lower


@compiled(counted=False)
def _outside(body: BodyArrays, placed: PlacedArrays, s: int, point: Vector) -> float:
    """Distance of a point from the box around solid s, m; 0 inside."""
    boxes, halves, R = body[0][4], body[0][5], placed[2]
    x, y, z = subtract(point, row_of(placed[3], s))
    squared = 0.0
    for axis in range(3):
        inside = R[s, 0, axis] * x + R[s, 1, axis] * y + R[s, 2, axis] * z - boxes[s, axis]
        outside = abs(inside) - halves[s, axis]
        if outside > 0.0:
            squared += outside * outside
    return sqrt(squared)


@compiled(counted=False)
def box_reach(solids: SolidArrays, R: Array, t: Array, s: int, axis: Vector) -> float:
    """How far the box around solid s, placed at R (s, 3, 3) and t (s, 3), reaches along a unit vector, m."""
    x, y, z = times(transposed(matrix_of(R[s])), axis)
    half: float = dot(row_of(solids[5], s), (abs(x), abs(y), abs(z)))
    return dot(row_of(t, s), axis) + dot(row_of(solids[4], s), (x, y, z)) + half


@compiled(counted=False)
def forget_approaches(placed: PlacedArrays) -> None:
    """Let `approach` compute all anew: the solids were moved, or the displacements of the axes are others."""
    placed[4][:, 0] = -1.0


@compiled(counted=False)
def approach(body: BodyArrays, placed: PlacedArrays, turn: Array, i: int, j: int) -> float:
    """Upper bound on the approach of solid j to solid i if the axes move by up to `turn`, (n,) rad (m); m.

    Moved one after the other, the outermost axis first, axis k moves a point by no more than its turn times
    the point's distance from the axis: that at the current joint positions, plus the displacement by the axes
    further out (after Schwarzer, Saha and Latombe 2005, with current radii in place of the largest ones).
    """
    approaches = placed[4]
    if approaches[j, 0] < 0.0:
        _fill_approaches(body, placed, turn, j)
    return float(approaches[j, body[0][6][i]])


@compiled(counted=False)
def _fill_approaches(body: BodyArrays, placed: PlacedArrays, turn: Array, s: int) -> None:
    """Fill how far solid s may move if axes turn by up to `turn`, (n,), from each axis on."""
    chain, (points, radii) = body[1], body[2]
    r, T, R, t, approaches = placed[:5]
    corners, turned, at = placed[7], matrix_of(R[s]), row_of(t, s)
    moved, filled = 0.0, False
    for k in range(body[0][6][s] - 1, -1, -1):
        if chain[k, 12] != 0.0:
            moved += turn[k]
        elif turn[k] > 0.0:
            axis, origin = (T[k, 0, 2], T[k, 1, 2], T[k, 2, 2]), row_of(r, k)
            if not filled:
                filled = True
                for p in range(8):
                    corners[p, 0], corners[p, 1], corners[p, 2] = add(at, times(turned, row_of(points[s], p)))
            farthest = 0.0
            for p in range(8):
                arm = subtract(row_of(corners, p), origin)
                farthest = max(farthest, dot(arm, arm) - dot(arm, axis) ** 2)
            moved += turn[k] * (sqrt(farthest) + radii[s] + moved)
        approaches[s, k] = moved
