"""Results of collision checks."""

from dataclasses import dataclass

from robots_core.errors import PlanningError
from robots_core.pose import Pose
from robots_core.validation import Array
from robots_core.wording.rounding import apart

RESOLUTION = 1e-4  # m
"""A distance within this of the margin may count as below it; one below it never counts as free."""


@dataclass(frozen=True, eq=False)
class Proximity:
    """Two bodies and how close they are.

    Attributes:
        first: Shape `link/shape` of the robot, or name of an attached object.
        second: The same, or name of an obstacle.
        distance: m; 0 in contact.
        point_first: Point on the first that is nearest to the other, (3,) m, base frame; in contact, a
            point that both hold.
        point_second: Point on the other.
    """

    first: str
    second: str
    distance: float
    point_first: Array
    point_second: Array

    @property
    def in_contact(self) -> bool:
        """They touch or overlap."""
        return self.distance <= 0.0

    def describe(self, margin: float = 0.0) -> str:
        """One line of text; the distance is not rounded to the other side of the margin, m."""
        if self.in_contact:
            return f'{self.first} meets {self.second}'
        return f'{self.first} comes to {apart(1e3 * self.distance, 1e3 * margin, 1)} mm from {self.second}'


@dataclass(frozen=True, eq=False)
class PathProximity:
    """A place on a path, and the closest bodies there.

    Attributes:
        time: s on the path.
        fraction: Part of the path's time, 0..1.
        q: Joint positions, (n,) rad (m).
        tool0: Pose of tool0, base frame.
        proximity: The closest bodies there.
    """

    time: float
    fraction: float
    q: Array
    tool0: Pose
    proximity: Proximity

    def describe(self, margin: float = 0.0) -> str:
        """One line of text, see `Proximity.describe`."""
        x, y, z = (float(value) for value in self.tool0.r)
        return (
            f'{self.proximity.describe(margin)} after {100.0 * self.fraction:.1f} % of the path '
            f'({self.time:.3f} s), with tool0 at ({x:.3f}, {y:.3f}, {z:.3f}) m'
        )


class CollisionError(PlanningError):
    """A motion comes closer to something than the margin.

    Args:
        place: The first place on the path where it does.
        margin: m.
        advice: What to do about it, for a person; '' for nothing in particular.
    """

    code = 'R303'
    remedy = (
        'Lead the motion around the obstacle by a point between, or use `{avoid = true}` on joint '
        'motions; check scene and attached parts.'
    )

    def __init__(self, place: PathProximity, margin: float, advice: str = '') -> None:
        x, y, z = (float(value) for value in place.tool0.r)
        message = f'the motion collides: {place.describe(margin)}'
        if not place.proximity.in_contact:
            if place.proximity.distance >= margin:
                message += f' and may come {1e3 * RESOLUTION:g} mm closer'
            message += f'; the margin is {1e3 * margin:g} mm'
        super().__init__(
            f'{message}; {advice}' if advice else message,
            link=place.proximity.first,
            obstacle=place.proximity.second,
            distance=place.proximity.distance,
            margin=margin,
            time=place.time,
            percent=100.0 * place.fraction,
            x=x,
            y=y,
            z=z,
        )
        self.place = place
