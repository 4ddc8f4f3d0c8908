"""SimulatedSwitches: outputs that are switched on the path, by the simulated progress."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from robots_controller.program.motion_command import MotionCommand, OutputChange, PathSwitch
from robots_controller.program.path_switches import PathSwitches, switches_on_path
from robots_core.pose import Pose
from robots_core.validation import Array
from robots_planning.trajectory import Trajectory


class SimulatedSwitches:
    """Knows the motions that are on their way and what they switch.

    Args:
        direct_kinematics: Pose of tool0 for joint positions.
        switch: Switches an output.
    """

    def __init__(
        self, direct_kinematics: Callable[[Array], Pose], switch: Callable[[OutputChange], None]
    ) -> None:
        self._direct_kinematics, self._switch = direct_kinematics, switch
        self._paths: dict[str, tuple[PathSwitches, dict[PathSwitch, int]]] = {}

    def planned(self, chain: Sequence[MotionCommand], id_: str, trajectory: Trajectory) -> None:
        """A chain of motions was planned; its id is that of the last one."""
        if any(command.switches for command in chain):
            lines = {switch: command.line for command in chain for switch in command.switches}
            switches = switches_on_path(chain, trajectory, self._direct_kinematics)
            self._paths[id_] = (switches, lines)

    def reach(self, id_: str, progress: float) -> None:
        """The motion has come so far, 0..1."""
        if self._paths and id_ in self._paths and progress < 1.0:
            self._switch_due(id_, progress)

    def finish(self, id_: str, *, ok: bool) -> None:
        """A motion has ended: what it has not switched on a way that led to its end is switched now."""
        if id_ in self._paths:
            if ok:
                self._switch_due(id_, 1.0)
            del self._paths[id_]
        if not ok:
            self._paths.clear()

    def _switch_due(self, id_: str, progress: float) -> None:
        switches, lines = self._paths[id_]
        for one in switches.due(progress):
            self._switch(OutputChange(one.kind, one.index, one.value, lines[one]))
