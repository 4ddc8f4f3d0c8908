"""The time derivative of a serial chain's Jacobian, compiled."""

from robots_core.robot_model.analytic.compiled import compiled
from robots_core.validation import Array


@compiled(nrt=False)
def jacobian_der(J: Array, q_dot: Array, J_der: Array) -> None:
    """Fill the derivative J_der (6, n) of a geometric Jacobian J (6, n) for joint velocities `q_dot` (n,).

    It follows from the Jacobian alone (Bruyninckx and De Schutter 1996): with w the angular and v the
    linear rows, column i changes with axis j by w_j x v_i if j <= i, and by w_i x v_j if j > i; its angular
    part by w_j x w_i if j < i. An axis that slides has w = 0.
    """
    n = q_dot.size
    # Linear velocity of the tool due to the axes after i.
    bx, by, bz = 0.0, 0.0, 0.0
    for j in range(n):
        bx, by, bz = bx + J[0, j] * q_dot[j], by + J[1, j] * q_dot[j], bz + J[2, j] * q_dot[j]
    # Angular velocity due to the axes before i.
    ax, ay, az = 0.0, 0.0, 0.0
    for i in range(n):
        rate = q_dot[i]
        vx, vy, vz = J[0, i], J[1, i], J[2, i]
        wx, wy, wz = J[3, i], J[4, i], J[5, i]
        bx, by, bz = bx - vx * rate, by - vy * rate, bz - vz * rate
        J_der[3, i], J_der[4, i], J_der[5, i] = ay * wz - az * wy, az * wx - ax * wz, ax * wy - ay * wx
        ax, ay, az = ax + wx * rate, ay + wy * rate, az + wz * rate
        J_der[0, i] = ay * vz - az * vy + wy * bz - wz * by
        J_der[1, i] = az * vx - ax * vz + wz * bx - wx * bz
        J_der[2, i] = ax * vy - ay * vx + wx * by - wy * bx
