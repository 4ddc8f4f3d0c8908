"""DecidingLimit: which axis and which limit make a motion last as long as it does."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from robots_controller.report.run_signals import LIMITS
from robots_core.validation import Array

# Planners keep a part in a thousand from limits, and references are samples of what they planned.
AT_LIMIT: Final = 0.98
# A plateau of speed is flat to rounding; its samples need not be within a hundredth by chance.
FLAT: Final = 0.99
HIGHEST: Final = 95.0  # percentile of what counts as the highest
PLATEAU: Final = 0.1  # of a motion's time: shorter is the turning point of a curve


@dataclass(frozen=True)
class DecidingLimit:
    """What decides a motion.

    Attributes:
        quantity: 'velocity', 'acceleration' or 'torque' of an axis; 'tool speed' or 'tool acceleration'
            where these are what was asked for.
        joint: The axis; '' for the tool.
        use: Highest value over limit in the motion; for the tool the value itself, m/s or m/s^2.
        share: Part of the motion's time that it is there, 0..1.
    """

    quantity: str
    joint: str
    use: float
    share: float

    def describe(self) -> str:
        """A few words for a person."""
        if not self.joint:
            unit = 'm/s' if self.quantity == 'tool speed' else 'm/s²'
            return f'{self.quantity} {self.use:.3g} {unit}'
        return f'{self.quantity} of {self.joint} at {100.0 * self.use:.0f} %'


def deciding_limit(
    time: Array, use: dict[str, Array], names: tuple[str, ...], tool_speed: Array, *, cartesian: bool
) -> DecidingLimit:
    """The limit that decides a motion: of those that are reached, the one that is held longest.

    An axis reaches a limit at its full value. The speed or acceleration of a tool that follows a path is
    reached where it stays at its highest value: it is as fast as it was set to be. If nothing is reached,
    the program requests less than full speed of the axes, and the highest use decides.

    Args:
        time: (k,) s.
        use: Value over limit by name of `LIMITS`, (k, n) each, over the motion.
        names: The axes.
        tool_speed: (k,) m/s.
        cartesian: The tool follows a path.
    """
    found = []
    for quantity in LIMITS:
        peak = use[quantity].max(axis=0)
        for axis, name in enumerate(names):
            share = float(np.mean(use[quantity][:, axis] >= AT_LIMIT * peak[axis])) if peak[axis] else 0.0
            found.append(DecidingLimit(quantity, name, float(peak[axis]), share))
    reached = [limit for limit in found if limit.use >= AT_LIMIT]
    if cartesian and tool_speed.size > 1:
        acceleration = np.abs(np.gradient(tool_speed, time))
        tool = [_plateau('tool speed', tool_speed), _plateau('tool acceleration', acceleration)]
        reached += [limit for limit in tool if limit.share >= PLATEAU]
    return max(reached, key=lambda limit: limit.share) if reached else max(found, key=lambda limit: limit.use)


def _plateau(quantity: str, values: Array) -> DecidingLimit:
    # Of an acceleration that is a difference of samples, those at corners mean nothing.
    highest = float(np.percentile(values, HIGHEST))
    share = float(np.mean(np.abs(values - highest) <= (1.0 - FLAT) * highest)) if highest else 0.0
    return DecidingLimit(quantity, '', highest, share)
