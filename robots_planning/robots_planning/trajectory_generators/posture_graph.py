"""PostureGraph: which postures a robot takes along a line."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from robots_core.blocks.inverse_kinematics.analytical import AnalyticalInverseKinematic
from robots_core.blocks.inverse_kinematics.chain import SerialChain
from robots_core.blocks.inverse_kinematics.damped_least_squares import DampedLeastSquares
from robots_core.errors import NoAnalyticInverseKinematicsError, PlanningError, RobotsError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.trajectory_generators.cartesian_line import CartesianLine
from robots_planning.trajectory_generators.joint_path import JointPath
from robots_planning.trajectory_generators.path_following_kernel import FOLLOWED, MOST_KNOTS
from robots_planning.trajectory_generators.path_inverse_kinematics import PathInverseKinematics
from robots_planning.trajectory_generators.self_motion_kernel import (
    MOST_POSTURES,
    cheapest_postures,
    follow_guide,
    follow_layers,
    relax,
)

LAYER_LENGTH = 0.03  # m and rad between the poses at which self-motion is sampled
LAYERS = (12, 36)  # fewest and most
RELAXATIONS = (60, 15, 0)  # tried in turn: smoother postures may come nearer to limits than the search
LIMIT_ROOM = 0.03  # rad (m) that smoothed postures leave to the limits
# While the wrist turns over in a singularity the tool stays within this, m and rad.
STANDSTILL = 1e-6
TURN_CHECKS = 17
LARGEST_GAP = 1e-5  # of the line, that lies between two branches at a singularity
OTHER_STARTS = 16  # random ones, where there is no closed form
SMALLEST_TURN = 1e-7  # rad; less is rounding


@dataclass(frozen=True, eq=False)
class RoutePiece:
    """A joint path and what the tool does on it.

    Attributes:
        joints: The path.
        line: Of the tool; None where it stands still while the posture changes.
    """

    joints: JointPath
    line: CartesianLine | None


Route = tuple[RoutePiece, ...]


class PostureGraph:
    """Finds continuous postures from a start along a line, inside the axis limits.

    Six axes leave no choice but in singularities: where the posture cannot go on, the line is also followed
    from every other branch back to that place, and a branch that the axes can turn to while the tool stands
    still is taken. With more axes, postures are sampled by self-motion at poses along the line, the sequence
    that the axes pass soonest at full speed is found by dynamic programming (over line and posture), smoothed
    by self-motion, and followed; besides, there is the path of least joint motion.

    Args:
        robot: The robot.
        kinematics: Of the tool along paths.
        tool: Pose of the tool centre point in tool0.
    """

    def __init__(
        self, robot: BaseRobotModel, kinematics: PathInverseKinematics, tool: Pose | None = None
    ) -> None:
        self._robot, self._kinematics, self._tool = robot, kinematics, tool
        self._axes = robot.axes_data
        self._chain = SerialChain.of(robot, tool).arrays
        self._limits = np.array([self._axes.lower, self._axes.upper])
        self._analytic: AnalyticalInverseKinematic | None
        try:
            self._analytic = AnalyticalInverseKinematic(robot, tool=tool)
        except NoAnalyticInverseKinematicsError:
            self._analytic = None

    def routes(self, line: CartesianLine, start: Array) -> list[Route]:
        """Ways along a line that begins at joint positions `start`, (n,); at least one.

        Raises:
            PlanningError: there is none; says at which part of the line what stops the posture, and from
                which configuration the line could be done.
        """
        found: list[Route] = []
        reason: PlanningError | None = None
        try:
            found.append((RoutePiece(self._kinematics.follow(line, start), line),))
        except PlanningError as error:
            reason = error
        if self._robot.num_axes > 6:
            guided = self._guided(line, start)
            if guided is not None:
                found.append((RoutePiece(guided, line),))
        elif reason is not None and 'smallest_singular_value' in reason.details:
            found.extend(self._through_singularity(line, start, float(reason.details['fraction'])))
        if not found:
            assert reason is not None
            raise self._explained(reason, line, start)
        return found

    # More than six axes

    def _guided(self, line: CartesianLine, start: Array) -> JointPath | None:
        n = self._robot.num_axes
        count = int(np.clip(np.ceil((line.length + line.angle) / LAYER_LENGTH), *LAYERS))
        s = np.linspace(0.0, 1.0, count + 1)
        layers, chosen = np.empty((count + 1, MOST_POSTURES, n)), np.empty((count + 1, n))
        begin = np.ascontiguousarray(start, dtype=np.float64)
        reached, counts = follow_layers(self._chain, self._limits, line.arrays, s, begin, layers)
        if reached <= count or cheapest_postures(layers, counts, self._axes.velocity, chosen) <= count:
            return None
        size = MOST_KNOTS + 1
        knots = (np.empty(size), np.empty((size, n)), np.empty((size, n)), np.empty((size, n)))
        for rounds in RELAXATIONS:
            smooth = chosen.copy()
            relax(self._chain, self._limits, line.arrays, s, LIMIT_ROOM, rounds, smooth)
            spline = CubicSpline(s, smooth, axis=0, bc_type='natural')
            guide = (s, np.ascontiguousarray(spline.c))
            result, last = follow_guide(self._chain, self._limits, line.arrays, begin, guide, knots)
            if result == FOLLOWED:
                return JointPath(*(values[:last].copy() for values in knots))
        return None

    # Six axes in a singularity

    def _through_singularity(self, line: CartesianLine, start: Array, fraction: float) -> list[Route]:
        """Ways with a standstill at `fraction` of the line, at which the posture changes."""
        if self._analytic is None:
            return []
        first: Route = ()
        begin = start
        if fraction > 0.0:
            part = CartesianLine(line.start, line.pose(fraction))
            try:
                joints = self._kinematics.follow(part, start)
            except PlanningError:
                return []
            first, begin = (RoutePiece(joints, part),), joints.q[-1]
        ways: list[tuple[float, Route]] = []
        middle = 0.5 * (fraction + 1.0)
        for posture in self._analytic.solve_all(line.pose(middle), turns=True):
            onward = self._from_middle(line, fraction, middle, posture)
            if onward is None:
                continue
            turn = onward.joints.q[0] - begin
            if not self._stands_still(line.pose(fraction), begin, turn):
                continue
            cost = float((np.abs(turn) / self._axes.velocity).max())
            ways.append((cost, (*first, *_turn(begin, turn), onward)))
        # The cost of the rest of the line is found by timing it.
        return [route for _, route in sorted(ways, key=lambda way: way[0])]

    def _from_middle(
        self, line: CartesianLine, fraction: float, middle: float, posture: Array
    ) -> RoutePiece | None:
        """The rest of the line behind `fraction`, for a posture at `middle`."""
        pose = line.pose(middle)
        begin = fraction
        try:
            try:
                back = self._kinematics.follow(CartesianLine(pose, line.pose(begin)), posture)
            except PlanningError as error:
                # Back into the singularity: as near as it goes.
                begin = middle - float(error.details['fraction']) * (middle - fraction)
                if begin - fraction > LARGEST_GAP:
                    return None
                back = self._kinematics.follow(CartesianLine(pose, line.pose(begin)), posture)
            ahead = self._kinematics.follow(CartesianLine(pose, line.end), posture)
        except RobotsError:
            return None
        return RoutePiece(
            _joined(back, ahead, (middle - begin) / (1.0 - begin)), CartesianLine(line.pose(begin), line.end)
        )

    def _stands_still(self, pose: Pose, begin: Array, turn: Array) -> bool:
        """Whether the tool stays where it is while the axes turn along a straight line in joint space."""
        axes = self._axes
        for part in np.linspace(0.0, 1.0, TURN_CHECKS):
            q = begin + part * turn
            if ((q < axes.lower - 1e-9) | (q > axes.upper + 1e-9)).any():
                return False
            if max(self._kinematics.pose(q).distance_to(pose)) > STANDSTILL:
                return False
        return True

    # Why not

    def _explained(self, reason: PlanningError, line: CartesianLine, start: Array) -> PlanningError:
        """The reason, with the configurations from which the line can be done."""
        able = []
        for posture in self._other_starts(line.start):
            try:
                self._kinematics.follow(line, posture)
            except PlanningError:
                continue
            able.append(posture)
        if not able:
            advice, details = '; no other configuration at its start was found that can do it', {}
        else:
            times = [float((np.abs(q - start) / self._axes.velocity).max()) for q in able]
            nearest = able[int(np.argmin(times))]
            values = ', '.join(
                f'{name} = {value:.4g}' for name, value in zip(self._axes.names, nearest, strict=True)
            )
            name = '' if self._analytic is None else f' {self._analytic.configuration(nearest)}'
            advice = f'; it can be done from configuration{name} ({values})'
            details = {'configuration': name.strip() or values}
        return PlanningError(reason.message + advice, **reason.details, **details)

    def _other_starts(self, pose: Pose) -> list[Array]:
        if self._analytic is not None:
            return list(self._analytic.solve_all(pose, turns=True))
        rng, axes = np.random.default_rng(0), self._axes
        low = np.where(axes.continuous, -np.pi, axes.lower)
        high = np.where(axes.continuous, np.pi, axes.upper)
        search = DampedLeastSquares(self._robot, tool=self._tool, restarts=0)
        results = [search.solve(pose, rng.uniform(low, high)) for _ in range(OTHER_STARTS)]
        return [result.q for result in results if result.converged]


def _turn(begin: Array, turn: Array) -> Route:
    """A change of posture straight in joint space; nothing if there is none."""
    if float(np.abs(turn).max()) < SMALLEST_TURN:
        return ()
    way, still = np.stack([turn, turn]), np.zeros((2, len(turn)))
    return (RoutePiece(JointPath(np.array([0.0, 1.0]), np.stack([begin, begin + turn]), way, still), None),)


def _joined(back: JointPath, ahead: JointPath, middle: float) -> JointPath:
    """One path of two that begin at the same posture: the first backwards, up to `middle` of the whole."""
    rest = 1.0 - middle
    s = np.concatenate([middle * (1.0 - back.s[::-1]), middle + rest * ahead.s[1:]])
    s[0], s[-1] = 0.0, 1.0
    return JointPath(
        s,
        np.concatenate([back.q[::-1], ahead.q[1:]]),
        np.concatenate([-back.q_s[::-1] / middle, ahead.q_s[1:] / rest]),
        np.concatenate([back.q_ss[::-1] / middle**2, ahead.q_ss[1:] / rest**2]),
    )
