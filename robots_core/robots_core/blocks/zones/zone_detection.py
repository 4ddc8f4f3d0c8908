"""ZoneDetection: where the tool and the bodies of a robot are in the zones of a scene."""

from collections.abc import Sequence

import numpy as np

from robots_core.blocks.collision.along_paths.joint_path import JointPath
from robots_core.blocks.collision.robot_solids import held_solids, robot_solids, tool_solid
from robots_core.blocks.collision.scene import Scene
from robots_core.blocks.zones.zone import Zone
from robots_core.blocks.zones.zone_clearance import ZoneClearance
from robots_core.blocks.zones.zone_error import ZoneError
from robots_core.blocks.zones.zone_passages import MARGIN, Passage, farthest_across, passages
from robots_core.errors import InvalidInputError
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array


class ZoneDetection:
    """Clearances and passages of a robot, for all zones of a scene.

    An instance keeps scratch memory: use one per thread.

    Args:
        robot: The robot.
        scene: Its zones, and what is attached to the flange.
        tool: Position of the tool centre point in tool0, (3,) m; its origin by default.

    Raises:
        InvalidInputError: a zone for the bodies of a robot that has none.
    """

    def __init__(self, robot: BaseRobotModel, scene: Scene, tool: Array | None = None) -> None:
        self._robot, self.scene = robot, scene
        self._tool = np.zeros(3) if tool is None else tool
        bodies = () if not scene.zones else (*robot_solids(robot), *held_solids(robot, scene))
        # Those fixed to the base stay where they are, whatever the robot does.
        self._bodies = [solid for solid in bodies if solid.frame > 0]
        self._clearances: dict[str, ZoneClearance] = {}
        for zone in scene.zones:
            if zone.what == 'bodies':
                if not self._bodies:
                    raise InvalidInputError(
                        f'zone {zone.name!r} is for the bodies of {robot.name}, which has none; valid is tool'
                    )
                self._clearances[zone.name] = ZoneClearance(robot, zone, self._bodies)
        self._place_tool()

    @property
    def zones(self) -> Sequence[Zone]:
        """All zones."""
        return self.scene.zones

    def set_tool(self, position: Array) -> None:
        """Watch another tool centre point, by its position in tool0, (3,) m."""
        if not np.array_equal(position, self._tool):
            self._tool = position
            self._place_tool()

    def _place_tool(self) -> None:
        for zone in self.zones:
            if zone.what == 'tool':
                solid = tool_solid(self._robot, self._tool)
                self._clearances[zone.name] = ZoneClearance(self._robot, zone, [solid])

    def clearance(self, zone: Zone) -> ZoneClearance:
        """Of one of the zones."""
        return self._clearances[zone.name]

    def passages(self, zone: Zone, path: JointPath) -> tuple[Passage, ...]:
        """Of a path across the border of a zone, in their order."""
        return passages(self.clearance(zone), path)

    def check(self, path: JointPath, since: float | None = None, until: float | None = None) -> None:
        """Check that a path crosses no border that is always closed.

        Args:
            path: The motion.
            since: Start time, s; the path's own by default.
            until: End time, s; the path's own by default.

        Raises:
            ZoneError: it does; names zone, body and place, and how far it gets.
        """
        for zone in self.zones:
            if zone.always_closed:
                for passage in passages(self.clearance(zone), path, since, until):
                    raise self._error(path, zone, passage)

    def _error(self, path: JointPath, zone: Zone, passage: Passage) -> ZoneError:
        clearance = self.clearance(zone)
        farthest = farthest_across(clearance, path, passage)
        least, body = clearance.closest(path.sample(farthest))
        x, y, z = self._tool_at(path.sample(passage.start)).tolist()
        percent = 100.0 * path.fraction(passage.start)
        text = zone.describe(body, least)
        if least >= 0.0:
            text += f'; the margin is {1e3 * MARGIN:g} mm'
        return ZoneError(
            f'the motion crosses the border of zone {zone.name!r} after {percent:.1f} % of the path '
            f'({passage.start:.3f} s), with the tool at ({x:.3f}, {y:.3f}, {z:.3f}) m; at {farthest:.3f} s '
            f'{text}',
            zone=zone.name,
            body=body,
            clearance=least,
            time=passage.start,
            percent=percent,
            x=x,
            y=y,
            z=z,
        )

    def _tool_at(self, q: Array) -> Array:
        r, T = self._robot.direct_kinematics(q)
        return np.asarray(r + T @ self._tool)
