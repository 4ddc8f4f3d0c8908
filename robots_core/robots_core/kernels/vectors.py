"""Vectors of three and 3x3 matrices as tuples, for compiled code: there they are registers and not memory."""

from robots_core.kernels.compiled import compiled
from robots_core.validation import Array

Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]
"""Three rows."""


@compiled()
def copy_into(to: Array, values: Array) -> None:
    """Copy an array (m,): `to[:] = values` first takes 1.8 s to compile in a process."""
    for i in range(values.size):
        to[i] = values[i]


@compiled()
def vector_of(a: Array) -> Vector:
    """An array (3,)."""
    return a[0], a[1], a[2]


@compiled()
def row_of(rows: Array, i: int) -> Vector:
    """Row i of an array (m, 3)."""
    return rows[i, 0], rows[i, 1], rows[i, 2]


@compiled()
def matrix_of(A: Array) -> Matrix:
    """An array (3, 3)."""
    return row_of(A, 0), row_of(A, 1), row_of(A, 2)


@compiled()
def add(a: Vector, b: Vector) -> Vector:
    """Sum of two vectors."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@compiled()
def subtract(a: Vector, b: Vector) -> Vector:
    """Difference of two vectors."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@compiled()
def scale(factor: float, a: Vector) -> Vector:
    """A multiple of a vector."""
    return factor * a[0], factor * a[1], factor * a[2]


@compiled()
def dot(a: Vector, b: Vector) -> float:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled()
def cross(a: Vector, b: Vector) -> Vector:
    """Vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@compiled()
def times(A: Matrix, v: Vector) -> Vector:
    """Matrix times vector."""
    return dot(A[0], v), dot(A[1], v), dot(A[2], v)


@compiled()
def transposed(A: Matrix) -> Matrix:
    """The transpose of a matrix."""
    return (A[0][0], A[1][0], A[2][0]), (A[0][1], A[1][1], A[2][1]), (A[0][2], A[1][2], A[2][2])


@compiled()
def product(A: Matrix, B: Matrix) -> Matrix:
    """Matrix times matrix."""
    x, y, z = transposed(B)
    return (
        (dot(A[0], x), dot(A[0], y), dot(A[0], z)),
        (dot(A[1], x), dot(A[1], y), dot(A[1], z)),
        (dot(A[2], x), dot(A[2], y), dot(A[2], z)),
    )
