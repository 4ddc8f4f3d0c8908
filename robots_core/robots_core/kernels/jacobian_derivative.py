"""The time derivative of a serial chain's Jacobian, compiled."""

from robots_core.kernels.compiled import compiled
from robots_core.kernels.vectors import add, cross, scale, subtract
from robots_core.validation import Array


@compiled()
def jacobian_der(J: Array, q_dot: Array, J_der: Array) -> None:
    """Fill the derivative J_der (6, n) of a geometric Jacobian J (6, n) for joint velocities `q_dot` (n,).

    It follows from the Jacobian alone (Bruyninckx and De Schutter 1996): with w the angular and v the
    linear rows, column i changes with axis j by w_j x v_i if j <= i, and by w_i x v_j if j > i; its angular
    part by w_j x w_i if j < i. An axis that slides has w = 0.
    """
    n = q_dot.size
    # Linear velocity of the tool due to the axes after i, and angular velocity due to those before i.
    after = before = (0.0, 0.0, 0.0)
    for j in range(n):
        after = add(after, scale(q_dot[j], (J[0, j], J[1, j], J[2, j])))
    for i in range(n):
        v, w = (J[0, i], J[1, i], J[2, i]), (J[3, i], J[4, i], J[5, i])
        after = subtract(after, scale(q_dot[i], v))
        J_der[3, i], J_der[4, i], J_der[5, i] = cross(before, w)
        before = add(before, scale(q_dot[i], w))
        J_der[0, i], J_der[1, i], J_der[2, i] = add(cross(before, v), cross(w, after))
