"""The steps of second-order drives for many periods, compiled."""

from robots_core.kernels.compiled import compiled
from robots_core.validation import Array


@compiled()
def follow(transition: Array, q: Array, q_dot: Array, references: Array, states: Array) -> None:
    """Fill the states (k, 2, n) after each period as `SecondOrderDrive.step` gives them, to the last bit.

    The transition (4, n) is that of position and velocity, row by row; q and q_dot are overwritten.
    """
    for i in range(len(references)):
        for axis in range(q.size):
            target = references[i, 0, axis]
            error, before = q[axis] - target, q_dot[axis]
            q[axis] = 0.0 + transition[0, axis] * error + transition[1, axis] * before + target
            q_dot[axis] = 0.0 + transition[2, axis] * error + transition[3, axis] * before
            states[i, 0, axis], states[i, 1, axis] = q[axis], q_dot[axis]
