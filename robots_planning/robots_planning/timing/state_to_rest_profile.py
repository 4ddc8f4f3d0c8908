# ruff: noqa: PLR0917, C901  # compiled loops over arrays
"""Time-optimal jerk-limited motion of all axes from any state to rest, by Ruckig, with common switches."""

from math import sqrt
from operator import mul

import numpy as np
from numpy.typing import NDArray
from ruckig import InputParameter, Result, Ruckig, RuckigError, Synchronization
from ruckig import Trajectory as RuckigTrajectory

from robots_core.kernels.compiled import compiled
from robots_core.robot_model.axes_data import LIMIT_TOLERANCE
from robots_core.validation import Array
from robots_planning.trajectory_generators.trajectory_generator import LIMIT_MARGIN

NANOSECOND = 1e-9  # s
# Fractions of the jerk limit that an axis is planned with, tried in turn: moving its switches of jerk onto
# those of other axes changes its jerks relatively by about the shift over the length of a piece.
JERK_PARTS = (1.0, 0.998, 0.995, 0.99, 0.98, 0.96, 0.93, 0.8, 0.6)
# Motions too short for that are divided into equal pieces, of these multiples of the shortest length.
EVEN_PIECES = (1, 2, 4, 8, 16, 32, 64)
NO_JERK = 1e-30  # initial jerk of these pieces; 0 would mark them as cruising
# The part by which velocity and acceleration limits are lowered with that of the jerk.
LOWERED = 0.2
NEARLY = 0.9  # of the velocity limit, reached by the acceleration at the start alone
WEIGHT_OF_PLATEAUS = 1e-3
# Of the jerk limit (of the acceleration limit for an urgent axis), for removing the residual at the end.
ALLOWED_ERROR = 1e-4
# Limits of an urgent axis, one about to leave its position limits, tried in turn: the planner's without the
# commanded fractions; the full limits; the full limits exceeded by what moving the switches costs
# (acceleration, jerk).
RESERVES = (1.0 - LIMIT_MARGIN, 1.0, 1.0)
EXCESS = ((1.0, 1.0), (1.0, 1.0), (1.0 + 8e-4, 1.02))
# Switches of an urgent axis are moved only if closer than this, where the quintic between them is
# ill-conditioned.
CLOSEST = 30_000  # ns
SOUND, BREAKS_LIMIT, LEAVES_RANGE = 0, 1, 2

Instants = NDArray[np.int64]
"""Nanoseconds from the start."""


class NoProfileError(Exception):
    """No profile keeps the limits of an axis.

    Attributes:
        axis: Its index.
    """

    def __init__(self, axis: int) -> None:
        super().__init__(axis)
        self.axis = axis


class StateToRestProfile:
    """Time-optimal motion from a state to rest; an instance keeps Ruckig's objects.

    Ruckig (Berscheid and Kroeger 2021) finds when the jerk of each axis switches. The switches are moved to
    whole nanoseconds, and onto those of other axes that are closer than `shortest`; the jerks are then
    corrected by the smallest changes that reach the target again.

    Args:
        reach: (2, n): lowest and highest positions.
        synchronization: Of Ruckig: Time (all axes end together) or No.
        shortest: Of a piece of constant jerk, ns.
    """

    def __init__(self, reach: Array, synchronization: Synchronization, shortest: int) -> None:
        n = reach.shape[1]
        self._reach, self._shortest = reach, shortest
        self._ruckig, self._input, self._found = Ruckig(n), InputParameter(n), RuckigTrajectory(n)
        self._synchronization = synchronization
        self._input.synchronization = synchronization

    def plan(
        self, state: Array, target: Array, limits: Array, allowed: Array, full: Array
    ) -> tuple[Array, Array, Array, Array]:
        """Times (m,), s, positions, velocities and accelerations, (m, n) each.

        Args:
            state: (3, n): position, velocity and acceleration at the start.
            target: (n,), positions at rest at the end.
            limits: (3, n): velocity, acceleration and jerk to plan with.
            allowed: (3, n): limits that the plan must keep; a start above them is brought below.
            full: (3, n): limits that the axes have, to brake with.

        An axis that would leave its position limits brakes independently.

        Raises:
            NoProfileError: no profile keeps the limits.
        """
        lower, upper = self._reach
        # Copies, also of the target: read-only arrays would be compiled for once more.
        limits, allowed, target = limits.copy(), allowed.copy(), target.copy()
        slower, urgent = [0] * target.size, np.zeros(target.size, dtype=np.int64)
        axis = 0
        while True:
            segments = self._segments(state, target, limits, slower, urgent)
            if segments is None:
                break
            status, axis, *points = on_common_switches(
                segments[0], segments[1], state, target, allowed, full, lower, upper, urgent,
                self._shortest,
            )  # fmt: skip
            if status == SOUND:
                return points[0], points[1], points[2], points[3]
            if status == LEAVES_RANGE or urgent[axis]:
                if urgent[axis] < len(RESERVES):
                    level, slower[axis] = urgent[axis], 0
                    limits[1:, axis] = RESERVES[level] * full[1:, axis]
                    allowed[:, axis] = full[:, axis]
                    allowed[1:, axis] *= EXCESS[level]
                    urgent[axis] += 1
                    continue
                slower[axis] = max(slower[axis], len(JERK_PARTS) - 1)
            slower[axis] += 1
            if slower[axis] == len(JERK_PARTS) + len(EVEN_PIECES):
                break
        raise NoProfileError(axis)

    def _segments(
        self, state: Array, target: Array, limits: Array, slower: list[int], urgent: NDArray[np.int64]
    ) -> tuple[Array, Array] | None:
        """Durations and jerks (n, 9) of Ruckig's profile, its brake pieces first."""
        command = self._input
        command.current_position, command.current_velocity, command.current_acceleration = state.tolist()
        command.target_position = target.tolist()
        parts = [JERK_PARTS[min(level, len(JERK_PARTS) - 1)] for level in slower]
        reached = [1.0 - LOWERED * (1.0 - part) for part in parts]
        velocity, acceleration, jerk = limits.tolist()
        command.max_velocity = list(map(mul, velocity, reached))
        command.max_acceleration = list(map(mul, acceleration, reached))
        command.max_jerk = list(map(mul, jerk, parts))
        levels = urgent.tolist()
        command.per_dof_synchronization = (
            [Synchronization.No if level else self._synchronization for level in levels]
            if any(levels)
            else None
        )
        try:
            result = self._ruckig.calculate(command, self._found)
        except (RuckigError, ValueError):  # ValueError: a result that Ruckig's own enumeration lacks
            return None
        if result not in (Result.Working, Result.Finished):
            return None
        profiles = self._found.profiles[0]
        durations = np.array([[*profile.brake.t, *profile.t] for profile in profiles])
        jerks = np.array([[*profile.brake.j, *profile.j] for profile in profiles])
        for axis, level in enumerate(slower):
            if level >= len(JERK_PARTS):
                length = EVEN_PIECES[level - len(JERK_PARTS)] * self._shortest * NANOSECOND
                durations[axis], jerks[axis] = length, NO_JERK
        if any(levels):
            # A braking motion may have only two pieces, too few to correct; halves are enough.
            return np.repeat(0.5 * durations, 2, axis=1), np.repeat(jerks, 2, axis=1)
        return durations, jerks


@compiled()
def on_common_switches(
    durations: Array,
    jerks: Array,
    state: Array,
    target: Array,
    allowed: Array,
    full: Array,
    lower: Array,
    upper: Array,
    urgent: NDArray[np.int64],
    shortest: int,
) -> tuple[int, int, Array, Array, Array, Array]:
    """Profiles whose switches coincide or are far enough apart: status, the axis at fault, and points."""
    n, pieces = durations.shape
    none, empty = np.empty(0), np.empty((0, n))
    ends = np.zeros((n, pieces + 1), dtype=np.int64)
    corrected = jerks.copy()
    known, count = np.zeros(n * pieces + 1, dtype=np.int64), 1
    for place in range(2 * n):
        # Urgent axes come first, so that their switches stay in place.
        i = place % n
        if (urgent[i] > 0) != (place < n):
            continue
        distance = CLOSEST if urgent[i] else shortest
        count = _common_switches(durations[i], ends[i], known, count, distance)
        if ends[i, pieces] == 0 and (state[0, i] != target[i] or state[1, i] != 0.0 or state[2, i] != 0.0):
            # A motion of the size of rounding becomes one piece.
            ends[i, pieces] = _known_switch(distance, known, count, distance)
            if ends[i, pieces] <= 0:
                known[count] = ends[i, pieces] = distance
                count += 1
        _correct(ends[i], durations[i], corrected[i], state[:, i], target[i])
        status = _keeps(ends[i], corrected[i], state[:, i], allowed[:, i], full[0, i], lower[i], upper[i])
        if status != SOUND:
            return status, i, none, empty, empty, empty
    together = _distinct(ends.ravel())
    m = together.size
    time, q, q_dot, q_ddot = together / 1e9, np.empty((m, n)), np.empty((m, n)), np.empty((m, n))
    for i in range(n):
        p, v, a = 0.0, state[1, i], state[2, i]
        k, last = 0, 0
        for row in range(m):
            if row > 0 and together[row] <= ends[i, pieces]:
                while k < pieces - 1 and ends[i, k + 1] < together[row]:
                    k += 1
                h, j = (together[row] - together[row - 1]) * NANOSECOND, corrected[i, k]
                p, v, a = _moved(p, v, a, j, h)
                last = row
            q[row, i], q_dot[row, i], q_ddot[row, i] = state[0, i] + p, v, a
        if last == 0:  # at rest at its target
            continue
        # The residual of rounding at the end is spread over the motion: removed in the last interval alone it
        # would need a jerk. For a motion of the size of rounding it may still be too large.
        p += state[0, i] - target[i]
        total, h = time[last], (CLOSEST if urgent[i] else shortest) * NANOSECOND
        jerk = (60.0 * abs(p) / h**2 + 36.0 * abs(v) / h + 9.0 * abs(a)) / total
        if jerk > ALLOWED_ERROR * (full[1, i] / h if urgent[i] else full[2, i]):
            return BREAKS_LIMIT, i, none, empty, empty, empty
        for row in range(1, last):
            share = time[row] / total
            q[row, i] -= share * p
            q_dot[row, i] -= share * v
            q_ddot[row, i] -= share * a
        q[last:, i], q_dot[last:, i], q_ddot[last:, i] = target[i], 0.0, 0.0
    return SOUND, 0, time, q, q_dot, q_ddot


@compiled()
def _common_switches(durations: Array, ends: Instants, known: Instants, count: int, distance: int) -> int:
    """Fill the ends of an axis' pieces, moved to a known switch if one is nearer than `distance`, ns.

    New switches are appended to the `count` known ones; the new count is returned. The order of the ends is
    kept, because known switches are at least `distance` apart.
    """
    t = 0.0
    for k in range(durations.size):
        t += durations[k]
        instant = round(t / NANOSECOND)
        switch = _known_switch(instant, known, count, distance)
        if switch < 0:
            known[count] = switch = instant
            count += 1
        ends[k + 1] = max(switch, ends[k])
    return count


@compiled()
def _known_switch(instant: int, known: Instants, count: int, distance: int) -> int:
    """The nearest of the known switches, -1 if there is none nearer than `distance`."""
    nearest = 0
    for index in range(1, count):
        if abs(known[index] - instant) < abs(known[nearest] - instant):
            nearest = index
    return known[nearest] if abs(known[nearest] - instant) < distance else -1


@compiled()
def _correct(ends: Instants, durations: Array, jerks: Array, state: Array, target: float) -> None:
    """Change the jerks by the least norm that ends at rest at the target; cruising pieces keep cruising."""
    pieces = jerks.size
    total = ends[pieces] * NANOSECOND
    if total == 0.0:
        return
    # Time in units of the duration, which scales the columns alike.
    begin, length = ends[:-1] * NANOSECOND / total, (ends[1:] - ends[:-1]) * NANOSECOND / total
    # Pieces without jerk and acceleration in Ruckig's profile.
    cruising = np.zeros(pieces, dtype=np.bool_)
    small, a, rows = 1e-9 * (abs(state[2]) + np.abs(jerks * durations).max()), state[2], 3
    for k in range(pieces):
        if jerks[k] == 0.0 and abs(a) <= small:
            cruising[k] = True
            rows += 1
        a += jerks[k] * durations[k]
    for _ in range(2):
        C, e = np.zeros((rows, pieces)), np.zeros(rows)
        p, v, a = (state[0] - target) / total**3, state[1] / total**2, state[2] / total
        row = 3
        for k in range(pieces):
            h, rest = length[k], 1.0 - begin[k] - length[k]
            if cruising[k]:
                for other in range(k):
                    C[row, other] = length[other]
                e[row] = -a
                row += 1
            j = jerks[k]
            p, v, a = _moved(p, v, a, j, h)
            C[0, k] = h**3 / 6.0 + 0.5 * h * h * rest + 0.5 * h * rest * rest
            C[1, k] = 0.5 * h * h + h * rest
            C[2, k] = h
        e[0], e[1], e[2] = -p, -v, -a
        weight = np.ones(pieces)
        for k in range(pieces):
            if cruising[k]:
                weight[k] = 0.0
            elif jerks[k] == 0.0:
                weight[k] = WEIGHT_OF_PLATEAUS
            C[:, k] *= weight[k]
        jerks += weight * np.linalg.lstsq(C, e, 1e-12)[0]


@compiled()
def _keeps(
    ends: Instants, jerks: Array, state: Array, allowed: Array, full_speed: float, lower: float, upper: float
) -> int:
    """Whether position, velocity, acceleration and jerk stay inside the limits at every instant."""
    q, v, a = state[0], state[1], state[2]
    # A start above the allowed velocity may exceed it by what its acceleration adds.
    rising = max(abs(v), abs(v + 0.5 * a * abs(a) / allowed[2] * (1.0 + 2.0 * LIMIT_MARGIN)))
    fastest = max(allowed[0], min(rising, full_speed * (1.0 + 2.0 * LIMIT_MARGIN)))
    strongest = max(allowed[1], abs(a))
    status = SOUND
    for k in range(jerks.size):
        h, j = (ends[k + 1] - ends[k]) * NANOSECOND, jerks[k]
        if h == 0.0:
            continue
        if abs(j) > allowed[2]:
            status = BREAKS_LIMIT
        # Velocity is extreme where acceleration is zero, position where velocity is zero.
        inner = np.zeros(3)
        if j != 0.0:
            inner[0] = -a / j
            square = a * a - 2.0 * j * v
            if square >= 0.0:
                inner[1], inner[2] = (-a - sqrt(square)) / j, (-a + sqrt(square)) / j
        elif a != 0.0:
            inner[0] = -v / a
        for t in (inner[0], inner[1], inner[2], h):
            if 0.0 < t <= h:
                position, speed, _ = _moved(q, v, a, j, t)
                if not lower - LIMIT_TOLERANCE <= position <= upper + LIMIT_TOLERANCE:
                    return LEAVES_RANGE
                if abs(speed) > fastest:
                    # An axis that accelerates towards its velocity limit needs all of its jerk.
                    status = LEAVES_RANGE if rising > NEARLY * allowed[0] else BREAKS_LIMIT
        q, v, a = _moved(q, v, a, j, h)
        if abs(a) > strongest * (1.0 + 1e-12):
            status = BREAKS_LIMIT
    return status


@compiled()
def _moved(p: float, v: float, a: float, j: float, h: float) -> tuple[float, float, float]:
    """Position, velocity and acceleration after a time h of constant jerk j."""
    return p + h * (v + h * (0.5 * a + h * j / 6.0)), v + h * (a + 0.5 * h * j), a + h * j


@compiled()
def _distinct(instants: Instants) -> Instants:
    """The instants, sorted and without duplicates."""
    ordered = np.empty_like(instants)
    count = 0
    for value in instants:  # by insertion: compiling np.sort takes 1.5 s
        k = count
        while k > 0 and ordered[k - 1] > value:
            k -= 1
        if k == 0 or ordered[k - 1] < value:
            for later in range(count, k, -1):
                ordered[later] = ordered[later - 1]
            ordered[k] = value
            count += 1
    return ordered[:count].copy()
