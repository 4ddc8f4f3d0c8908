# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""Compiled time step of drives and bodies together, stable for any gains and friction.

Implicit midpoint rule for gears, motors and controllers; the mass matrix and the velocity-dependent torques
are taken at a predicted midpoint. Friction is implicit, see `friction_kernel`. All quantities are those at
the joint: a motor with gear ratio i turns i times as fast, with 1/i of the torque.
"""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robots_core.blocks.drives.friction_kernel import sweep
from robots_core.kernels.chain_dynamics import (
    Bodies,
    DynamicsArrays,
    bodies_of,
    fill_dynamics,
)
from robots_core.kernels.compiled import compiled
from robots_core.kernels.small_matrices import solve_free
from robots_core.validation import Array

# Rows of the drives' data; each is an attribute of DriveData.
POSITION_GAIN: Final = 0
VELOCITY_GAIN: Final = 1
INTEGRAL_TIME: Final = 2
TORQUE_LIMIT: Final = 3
INERTIA: Final = 4
COULOMB: Final = 5
VISCOUS: Final = 6
STICTION: Final = 7
STIFFNESS: Final = 8
DAMPING: Final = 9
CURRENT_FREQUENCY: Final = 10
CURRENT_DAMPING: Final = 11
BACK_EMF: Final = 12

# Rows of the state.
Q: Final = 0
Q_DOT: Final = 1
MOTOR: Final = 2
MOTOR_DOT: Final = 3
INTEGRAL: Final = 4
TORQUE: Final = 5
TORQUE_RATE: Final = 6  # of the current control's integrator
Q_DDOT: Final = 7  # mean of the last step
JOINT_TORQUE: Final = 8  # mean of the last step, behind gear and friction
STATE_ROWS: Final = 9

# Friction is fed forward in full from this commanded speed on: with a position gain of 5/s, an
# axis comes loose while it is more than 2e-6 rad from its reference.
CREEP: Final = 1e-5  # rad/s (m/s)


class Step(NamedTuple):
    """Memory for one step of n axes, with m unknown speeds of joints and motors.

    Attributes:
        q_ref: Reference positions of the motors in its middle, (n,).
        v_ref: Their velocities, (n,).
        ahead: Torques of the feed-forward, (n,).
        current: Mean torque of the step = row 0 - row 1 * mean motor speed, (2, n).
        saturated: Sign of commanded torques past their limit, (n,).
        q: Joint positions in its middle, (n,).
        q_dot: Joint velocities there, (n,).
        bodies: For `fill_dynamics`.
        M: Mass matrix, (n, n).
        bias: Torques of the bodies at constant speed, (n,).
        weight: Those at rest, (n,).
        A: Without friction, A w = b for the speeds at the end, (m, m).
        b: (m,).
        w: The speeds with friction, (m,).
        hold: Highest friction at rest, (m,).
        slide: Friction while moving, (m,).
        sign: Direction in which it moved, 0 for one that stood, (m,).
        stands: Whether it was at rest, (m,).
        L: For the solution, (m, m).
    """

    q_ref: Array
    v_ref: Array
    ahead: Array
    current: Array
    saturated: Array
    q: Array
    q_dot: Array
    bodies: Bodies
    M: Array
    bias: Array
    weight: Array
    A: Array
    b: Array
    w: Array
    hold: Array
    slide: Array
    sign: Array
    stands: NDArray[np.bool_]
    L: Array


@compiled()
def _step_for(n: int, m: int) -> Step:
    return Step(
        np.empty(n), np.empty(n), np.empty(n), np.empty((2, n)), np.empty(n), np.empty(n), np.empty(n),
        bodies_of(n), np.empty((n, n)), np.empty(n), np.empty(n), np.empty((m, m)), np.empty(m), np.empty(m),
        np.empty(m), np.empty(m), np.empty(m), np.empty(m, dtype=np.bool_), np.empty((m, m)),
    )  # fmt: skip


@compiled()
def advance(
    dynamics: DynamicsArrays,
    drive: Array,
    motors: NDArray[np.int64],
    state: Array,
    start: Array,
    end: Array,
    feed: Array,
    outside: Array,
    floating: Array,
    period: float,
    steps: int,
) -> bool:
    """Advance state (9, n) by a period, in steps.

    The reference (2, n) of the motors, position and velocity, leads from `start` to `end` on a cubic. `feed`
    (2, n) is the feed-forward of the controllers: torques of this period, and friction of moving axes.
    `outside` (n,) are torques from outside of the robot on the joints. `floating` (n, n + 1) are mass matrix
    and bias torques of a robot whose base floats, for this period; (0, 0) for one that stands.
    `motors` (n,) holds the index of the motor's speed among the unknowns: that of the joint if the gear is
    rigid, else after all joints.

    Returns:
        False if a value is no longer finite.
    """
    n = state.shape[1]
    size = n
    for j in range(n):
        size = max(size, motors[j] + 1)
    step, h = _step_for(n, size), period / steps
    for number in range(steps):
        _reference(start, end, period, (number + 0.5) / steps, step)
        _ahead(drive, state, feed, step)
        for j in range(n):
            step.q[j] = state[Q, j] + 0.5 * h * (state[Q_DOT, j] + 0.25 * h * state[Q_DDOT, j])
            step.q_dot[j] = state[Q_DOT, j] + 0.5 * h * state[Q_DDOT, j]
        _bodies(dynamics, outside, floating, step)
        step.saturated[:] = 0.0
        for _ in range(n + 1):
            _motor_torques(drive, state, h, step)
            _assemble(drive, motors, state, h, step)
            _solve_with_friction(drive, motors, state, h, step)
            if not _saturate(drive, motors, state, h, step):
                break
        _move(drive, motors, state, h, step)
    total = 0.0
    for j in range(n):
        total += abs(state[Q, j]) + abs(state[Q_DOT, j]) + abs(state[TORQUE, j])
    return bool(np.isfinite(total))


@compiled(counted=False)
def _bodies(dynamics: DynamicsArrays, outside: Array, floating: Array, step: Step) -> None:
    """Fill the mass matrix and the torques at constant speed, less those from outside."""
    n = outside.size
    if floating.shape[0] == n:
        for i in range(n):
            step.bias[i] = floating[i, n]
            for j in range(n):
                step.M[i, j] = floating[i, j]
    else:
        fill_dynamics(dynamics, step.q, step.q_dot, step.bodies, step.M, step.bias, step.weight)
    for j in range(n):
        step.bias[j] -= outside[j]


@compiled(counted=False)
def _reference(start: Array, end: Array, period: float, part: float, step: Step) -> None:
    """Cubic from start to end (2, n) at a part 0..1 of the period."""
    s, r = part, 1.0 - part
    for j in range(step.q_ref.size):
        q0, q1, v0, v1 = start[0, j], end[0, j], start[1, j] * period, end[1, j] * period
        step.q_ref[j] = (
            (1.0 + 2.0 * s) * r * r * q0 + s * r * r * v0 + s * s * (3.0 - 2.0 * s) * q1 - s * s * r * v1
        )
        step.v_ref[j] = (
            6.0 * s * r * (q1 - q0) + r * (1.0 - 3.0 * s) * v0 + s * (3.0 * s - 2.0) * v1
        ) / period


@compiled(counted=False)
def _ahead(drive: Array, state: Array, feed: Array, step: Step) -> None:
    """Fill the torques of the feed-forward, with friction in the direction of the position control.

    An axis at rest that should creep gets its stiction, so that it starts to move without waiting for the
    integrator, which would overshoot the target periodically.
    """
    for j in range(step.ahead.size):
        wanted = step.v_ref[j] + drive[POSITION_GAIN, j] * (step.q_ref[j] - state[MOTOR, j])
        friction = feed[1, j]
        if state[MOTOR_DOT, j] == 0.0:
            friction *= drive[STICTION, j]
        step.ahead[j] = feed[0, j] + friction * min(max(wanted / CREEP, -1.0), 1.0)


@compiled(counted=False)
def _motor_torques(drive: Array, state: Array, h: float, step: Step) -> None:
    """Fill the current.

    Cascade: speed error e = v_ref + position_gain (q_ref - motor) - motor_dot; torque
    velocity_gain (e + integral / integral_time) + ahead; then the current control, a second-order lag.
    """
    for j in range(state.shape[1]):
        if step.saturated[j] != 0.0:
            a, slope = step.saturated[j] * drive[TORQUE_LIMIT, j], 0.0
        else:
            gain = drive[VELOCITY_GAIN, j]
            growth = 1.0 + 0.5 * h / drive[INTEGRAL_TIME, j]
            kp = drive[POSITION_GAIN, j]
            a = gain * (
                growth * (step.v_ref[j] + kp * (step.q_ref[j] - state[MOTOR, j])) + state[INTEGRAL, j]
            )
            a += step.ahead[j]
            slope = gain * growth * (1.0 + 0.5 * h * kp)
        w = drive[CURRENT_FREQUENCY, j]
        if np.isfinite(w):
            lag = 0.25 * (h * w) ** 2
            divisor = 1.0 + h * drive[CURRENT_DAMPING, j] * w + lag
            a = (state[TORQUE, j] + 0.5 * h * state[TORQUE_RATE, j] + lag * a) / divisor
            slope = (lag * slope + 0.5 * h * drive[BACK_EMF, j]) / divisor
        step.current[0, j], step.current[1, j] = a, slope


@compiled(counted=False)
def _assemble(drive: Array, motors: NDArray[np.int64], state: Array, h: float, step: Step) -> None:
    """Fill A and b."""
    A, b, M, current = step.A, step.b, step.M, step.current
    n = state.shape[1]
    A[:], b[:] = 0.0, 0.0
    for i in range(n):
        total = 0.0
        for j in range(n):
            A[i, j] = M[i, j]
            total += M[i, j] * state[Q_DOT, j]
        b[i] = total - h * step.bias[i]
    for j in range(n):
        m = motors[j]
        speed = state[MOTOR_DOT, j]
        resist = 0.5 * h * (current[1, j] + drive[VISCOUS, j])
        A[m, m] += drive[INERTIA, j] + resist
        b[m] += (drive[INERTIA, j] - resist) * speed + h * current[0, j]
        if m == j:
            continue
        # The spring at the middle of the step, its ends moving at their mean speeds.
        stiffness, damping = drive[STIFFNESS, j], drive[DAMPING, j]
        coupling = 0.25 * h * h * stiffness + 0.5 * h * damping
        wind = state[MOTOR, j] - state[Q, j]
        push = h * stiffness * wind + coupling * (speed - state[Q_DOT, j])
        A[j, j] += coupling
        A[m, m] += coupling
        A[j, m] -= coupling
        A[m, j] -= coupling
        b[j] += push
        b[m] -= push


@compiled(counted=False)
def _solve_with_friction(drive: Array, motors: NDArray[np.int64], state: Array, h: float, step: Step) -> None:
    """Fill w: velocities at the end of the step with friction on the motors.

    The initial guess, with each axis sliding or at rest as before, is exact in nearly every step; sweeps over
    the axes (coordinate descent) converge to the minimum from any guess. An axis at rest is held up to its
    stiction; once it slips, it has sliding friction.
    """
    hold, slide, sign, stands, w = step.hold, step.slide, step.sign, step.stands, step.w
    n, size = state.shape[1], w.size
    hold[:], slide[:], sign[:], stands[:] = 0.0, 0.0, 0.0, False
    for j in range(n):
        m = motors[j]
        slide[m] = h * drive[COULOMB, j]
        hold[m] = slide[m]
        if state[MOTOR_DOT, j] == 0.0 and slide[m] > 0.0:
            stands[m] = True
            hold[m] *= drive[STICTION, j]
        else:
            sign[m] = np.sign(state[MOTOR_DOT, j])
    for i in range(size):
        w[i] = step.b[i] - sign[i] * slide[i]
    solve_free(step.A, stands, step.L, w)
    for j in range(n):
        m = motors[j]
        if slide[m] > 0.0 and w[m] * sign[m] <= 0.0:
            w[m] = 0.0
    for _ in range(size + 1):
        sweep(step.A, step.b, hold, w)
        slipped = False
        for i in range(size):
            if hold[i] > slide[i] and w[i] != 0.0:
                hold[i] = slide[i]
                slipped = True
        if not slipped:
            return


@compiled(counted=False)
def _saturate(drive: Array, motors: NDArray[np.int64], state: Array, h: float, step: Step) -> bool:
    """Set saturated to the sign of commanded torques past their limit; True if there is a new one."""
    found = False
    for j in range(state.shape[1]):
        if step.saturated[j] == 0.0:
            mean = 0.5 * (state[MOTOR_DOT, j] + step.w[motors[j]])
            torque = _wanted(drive, state, step, h, mean, j) + step.ahead[j]
            if abs(torque) > drive[TORQUE_LIMIT, j]:
                step.saturated[j] = np.sign(torque)
                found = True
    return found


@compiled(counted=False)
def _speed_error(drive: Array, state: Array, step: Step, h: float, mean: float, j: int) -> float:
    position = state[MOTOR, j] + 0.5 * h * mean
    return float(step.v_ref[j] + drive[POSITION_GAIN, j] * (step.q_ref[j] - position) - mean)


@compiled(counted=False)
def _wanted(drive: Array, state: Array, step: Step, h: float, mean: float, j: int) -> float:
    error = _speed_error(drive, state, step, h, mean, j)
    growth = 1.0 + 0.5 * h / drive[INTEGRAL_TIME, j]
    return float(drive[VELOCITY_GAIN, j] * (growth * error + state[INTEGRAL, j]))


@compiled(counted=False)
def _move(drive: Array, motors: NDArray[np.int64], state: Array, h: float, step: Step) -> None:
    """Write the end of the step into the state."""
    current, saturated, w = step.current, step.saturated, step.w
    n = state.shape[1]
    for j in range(n):
        state[Q_DDOT, j] = (w[j] - state[Q_DOT, j]) / h
    for j in range(n):
        mean = 0.5 * (state[MOTOR_DOT, j] + w[motors[j]])
        torque = current[0, j] - current[1, j] * mean
        wanted = _wanted(drive, state, step, h, mean, j) + step.ahead[j]
        if saturated[j] != 0.0:
            wanted = saturated[j] * drive[TORQUE_LIMIT, j]
        error = _speed_error(drive, state, step, h, mean, j)
        # Anti-windup: at the torque limit the integrator is frozen unless it unloads.
        if error * saturated[j] <= 0.0:
            state[INTEGRAL, j] += h / drive[INTEGRAL_TIME, j] * error
        frequency = drive[CURRENT_FREQUENCY, j]
        if np.isfinite(frequency):
            state[TORQUE_RATE, j] += h * frequency * frequency * (wanted - torque)
            state[TORQUE, j] = 2.0 * torque - state[TORQUE, j]
        else:
            state[TORQUE, j] = torque
        total = step.bias[j]
        for k in range(n):
            total += step.M[j, k] * state[Q_DDOT, k]
        state[JOINT_TORQUE, j] = total
        state[MOTOR, j] += h * mean
        state[MOTOR_DOT, j] = w[motors[j]]
    for j in range(n):
        state[Q, j] += 0.5 * h * (state[Q_DOT, j] + w[j])
        state[Q_DOT, j] = w[j]
