"""Inverse kinematics along a Cartesian path: from poses over s to a joint path over s."""

import numpy as np

from robots_core.blocks.inverse_kinematics.held_inverse_kinematics import inverse_kinematics_for
from robots_core.blocks.inverse_kinematics.hold import (
    DIRECTIONS,
    POSE,
    POSITION,
    condition_rows,
    describe_miss,
    held_by,
    missing_directions,
)
from robots_core.errors import PlanningError
from robots_core.kernels.serial_chain import SerialChain
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.path_kinematics.path_following_kernel import (
    BLOCKED,
    FOLLOWED,
    FULL,
    MAX_SAMPLES,
    OUTSIDE,
    SINGULAR_START,
    FreeAxes,
    JointSamples,
    follow,
)
from robots_planning.path_kinematics.route import RoutePiece
from robots_planning.paths.cartesian_path import CartesianPath
from robots_planning.paths.joint_path import JointPath

LOOK_AHEAD = 1e-3  # of the path, ahead of the last sample: the pose whose reachability is checked


class PathInverseKinematics:
    """Follows a path with q' = J^+ x' and q'' = d/ds (J^+ x'), corrected by Newton's method at each sample.

    Redundant robots move with the smallest joint velocities (pseudo-inverse). Samples are as far apart as the
    interpolation between them stays on the path; near a singularity they are close together. An instance
    keeps scratch memory: use one per thread.

    Args:
        robot: The robot.
        tool: Pose of the tool centre point in tool0, which follows the path; tool0 itself by default.
        hold: What of the poses is held, see `held_by`; what the arm can by default.

    Raises:
        InvalidInputError: a robot whose axes are coupled, or a `hold` that does not exist.
    """

    def __init__(self, robot: BaseRobotModel, tool: Pose | None = None, *, hold: str = '') -> None:
        self.robot, self.tool = robot, tool
        self.hold = held_by(robot.num_axes, hold)
        self._axes = robot.axes_data
        self.chain = SerialChain.of(robot, tool)
        self.limits = np.array([self._axes.lower, self._axes.upper])
        """Lowest and highest joint positions, (2, n)."""
        self._endless = np.array([[-np.inf], [np.inf]]) * np.ones(robot.num_axes)
        n = robot.num_axes
        self._rows = 0 if self.hold == POSE else condition_rows(self.hold, n)
        self._unguided = FreeAxes(0.0, np.array([0.0, 1.0]), np.zeros((4, 1, n)))
        self._samples = (
            np.empty(MAX_SAMPLES + 1),
            np.empty((MAX_SAMPLES + 1, n)),
            np.empty((MAX_SAMPLES + 1, n)),
            np.empty((MAX_SAMPLES + 1, n)),
        )

    def pose(self, q: Array) -> Pose:
        """Pose of the tool centre point at joint positions `q`, (n,)."""
        return self.chain.forward(q)

    def follow(self, path: CartesianPath, start: Array) -> JointPath:
        """The joint path (k samples) of a path that begins at joint positions `start`, (n,).

        Raises:
            PlanningError: the path leaves the axis limits or the reach, or crosses a singularity; names the
                fraction of the path, the joint, its value and bound, and what would help.
        """
        result, count = self._fill(path, start, self.limits)
        s, q, _, _ = self._samples
        if result == FOLLOWED:
            return JointPath(*self._filled(count))
        if result == SINGULAR_START:
            raise self._singular(path, 0.0, q[0].copy())
        if result == OUTSIDE:
            raise self._outside(path, s[count - 1 : count + 1], q[count - 1 : count + 1])
        fraction = float(s[count - 1])
        if result == FULL:
            raise PlanningError(
                f'the {path.kind} takes more than {MAX_SAMPLES} path samples, which end at '
                f'{100.0 * fraction:.1f} % of its {path.describe_length()}: split it into shorter ones, or '
                f'leave out poses',
                fraction=fraction,
            )
        raise self._blocked(path, fraction, q[count - 1].copy())

    def follow_far(
        self, path: CartesianPath, start: Array, *, inside_limits: bool = False
    ) -> tuple[RoutePiece | None, bool]:
        """Follow as far as possible; axis limits are ignored unless `inside_limits`.

        Returns:
            What was followed, None if not even one step was possible; and whether no further one is possible
            at its end: a singularity, or out of reach.
        """
        result, count = self._fill(path, start, self.limits if inside_limits else self._endless)
        blocked = result in {BLOCKED, SINGULAR_START}
        if count < 2:
            return None, blocked
        return RoutePiece(JointPath(*self._filled(count)), 0.0, float(self._samples[0][count - 1])), blocked

    def follow_guided(
        self, path: CartesianPath, start: Array, breaks: Array, guide: Array, pull: float
    ) -> JointPath | None:
        """Follow with self-motion towards a guide, see `FreeAxes`; None if that fails."""
        result, count = self._fill(path, start, self.limits, FreeAxes(pull, breaks, guide))
        return JointPath(*self._filled(count)) if result == FOLLOWED else None

    def _fill(
        self, path: CartesianPath, start: Array, limits: Array, guided: FreeAxes | None = None
    ) -> tuple[int, int]:
        """Fill the samples; return what the kernel's `follow` returns."""
        begin = np.array(start, dtype=np.float64)
        free = guided or self._unguided
        return follow(self.chain.arrays, limits, path.arrays, free, self._rows, begin, self._samples)

    def _filled(self, count: int) -> JointSamples:
        """Copy of the first samples, with s scaled to [0, 1]."""
        s, q, q_s, q_ss = (values[:count] for values in self._samples)
        end = s[-1]
        return s / end, q.copy(), q_s * end, q_ss * end**2

    def _outside(self, path: CartesianPath, s: Array, q: Array) -> PlanningError:
        """The error for a limit that is passed between two samples, s (2,) and q (2, n)."""
        axes, (before, after) = self._axes, q
        axis = int(np.argmax(np.maximum(axes.lower - after, after - axes.upper)))
        bound = float(axes.lower[axis] if after[axis] < axes.lower[axis] else axes.upper[axis])
        span = float(after[axis] - before[axis])
        part = min(max((bound - float(before[axis])) / span, 0.0), 1.0) if span else 0.0
        fraction = float(s[0] + part * (s[1] - s[0]))
        name, unit = axes.names[axis], axes.unit(axis)
        return PlanningError(
            f'the {path.kind} leaves the axis limits at {100.0 * fraction:.1f} % of its '
            f'{path.describe_length()}: {name} would pass {bound:.6g} {unit} and have {after[axis]:.6g} '
            f'{unit} at {100.0 * s[1]:.1f} %, allowed is [{axes.lower[axis]:.6g}, {axes.upper[axis]:.6g}] '
            f'{unit}; start in another configuration, shorten the {path.kind}, or move in joint space',
            fraction=fraction,
            joint=name,
            value=float(after[axis]),
            bound=bound,
            unit=unit,
        )

    def _blocked(self, path: CartesianPath, fraction: float, q: Array) -> PlanningError:
        """The error where no step along the path is possible: out of reach, or a singularity."""
        s = min(fraction + LOOK_AHEAD, 1.0)
        inside = np.clip(q, self._axes.lower, self._axes.upper)
        closest = inverse_kinematics_for(self.robot, tool=self.tool, hold=self.hold)
        near = closest.solve(path.pose(s), inside)
        if near.converged:
            return self._singular(path, fraction, q)
        return PlanningError(
            f'the {path.kind} leaves the reach of {self.robot.name} at {100.0 * fraction:.1f} % of its '
            f'{path.describe_length()}: the closest pose found for {100.0 * s:.1f} % is '
            f'{describe_miss(near, self.hold)} off; move the {path.kind} closer to the robot or turn the tool'
            f'{missing_directions(self.robot, near.q, self.hold)}',
            fraction=fraction,
            position_error=near.position_error,
            orientation_error=near.orientation_error,
        )

    def _singular(self, path: CartesianPath, fraction: float, q: Array) -> PlanningError:
        J = self.robot.jacobian(q)
        _, values, directions = np.linalg.svd(J[:3] if self.hold == POSITION else J)
        axis = int(np.argmax(np.abs(directions[len(values) - 1])))
        name = self._axes.names[axis]
        if self.hold == DIRECTIONS:
            return PlanningError(
                f'the orientation closest to that of the {path.kind} ends or jumps at '
                f'{100.0 * fraction:.1f} % of its {path.describe_length()}: {self.robot.name} cannot turn '
                f"the tool as it should there; hold the 'position' alone, or turn the tool less",
                fraction=fraction,
                joint=name,
                value=float(q[axis]),
            )
        return PlanningError(
            f'the {path.kind} meets a singularity at {100.0 * fraction:.1f} % of its '
            f'{path.describe_length()}: {name} would have to turn without bound at {q[axis]:.6g} '
            f'{self._axes.unit(axis)} (smallest singular value of the Jacobian {values[-1]:.2g}); move in '
            f'joint space, or shift or tilt the {path.kind} a little',
            fraction=fraction,
            joint=name,
            value=float(q[axis]),
            smallest_singular_value=float(values[-1]),
        )
