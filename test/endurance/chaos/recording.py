"""Recording: what was seen of a robot around one fault."""

from dataclasses import dataclass

from robots_core.validation import Array


@dataclass(frozen=True, eq=False)
class JointSamples:
    """References or feedback.

    Attributes:
        time: (m,) s from the fault, by their stamps: when they were due.
        sent: (m,) s from the fault, when they were sent.
        position: (m, n) rad (m).
        velocity: (m, n) rad/s (m/s).
    """

    time: Array
    sent: Array
    position: Array
    velocity: Array

    def between(self, begin: float, end: float) -> 'JointSamples':
        """Those of some time."""
        inside = (self.time >= begin) & (self.time <= end)
        return JointSamples(
            *(values[inside] for values in (self.time, self.sent, self.position, self.velocity))
        )


@dataclass(frozen=True, eq=False)
class Recording:
    """What was seen around a fault, which is at time 0; all times in s.

    Attributes:
        node: The node that was killed or frozen.
        killed: Killed, and not frozen.
        references: What the controller sent.
        feedback: What the drives sent.
        path: Joint positions of the plans, (k, n), none farther from the next than a few mm of the tool.
        latched: When a fault stopped the robot by itself, with its reason; infinite for never.
        reason: The reason.
        drives: Times and values of `drives_on`, that before the fault too.
        words: Times and values of what the PLC got of the outputs, those before the fault too.
        safe: Value of the word that is safe.
        resumed: When the node lived on or was started again; infinite for never.
        commanded: When a person commanded the robot again; infinite if that was not necessary.
        moved: When it moved again by that; infinite for never.
        running: The program continues, as if nothing had happened.
    """

    node: str
    killed: bool
    references: JointSamples
    feedback: JointSamples
    path: Array
    latched: float
    reason: str
    drives: tuple[tuple[float, bool], ...]
    words: tuple[tuple[float, int], ...]
    safe: int
    resumed: float
    commanded: float
    moved: float
    running: bool
