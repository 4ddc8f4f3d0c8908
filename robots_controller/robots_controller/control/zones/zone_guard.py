"""ZoneGuard: holds the robot before the borders of zones that are closed."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from math import ceil, sqrt
from typing import Final

import numpy as np

from robots_controller.control.followed_motion import Border, FollowedMotion
from robots_controller.control.zones.shared_zone import SharedZone, ZoneState
from robots_core.blocks.collision.along_paths.joint_path import JointPath
from robots_core.blocks.collision.scene import Scene
from robots_core.blocks.zones.zone_clearance import ZoneClearance
from robots_core.blocks.zones.zone_detection import ZoneDetection
from robots_core.blocks.zones.zone_passages import MARGIN
from robots_core.errors import InvalidInputError
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.timing.path_speed_cap import PathSpeedCap
from robots_planning.trajectory import Trajectory

CHECK_EVERY: Final = 5  # periods of a robot that moves
FURTHER: Final = 5e-3  # m across a border that the robot may still move while it comes back
# The path of a braking robot is checked in steps of this length, but in no more than so many.
BRAKING_STEP: Final = 5e-3  # m
MOST_STEPS: Final = 16
SLOWER: Final = 0.95  # of the speed at which the way would just be free
ROUNDING: Final = 1e-9  # m
NEAR: Final = 0.02  # s of path time before a border
# A zone is claimed before the robot would have to brake, and kept while it comes back soon.
CLAIM_AHEAD: Final = 2.0  # s of path time
KEEP_AHEAD: Final = 4.0  # s of path time
STREAM_NEAR: Final = 0.3  # m; a stream whose robot is so near keeps a zone


class ZoneGuard:
    """Holds motions and streams before closed borders, and finds a robot that is across one.

    A motion stops on its path; its path has been searched before (`borders`). A stream is slowed down such
    that the robot could always brake before the border. Zones that can be opened are closed at the start; a
    robot across the borders of those that inputs close violates them only from the first call of `close` on.

    Args:
        robot: The robot.
        scene: Its zones, and what is attached to the flange.
        name: Of this robot for those that share zones; '' without such, as in a simulation.
        life: Of this process, see `Claim`.

    Raises:
        InvalidInputError: see `ZoneDetection`; or a zone that the robot shares with itself.
    """

    def __init__(self, robot: BaseRobotModel, scene: Scene, *, name: str = '', life: int = 0) -> None:
        axes, self._robot = robot.axes_data, robot
        self._velocity, self._acceleration = axes.velocity, axes.acceleration
        # Two, as paths are searched in another thread than the loop's.
        self._paths, self._postures = ZoneDetection(robot, scene), ZoneDetection(robot, scene)
        self._always = frozenset(zone.name for zone in scene.zones if zone.always_closed)
        for zone in scene.zones:
            if name in zone.shared_with:
                raise InvalidInputError(f'zone {zone.name!r} of {name} is shared with {name} itself')
        self._shared = {
            zone.name: SharedZone(name, zone.shared_with, life)
            for zone in scene.zones
            if zone.shared_with and name
        }
        self._by_inputs = frozenset(zone.name for zone in scene.zones if zone.closed_by)
        self._known = self._always
        self._closed = self._closed_now()
        self._left: set[str] = set()  # shared zones of others; this robot was outside
        self._turn = 0
        self._tool = np.zeros(3)
        self._floors: dict[str, float] = {}
        self._last = np.empty(0)
        self._moved = 0
        self.held_by = ''
        """The zone whose border holds the robot now; '' for none."""

    def set_tool(self, position: Array) -> None:
        """Watch another tool centre point, by its position in tool0, (3,) m; from the thread of `borders`."""
        self._paths.set_tool(position)
        self._tool = position

    def set_scene(self, scene: Scene) -> None:
        """Watch what is attached to the flange in another scene with the same zones; as `set_tool`."""
        self._paths, self._postures = (ZoneDetection(self._robot, scene, self._tool) for _ in range(2))

    def borders(self, trajectory: Trajectory) -> tuple[Border, ...]:
        """Where a trajectory crosses borders, closed or not; takes milliseconds; from one thread."""
        path = JointPath(*trajectory.points)
        return tuple(
            Border(zone, passage.start, passage.end)
            for zone in self._paths.zones
            for passage in self._paths.passages(zone, path)
        )

    # -- the loop's thread ---------------------------------------------------------------------------

    def close(self, closed: Collection[str]) -> None:
        """Close the borders of these zones, and open those of all others that can be opened."""
        self._by_inputs = frozenset(closed)
        self._known = self._always | self._by_inputs
        self._closed = self._closed_now()
        self._floors = {
            name: floor for name, floor in self._floors.items() if name in self._known | self._left
        }
        self._last = np.empty(0)  # check at once

    def _closed_now(self) -> frozenset[str]:
        return (
            self._always
            | self._by_inputs
            | {name for name, shared in self._shared.items() if not shared.mine}
        )

    @property
    def states(self) -> dict[str, ZoneState]:
        """Of shared zones, for the other robots."""
        return {name: shared.state for name, shared in self._shared.items()}

    def receive(self, robot: str, states: Mapping[str, ZoneState]) -> None:
        """Take the states of another robot."""
        for name, state in states.items():
            if name in self._shared:
                self._shared[name].receive(robot, state)

    def share(self, places: Sequence[Array], motion: FollowedMotion | None, *, streaming: bool) -> None:
        """Claim the shared zones that come near, and release those that are done with.

        Args:
            places: Joint positions, (n,) each, of which none may be across the border of a zone that is left.
            motion: That is followed.
            streaming: A stream is followed.
        """
        self._turn = (self._turn + 1) % CHECK_EVERY
        if self._turn != 0:
            return
        for clearance in self._clearances(self._shared):
            name = clearance.zone.name
            shared = self._shared[name]
            least = min(clearance.closest(q, STREAM_NEAR)[0] for q in places)
            near = streaming and (self.held_by == name or (shared.mine and least < STREAM_NEAR))
            ahead = motion is not None and motion.crosses(name, KEEP_AHEAD if shared.mine else CLAIM_AHEAD)
            shared.step(needed=near or ahead, inside=least < MARGIN)
            if shared.mine:
                self._left.discard(name)
            elif least >= MARGIN:
                self._left.add(name)
        self._closed = self._closed_now()

    def check(self, q: Array) -> str:
        """Look for a violation at joint positions `q`, (n,); the reason for a person, '' without one."""
        if np.array_equal(q, self._last):
            self._moved = 0
            return ''
        at_once = self._last.size == 0
        self._last = q
        self._moved += 1
        if not at_once and self._moved % CHECK_EVERY != 0:
            return ''
        for clearance in self._clearances(self._known | self._left):
            zone = clearance.zone
            least, body = clearance.closest(q, 0.0)
            if least >= 0.0:
                self._floors.pop(zone.name, None)
            elif least < self._floors.get(zone.name, 0.0):
                self._floors[zone.name] = least - FURTHER
                return zone.describe(body, least)
        return ''

    @property
    def obstacle(self) -> str:
        """Before what the robot is held, for a person; '' for nothing."""
        if not self.held_by:
            return ''
        shared = self._shared.get(self.held_by)
        if shared is None or shared.mine:
            return f'the border of zone {self.held_by!r}, which is closed'
        return f'the border of zone {self.held_by!r}, which {" and ".join(shared.missing)} has not granted'

    def hold(self, motion: FollowedMotion) -> None:
        """Let a motion stop before the next border on its path that is closed now."""
        self.held_by = ''
        motion.held = self._held(motion)

    def _held(self, motion: FollowedMotion) -> PathSpeedCap | None:
        assert motion.cap is not None
        ahead = [
            border
            for border in motion.borders
            if border.zone.name in self._closed and border.end > motion.path_time
        ]
        border = min(ahead, key=lambda border: border.start, default=None)
        if border is not None and border.start <= motion.join_time:
            if motion.path_time >= border.start - NEAR:
                self.held_by = border.zone.name
            return motion.ending(border.start, 0.0)
        after = None if motion.successor is None else self._held(motion.successor)
        return None if after is None else motion.ending(motion.join_time, after.begin)

    def hold_before_borders(self, before: Array, wanted: Array, slower: Callable[[float], Array]) -> Array:
        """The next reference of a stream, (3, n), from which the robot can still brake before all borders.

        Args:
            before: The reference before, (3, n).
            wanted: What the stream requests, (3, n).
            slower: What it requests at this part of the velocity limits, 0..1.
        """
        self.held_by = ''
        # A robot that is across a border already may come back.
        levels = [
            (clearance, min(clearance.closest(before[0], MARGIN)[0], MARGIN) - ROUNDING)
            for clearance in self._clearances(self._closed)
        ]
        share = 1.0
        for clearance, level in levels:
            least = self._least_while_braking(clearance, wanted, level)
            if least < level:
                self.held_by = clearance.zone.name
                here, _ = clearance.closest(before[0])
                # The braking distance grows with the square of the speed.
                share = min(share, SLOWER * sqrt((here - level) / (here - least)))
        if not self.held_by:
            return wanted
        wanted = slower(share * float((np.abs(wanted[1]) / self._velocity).max()))
        if all(self._least_while_braking(clearance, wanted, level) >= level for clearance, level in levels):
            return wanted
        return slower(0.0)

    def _least_while_braking(self, clearance: ZoneClearance, reference: Array, level: float) -> float:
        """The smallest clearance of a robot that brakes from a reference, (3, n), m; exact below `level`."""
        q, q_dot = reference[0], reference[1]
        times = np.abs(q_dot) / self._acceleration
        clearance.place(q)
        way = clearance.travels(0.5 * np.abs(q_dot) * times)
        clearances = clearance.clearances(level + way)
        near = clearances - way < level
        if not near.any():
            return level
        count = min(max(ceil(float(way[near].max()) / BRAKING_STEP), 1), MOST_STEPS)
        least = float(clearances.min())
        for time in np.linspace(0.0, float(times.max()), count + 1)[1:].tolist():
            braked = np.minimum(time, times)
            place = q + braked * (q_dot - 0.5 * np.sign(q_dot) * self._acceleration * braked)
            least = min(least, clearance.closest(place, level)[0])
        return least

    def _clearances(self, names: Collection[str]) -> list[ZoneClearance]:
        self._postures.set_tool(self._tool)
        return [self._postures.clearance(zone) for zone in self._postures.zones if zone.name in names]
