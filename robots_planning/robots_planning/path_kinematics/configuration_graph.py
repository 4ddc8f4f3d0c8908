"""ConfigurationGraph: the configurations that a robot takes along a path of the tool."""

from contextlib import suppress
from importlib import import_module

import numpy as np

from robots_core.blocks.inverse_kinematics.analytical import AnalyticalInverseKinematic
from robots_core.blocks.inverse_kinematics.damped_least_squares import DampedLeastSquares
from robots_core.errors import NoAnalyticInverseKinematicsError, PlanningError
from robots_core.pose import Pose
from robots_core.validation import Array
from robots_planning.path_kinematics.path_inverse_kinematics import PathInverseKinematics
from robots_planning.path_kinematics.route import Route, RoutePiece
from robots_planning.path_kinematics.self_motion_kernel import (
    MAX_CONFIGURATIONS,
    fastest_sequence,
    follow_layers,
    relax,
)
from robots_planning.path_kinematics.singularity_passage import SingularityPassage
from robots_planning.paths.cartesian_path import CartesianPath
from robots_planning.paths.joint_path import JointPath

LAYER_LENGTH = 0.03  # m and rad between the poses at which self-motion is sampled
LAYERS = (12, 120)  # fewest and most
RELAXATIONS = (60, 15, 0)  # tried in turn: smoothing may move configurations closer to the limits
PULL = 12.0  # towards the guide, per path
OTHER_STARTS = 16  # random start configurations, for robots without a closed form


class ConfigurationGraph:
    """Finds continuous joint paths from given joint positions along a path of the tool, inside all limits.

    With six axes the only choice is in singularities, see `SingularityPassage`. With more axes,
    configurations are sampled by self-motion at poses along the path; dynamic programming over path and
    configuration finds the sequence that takes least time at full speed; it is smoothed by self-motion and
    followed. The path of the pseudo-inverse (smallest joint velocities) is a further candidate.

    Args:
        kinematics: Inverse kinematics along paths.
    """

    def __init__(self, kinematics: PathInverseKinematics) -> None:
        self._kinematics, self._axes = kinematics, kinematics.robot.axes_data
        self._analytic: AnalyticalInverseKinematic | None = None
        self._passage: SingularityPassage | None = None
        with suppress(NoAnalyticInverseKinematicsError):
            self._analytic = AnalyticalInverseKinematic(kinematics.robot, tool=kinematics.tool)
            self._passage = SingularityPassage(kinematics, self._analytic)

    def routes(self, path: CartesianPath, start: Array) -> list[Route]:
        """Candidate routes along a path that starts at joint positions `start`, (n,); at least one.

        Raises:
            PlanningError: there is none; names the fraction of the path, the cause, and a configuration from
                which the path is possible.
        """
        found: list[Route] = []
        part, blocked = self._kinematics.follow_far(path, start, inside_limits=True)
        if part is not None and part.end == 1.0:
            found.append((part,))
        if self._axes.num_axes > 6:
            guided = self._guided(path, start)
            if guided is not None:
                found.append((RoutePiece(guided, 0.0, 1.0),))
        elif blocked and self._passage is not None:
            found.extend(self._passage.routes(path, start, part))
        if not found:
            raise self._explained(path, start)
        return found

    # More than six axes

    def _guided(self, path: CartesianPath, start: Array) -> JointPath | None:
        n = self._axes.num_axes
        count = int(np.clip(np.ceil((path.length + path.angle) / LAYER_LENGTH), *LAYERS))
        s = np.linspace(0.0, 1.0, count + 1)
        layers, chosen = np.empty((count + 1, MAX_CONFIGURATIONS, n)), np.empty((count + 1, n))
        begin = np.array(start, dtype=np.float64)  # read-only arrays would be compiled for once more
        chain, limits = self._kinematics.chain.arrays, self._kinematics.limits
        reached, counts = follow_layers(chain, limits, path.arrays, s, begin, layers)
        if reached <= count or fastest_sequence(layers, counts, self._axes.velocity, chosen) <= count:
            return None
        interpolate = import_module('scipy.interpolate')  # imported on demand: few paths come here
        for rounds in RELAXATIONS:
            smooth = chosen.copy()
            relax(chain, limits, path.arrays, s, rounds, smooth)
            spline = interpolate.CubicSpline(s, smooth, axis=0, bc_type='natural')
            followed = self._kinematics.follow_guided(path, start, s, np.ascontiguousarray(spline.c), PULL)
            if followed is not None:
                return followed
        return None

    # Explanation of a failure

    def _explained(self, path: CartesianPath, start: Array) -> PlanningError:
        """The error that says why the path cannot be followed, and from which configuration it can."""
        try:
            self._kinematics.follow(path, start)
        except PlanningError as error:
            reason = error
        able = []
        for q in self._other_starts(path.start):
            try:
                self._kinematics.follow(path, q)
            except PlanningError:
                continue
            able.append(q)
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
        low, high = axes.one_turn
        search = DampedLeastSquares(self._kinematics.robot, tool=self._kinematics.tool, restarts=0)
        results = [search.solve(pose, rng.uniform(low, high)) for _ in range(OTHER_STARTS)]
        return [result.q for result in results if result.converged]
