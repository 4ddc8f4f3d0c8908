"""PostureGraph: which postures a robot takes along a path of the tool."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline

from robots_core.blocks.inverse_kinematics.analytical import AnalyticalInverseKinematic
from robots_core.blocks.inverse_kinematics.chain import SerialChain
from robots_core.blocks.inverse_kinematics.damped_least_squares import DampedLeastSquares
from robots_core.errors import NoAnalyticInverseKinematicsError, PlanningError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.trajectory_generators.cartesian_path import CartesianPath
from robots_planning.trajectory_generators.joint_path import JointPath
from robots_planning.trajectory_generators.path_following_kernel import (
    FOLLOWED,
    MOST_KNOTS,
    stand_still,
    stays_inside,
)
from robots_planning.trajectory_generators.path_inverse_kinematics import PathInverseKinematics
from robots_planning.trajectory_generators.self_motion_kernel import (
    MOST_POSTURES,
    cheapest_postures,
    follow_guide,
    follow_layers,
    relax,
)

LAYER_LENGTH = 0.03  # m and rad between the poses at which self-motion is sampled
LAYERS = (12, 120)  # fewest and most
RELAXATIONS = (60, 15, 0)  # tried in turn: smoother postures may come nearer to limits than the search
LIMIT_ROOM = 0.03  # rad (m) that smoothed postures leave to the limits
BESIDE = 0.02  # of the path behind a singularity: where postures are looked for from which to go back into it
# m and rad behind the singularity where the ways back end, tried in turn: closer by some turn ever faster to
# no use, and others come to where the tool can stand still only there.
NEAR = (3e-7, 0.0)
LARGEST_GAP = 1e-5  # of the path, that lies between two branches at a singularity
OTHER_STARTS = 16  # random ones, where there is no closed form
SMALLEST_TURN = 1e-7  # rad; less is rounding


@dataclass(frozen=True, eq=False)
class RoutePiece:
    """A joint path along a part of the tool's path.

    Attributes:
        joints: The joint path.
        begin: Where the part begins, in s of the whole path.
        end: Where it ends; at its begin where the tool stands still while the posture changes.
    """

    joints: JointPath
    begin: float
    end: float

    def turned(self, turn: Array) -> RoutePiece:
        """The same with every axis turned by as much, (n,) rad, all the way."""
        joints = self.joints
        return replace(self, joints=JointPath(joints.s, joints.q + turn, joints.q_s, joints.q_ss))

    def tool(self, path: CartesianPath) -> CartesianPath:
        """What the tool does on it, of its whole `path`."""
        return _part(path, self.begin, self.end)


Route = tuple[RoutePiece, ...]
Alike = tuple[Array, Array]
"""A posture, (n,), and the whole turns from there to those like it, (k, n)."""


class PostureGraph:
    """Finds continuous postures from a start along a path of the tool, inside the axis limits.

    Six axes leave no choice but in singularities: where the posture cannot go on, the path is also followed
    from every other branch back to that place, and a branch that the axes can turn to while the tool stands
    still is taken. With more axes, postures are sampled by self-motion at poses along the path, the sequence
    that the axes pass soonest at full speed is found by dynamic programming (over path and posture), smoothed
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

    def routes(self, path: CartesianPath, start: Array) -> list[Route]:
        """Ways along a path that begins at joint positions `start`, (n,); at least one.

        Raises:
            PlanningError: there is none; says at which part of the path what stops the posture, and from
                which configuration the path could be done.
        """
        found: list[Route] = []
        reason: PlanningError | None = None
        try:
            found.append((self._piece(path, 0.0, 1.0, start),))
        except PlanningError as error:
            reason = error
        if self._robot.num_axes > 6:
            guided = self._guided(path, start)
            if guided is not None:
                found.append((RoutePiece(guided, 0.0, 1.0),))
        elif reason is not None and 'smallest_singular_value' in reason.details:
            found.extend(self._through_singularity(path, start, float(reason.details['fraction'])))
        if not found:
            assert reason is not None
            raise self._explained(reason, path, start)
        return found

    def _piece(self, path: CartesianPath, begin: float, end: float, start: Array) -> RoutePiece:
        """From `begin` to `end` of a path, backwards too; raises PlanningError, in parts of that."""
        return RoutePiece(self._kinematics.follow(_part(path, begin, end), start), begin, end)

    # More than six axes

    def _guided(self, path: CartesianPath, start: Array) -> JointPath | None:
        n = self._robot.num_axes
        count = int(np.clip(np.ceil((path.length + path.angle) / LAYER_LENGTH), *LAYERS))
        s = np.linspace(0.0, 1.0, count + 1)
        layers, chosen = np.empty((count + 1, MOST_POSTURES, n)), np.empty((count + 1, n))
        begin = np.ascontiguousarray(start, dtype=np.float64)
        reached, counts = follow_layers(self._chain, self._limits, path.arrays, s, begin, layers)
        if reached <= count or cheapest_postures(layers, counts, self._axes.velocity, chosen) <= count:
            return None
        size = MOST_KNOTS + 1
        knots = (np.empty(size), np.empty((size, n)), np.empty((size, n)), np.empty((size, n)))
        for rounds in RELAXATIONS:
            smooth = chosen.copy()
            relax(self._chain, self._limits, path.arrays, s, LIMIT_ROOM, rounds, smooth)
            spline = CubicSpline(s, smooth, axis=0, bc_type='natural')
            guide = (s, np.ascontiguousarray(spline.c))
            result, last = follow_guide(self._chain, self._limits, path.arrays, begin, guide, knots)
            if result == FOLLOWED:
                return JointPath(*(values[:last].copy() for values in knots))
        return None

    # Six axes in a singularity

    def _through_singularity(self, path: CartesianPath, start: Array, place: float) -> list[Route]:
        """Ways with a standstill at s = `place`, at which the posture changes."""
        if self._analytic is None:
            return []
        before: Route = ()
        if place > 0.0:
            try:
                before = (self._piece(path, 0.0, place, start),)
            except PlanningError:
                return []
            start = before[0].joints.q[-1]
        middle = place + BESIDE * (1.0 - place)
        postures = list(self._whole_turns_apart(path.pose(middle)))
        for near in NEAR:
            end = min(place + near / (path.length + path.angle), 0.5 * (place + middle))
            onward = self._onward(path, start, (place, end, middle), postures)
            if onward:
                return [(*before, *_turn(start, piece), piece) for piece in onward]
        return []

    def _onward(
        self, path: CartesianPath, start: Array, at: tuple[float, float, float], postures: list[Alike]
    ) -> list[RoutePiece]:
        """Pieces to the end of a path, to whose begin the axes turn while the tool stands still.

        Args:
            path: The path.
            start: From where they turn, (n,).
            at: Where that is, in s; where the pieces begin, just behind; and the place of `postures`.
            postures: From where they are followed back to their begin, and ahead to the end.
        """
        place, begin, middle = at
        back_to, ahead_to = path.part(middle, begin), path.part(middle, 1.0)
        pieces: list[RoutePiece] = []
        # Postures whole turns apart share their ways, which are followed once.
        for first, turns in postures:
            back = self._back_from(back_to, first, middle, begin)
            if back is None:
                continue
            still = np.empty(len(turns), dtype=np.bool_)
            ends = back.joints.q[-1] + turns
            stand_still(self._chain, self._limits, path.arrays, place, start, ends, still)
            ahead = self._kinematics.follow_far(ahead_to, first) if still.any() else None
            if ahead is None or ahead[1] < 1.0:
                continue
            onward = _joined(back, RoutePiece(ahead[0], middle, 1.0))
            for turn in turns[still]:
                piece = onward.turned(turn)
                if stays_inside(self._limits, piece.joints.knots):
                    pieces.append(piece)
        return pieces

    def _whole_turns_apart(self, pose: Pose) -> Iterator[Alike]:
        """Postures at a pose."""
        assert self._analytic is not None
        postures = np.array(self._analytic.solve_all(pose, turns=True))
        while len(postures):
            ways = postures - postures[0]
            turns = ways / (2.0 * np.pi)
            alike = np.abs(turns - np.round(turns)).max(axis=1) < SMALLEST_TURN
            yield postures[0], ways[alike]
            postures = postures[~alike]

    def _back_from(
        self, path: CartesianPath, posture: Array, middle: float, place: float
    ) -> RoutePiece | None:
        """From `middle` back to `place`, or into the singularity there as near as it goes.

        Args:
            path: That part of the path.
            posture: At its begin.
            middle: Its begin, in s of the whole path.
            place: Its end.
        """
        followed = self._kinematics.follow_far(path, posture)
        if followed is None:
            return None
        joints, share = followed
        reached = place if share == 1.0 else middle - share * (middle - place)
        return None if reached - place > LARGEST_GAP else RoutePiece(joints, middle, reached)

    # Why not

    def _explained(self, reason: PlanningError, path: CartesianPath, start: Array) -> PlanningError:
        """The reason, with the configurations from which the path can be done."""
        able = []
        for posture in self._other_starts(path.start):
            try:
                self._kinematics.follow(path, posture)
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


def _part(path: CartesianPath, begin: float, end: float) -> CartesianPath:
    return path if (begin, end) == (0.0, 1.0) else path.part(begin, end)


def _turn(begin: Array, onward: RoutePiece) -> Route:
    """The change of posture, straight in joint space, to where a piece begins; nothing if there is none."""
    end = onward.joints.q[0]
    turn = end - begin
    if float(np.abs(turn).max()) < SMALLEST_TURN:
        return ()
    way, still = np.stack([turn, turn]), np.zeros((2, len(turn)))
    joints = JointPath(np.array([0.0, 1.0]), np.stack([begin, end]), way, still)
    return (RoutePiece(joints, onward.begin, onward.begin),)


def _joined(back: RoutePiece, ahead: RoutePiece) -> RoutePiece:
    """One piece of two that begin at the same posture: the first backwards, then the second."""
    middle = (back.begin - back.end) / (ahead.end - back.end)
    rest = 1.0 - middle
    first, second = back.joints, ahead.joints
    s = np.concatenate([middle * (1.0 - first.s[::-1]), middle + rest * second.s[1:]])
    s[0], s[-1] = 0.0, 1.0
    joints = JointPath(
        s,
        np.concatenate([first.q[::-1], second.q[1:]]),
        np.concatenate([-first.q_s[::-1] / middle, second.q_s[1:] / rest]),
        np.concatenate([first.q_ss[::-1] / middle**2, second.q_ss[1:] / rest**2]),
    )
    return RoutePiece(joints, back.end, ahead.end)
