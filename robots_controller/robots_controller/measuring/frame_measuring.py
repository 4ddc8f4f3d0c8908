"""FrameMeasuring: tools, bases and payloads, measured step by step and saved by name."""

from __future__ import annotations

from pathlib import Path
from typing import Final, Literal

from robots_controller.program.files.cell_frames import (
    CellFrames,
    Tool,
    check_frame,
    frames_text,
    read_frames,
)
from robots_controller.program.files.file_history import FileHistory
from robots_core.blocks.calibration.payload_identification import IdentifiedPayload
from robots_core.blocks.calibration.three_points import Axis, measure_base, measure_tool_orientation
from robots_core.blocks.calibration.tool_center import FEWEST_POSES, ToolCenter, measure_tool_center
from robots_core.errors import MeasurementError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array

Sequence = Literal['tool', 'orientation', 'base']
NEEDED: Final[dict[Sequence, int]] = {'tool': FEWEST_POSES, 'orientation': 2, 'base': 3}
"""Points of each sequence; of a tool, at least."""


class FrameMeasuring:
    """Touched points, what follows from them, and the file that it is saved in."""

    def __init__(self, robot: BaseRobotModel) -> None:
        self._robot = robot
        self.points: Final[dict[Sequence, list[Pose]]] = {name: [] for name in NEEDED}
        """Poses of tool0 in the base frame, in their order."""
        self.history: Final = FileHistory()
        """What can be undone."""

    def complete(self, sequence: Sequence) -> bool:
        """All points are touched; a tool may have more."""
        return len(self.points[sequence]) >= NEEDED[sequence]

    def touch(self, sequence: Sequence, q: Array) -> None:
        """Take the place where the robot stands, joint positions (n,), rad (m), as the next point.

        Raises:
            MeasurementError: there are all points already.
        """
        if sequence != 'tool' and self.complete(sequence):
            raise MeasurementError(
                f'all {NEEDED[sequence]} points are touched; remove one to touch it again',
                key='all_touched',
                count=NEEDED[sequence],
            )
        self.points[sequence].append(self._robot.pose(q))

    def remove(self, sequence: Sequence, index: int) -> None:
        """Forget a point, counted from 0, to touch it again; but for a tool, those after it too."""
        del self.points[sequence][index if sequence == 'tool' else slice(index, None)]

    def clear(self, *sequences: Sequence) -> None:
        """Forget all points of sequences."""
        for sequence in sequences:
            self.points[sequence].clear()

    # -- what follows -------------------------------------------------------------------------------------

    def tool_center(self) -> ToolCenter:
        """The tool centre point.

        Raises:
            MeasurementError: see `measure_tool_center`.
        """
        return measure_tool_center(self.points['tool'])

    def residuals(self) -> tuple[float, ...]:
        """Distances of the tip from the fixed by point, m, however large; () where they do not follow."""
        try:
            return tuple(measure_tool_center(self.points['tool'], largest_residual=1e3).residuals.tolist())
        except MeasurementError:
            return ()

    def tool(self, axis: Axis) -> Pose:
        """The tool, with its orientation if the points for that are touched.

        Raises:
            MeasurementError: see `measure_tool_center` and `measure_tool_orientation`.
        """
        center, points = self.tool_center(), self.points['orientation']
        if not points:
            return Pose(center.r, Pose.identity().T)
        if not self.complete('orientation'):
            raise MeasurementError(
                'the second point of the orientation is missing; touch it, or start again',
                key='half_orientation',
            )
        return measure_tool_orientation(center.r, center.touched, *points, axis=axis)

    def base(self, tool: Pose) -> Pose:
        """The base, touched with a tool.

        Raises:
            MeasurementError: see `measure_base`, or points are missing.
        """
        points = self.points['base']
        if not self.complete('base'):
            raise MeasurementError(
                f'{len(points)} of {NEEDED["base"]} points are touched',
                key='some_touched',
                count=len(points),
                needed=NEEDED['base'],
            )
        return measure_base(*((point @ tool).r for point in points))

    # -- the file -----------------------------------------------------------------------------------------

    def save_tool(self, file: Path, name: str, axis: Axis) -> None:
        """Save the tool; a payload that the file has for it stays.

        Raises:
            MeasurementError: as `tool`.
            RobotsError: the file is not valid, or cannot be written; it stays as it was.
        """
        tool, frames = self.tool(axis), read_frames(file)
        before = frames.tools.get(name.strip())
        self._save(file, frames.with_tool(name, Tool(tool, before.payload if before else ())))
        self.clear('tool', 'orientation')

    def save_base(self, file: Path, name: str, tool: str) -> None:
        """Save the base that was touched with a tool of the file; '' for the flange.

        Raises:
            MeasurementError: as `base`.
            RobotsError: no such tool, or the file is not valid, or cannot be written; it stays as it was.
        """
        self._save(file, read_frames(file).with_base(name, self.base(self.tool_of(file, tool))))
        self.clear('base')

    def save_payload(self, file: Path, name: str, found: IdentifiedPayload) -> None:
        """Save the payload with a tool; one that is new has its tool centre point at the flange.

        Raises:
            RobotsError: the file is not valid, or cannot be written; it stays as it was.
        """
        frames = read_frames(file)
        before = frames.tools.get(name.strip())
        pose = before.pose if before else Pose.identity()
        numbers = (found.payload.mass, *found.payload.center.tolist())
        self._save(file, frames.with_tool(name, Tool(pose, numbers)))

    @staticmethod
    def tool_of(file: Path, name: str) -> Pose:
        """A tool of a file; '' for the flange.

        Raises:
            RobotsError: there is none of that name.
        """
        return check_frame(file, 'tool', name).tools[name].pose if name else Pose.identity()

    def _save(self, file: Path, frames: CellFrames) -> None:
        self.history.change({file: frames_text(frames)})
