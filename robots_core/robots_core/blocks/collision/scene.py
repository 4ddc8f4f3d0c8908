"""Scene: obstacles around a robot, objects attached to its flange, and zones."""

from dataclasses import dataclass

from robots_core.blocks.zones.zone import Zone
from robots_core.errors import InvalidInputError
from robots_core.pose import Pose
from robots_core.robot_model.allowed_pairs import Pair, ordered_pair
from robots_core.robot_model.shapes import Colour, Geometry

OBJECT_COLOUR: Colour = (0.55, 0.6, 0.66, 1.0)


@dataclass(frozen=True, eq=False)
class PlacedObject:
    """A named solid.

    Attributes:
        name: Unique within the scene.
        geometry: Its geometry, in a frame of its own.
        pose: Pose of that frame.
        colour: Red, green, blue, opacity, each 0..1.
    """

    name: str
    geometry: Geometry
    pose: Pose
    colour: Colour = OBJECT_COLOUR


class SceneObject(PlacedObject):
    """An obstacle that stands still; its pose is that in the robot's base frame."""


class AttachedObject(PlacedObject):
    """A tool or workpiece on the flange; its pose is that in tool0. It may touch the last body."""


@dataclass(frozen=True, eq=False)
class Scene:
    """Obstacles, attached objects, and the pairs that may touch.

    Attributes:
        objects: Obstacles.
        attached: Tool and workpiece.
        may_touch: Pairs of names that are not checked: an object and another, or an object and a link.
        zones: Regions that the robot may not leave or enter; they are no obstacles.

    Raises:
        InvalidInputError: a name that is empty or used twice.
    """

    objects: tuple[SceneObject, ...] = ()
    attached: tuple[AttachedObject, ...] = ()
    may_touch: frozenset[Pair] = frozenset()
    zones: tuple[Zone, ...] = ()

    def __post_init__(self) -> None:
        names = [item.name for item in (*self.objects, *self.attached)] + [zone.name for zone in self.zones]
        for name in names:
            if not name:
                raise InvalidInputError('an object or zone of the scene has no name')
            if names.count(name) > 1:
                raise InvalidInputError(
                    f'the scene has two objects or zones with the name {name!r}; names are unique'
                )
        pairs = frozenset(ordered_pair(*pair) for pair in self.may_touch)
        object.__setattr__(self, 'may_touch', pairs)

    def allows(self, first: str, second: str) -> bool:
        """Whether two may touch; each is an object, or a shape `link/shape` of the robot."""
        return any(
            ordered_pair(a, b) in self.may_touch
            for a in {first, first.partition('/')[0]}
            for b in {second, second.partition('/')[0]}
        )
