"""What a fault did to the robot and its outputs, by a recording."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from limit_differences import broken_limits, limit_uses
from robots_core.periodic.watchdog import WATCHDOG
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array

from .recording import JointSamples, Recording

STOPPING: Final = ('drive_node', 'controller_node', 'planning_node', 'lua_program_node', 'collision_node')
"""Nodes whose loss stops a robot that moves; others only show, or are watched by the PLC."""
OFF_PATH: Final = ('drive_node', 'controller_node')
"""Nodes without which the robot cannot stop on its path."""
ON_PATH: Final = 2e-3  # m from the path, with any other node lost: a goal; drives lag behind around corners
REACTION: Final = 0.2  # s after the watchdog, in which the robot begins to brake: a goal
OUTPUTS_SAFE: Final = 0.3  # s after the fault: a goal
STANDING: Final = 1e-3  # of the velocity limits; drives come to rest asymptotically
JUST_BEFORE: Final = 0.05  # s before the fault, in which the robot counts as moving if it does
OBSERVED: Final = 3.0  # s after the fault
PERIOD: Final = 0.004  # s, of the references
MOVED: Final = 1e-3  # rad (m): what a standing robot moves at most, as drives settle
BEGUN: Final = 1.0  # s after the fault, in which a motion can begin and is stopped
SETTLED: Final = 0.5  # s after the robot stands, after which it has settled


@dataclass(frozen=True)
class FaultFigures:
    """What a fault did.

    Attributes:
        stops: The robot had to stop: it moved, and cannot continue without the node.
        stands: When it stood, s after the fault; infinite for never; NaN where it need not stop.
        braking: How much of that it braked, s.
        deviation: How far the flange left its path until then, m.
        on_path: It had to stay on its path.
        outputs_safe: When all outputs were safe, s after the fault; infinite for never, NaN where none
            need be, or nobody is left who could write them.
        problems: Limits that were broken, and motions that nobody commanded, a line each.
        usable: A person could let the robot move again by reset, open and run.
        usable_after: How long that took, s after the node was back.
    """

    stops: bool
    stands: float
    braking: float
    deviation: float
    on_path: bool
    outputs_safe: float
    problems: tuple[str, ...]
    usable: bool
    usable_after: float

    @property
    def late(self) -> float:
        """How much later it stood than the goal, s; negative if it was in time."""
        return self.stands - (WATCHDOG + REACTION + self.braking)


def judge(recording: Recording, robot: BaseRobotModel) -> FaultFigures:
    """The figures of a fault."""
    feedback = recording.feedback
    # A drive that is lost moves nothing: its motion is what the controller believes.
    witness = recording.references if recording.node == 'drive_node' else feedback
    speed = np.abs(witness.velocity) / robot.axes_data.velocity
    before = (witness.time > -JUST_BEFORE) & (witness.time <= 0.0)
    moved = bool(before.any()) and float(speed[before].max()) > STANDING
    stops = moved and recording.node in STOPPING
    stands = _stands(witness, speed) if stops else np.nan
    until = min(stands, OBSERVED) if stops else OBSERVED
    return FaultFigures(
        stops=stops,
        stands=stands,
        braking=_braking(recording, robot, stands) if stops else np.nan,
        deviation=_deviation(recording, witness.between(0.0, until), robot),
        on_path=recording.node not in OFF_PATH,
        outputs_safe=_outputs_safe(recording) if _outputs_count(recording, stops=stops) else np.nan,
        problems=(*_broken(recording, robot), *_unasked(recording, stands)),
        usable=recording.running or recording.moved < np.inf,
        usable_after=0.0 if recording.running else recording.moved - recording.resumed,
    )


def _stands(witness: JointSamples, speed: Array) -> float:
    """The last time within the observed time at which an axis moved; infinite if it still does."""
    observed = (witness.time > 0.0) & (witness.time <= OBSERVED)
    moving = witness.time[observed & (speed > STANDING).any(axis=1)]
    if not moving.size:
        return 0.0
    return float(moving[-1]) if moving[-1] < OBSERVED - JUST_BEFORE else np.inf


def _braking(recording: Recording, robot: BaseRobotModel, stands: float) -> float:
    """How long the robot braked: from the stop on, or as long as its limits take where none was reported."""
    if recording.latched < stands:
        return stands - recording.latched
    axes, feedback = robot.axes_data, recording.feedback.between(-JUST_BEFORE, 0.0)
    return float((np.abs(feedback.velocity) / axes.acceleration).max(initial=0.0))


def _deviation(recording: Recording, samples: JointSamples, robot: BaseRobotModel) -> float:
    """Largest distance of the flange from the planned path, m; NaN without a plan."""
    if len(recording.path) < 2 or not samples.time.size:
        return np.nan
    path = np.array([robot.direct_kinematics(q)[0] for q in recording.path])
    way = np.diff(path, axis=0)
    length = np.maximum(np.einsum('ij,ij->i', way, way), 1e-18)
    worst = 0.0
    for q in samples.position:
        away = robot.direct_kinematics(q)[0] - path[:-1]
        part = np.clip(np.einsum('ij,ij->i', away, way) / length, 0.0, 1.0)
        worst = max(worst, float(np.linalg.norm(away - part[:, None] * way, axis=1).min()))
    return worst


def _outputs_count(recording: Recording, *, stops: bool) -> bool:
    if recording.node == 'io_bridge_node' or not recording.words:
        return False
    return stops or recording.node == 'lua_program_node'


def _outputs_safe(recording: Recording) -> float:
    """When the PLC had safe outputs for good, until somebody commands the robot again."""
    until = min(recording.commanded, recording.resumed if recording.running else np.inf)
    unsafe, safe = -np.inf, np.inf
    for time, word in recording.words:
        if time >= until:
            break
        if word != recording.safe:
            unsafe, safe = time, np.inf
        else:
            safe = min(safe, time)
    if unsafe == -np.inf:
        return 0.0
    return max(0.0, safe)


def _broken(recording: Recording, robot: BaseRobotModel) -> list[str]:
    """Limits that the references do not keep while drives follow them: otherwise they follow the feedback."""
    references = recording.references
    if len(references.time) < 5:
        return []
    followed = np.ones(len(references.time), bool)
    for time, on in recording.drives:
        followed[references.sent > time] = on
    together = np.round(np.diff(references.time) / PERIOD) == 1.0
    steady = together & followed[1:] & followed[:-1]
    uses = limit_uses(robot.axes_data, references.position, PERIOD, steady=steady)
    return [f'references: {line}' for line in broken_limits(robot.axes_data, uses)]


def _unasked(recording: Recording, stands: float) -> list[str]:
    """Motions of a robot that stands, before a person commanded one."""
    if recording.node == 'drive_node' or recording.node not in STOPPING:  # its next process is another robot
        return []
    if np.isnan(stands):  # it stood before: what was planned meanwhile may begin until the loss is noticed
        stands = np.inf if recording.running else BEGUN
    rest = recording.feedback.between(stands + SETTLED, recording.commanded)
    if not rest.time.size:
        return []
    moved = float(np.ptp(rest.position, axis=0).max())
    return [f'it moved by {moved:.3g} rad (m) before anybody commanded it'] if moved > MOVED else []
