"""ToolTrace: the path of the tool as a line in the browser page."""

from collections import deque

import numpy as np
import viser

from robots_core.validation import Array

SPACING = 0.002  # m between two points of the line
JUMP = 0.3  # m between two updates; larger ones start a new line
CHUNK = 100  # segments of a piece, which is sent again when one is added
CHUNKS = 60  # pieces kept; older ones are removed
LONGEST_TRACE = CHUNK * CHUNKS  # points
COLOUR = (0, 150, 136)
THICKNESS = 3.0  # pixels


class ToolTrace:
    """A line that grows with the tool's position.

    It is kept in short pieces, so that the data per new point does not grow with the line. Its name is its
    path in the page's scene tree.
    """

    def __init__(self, server: viser.ViserServer, name: str) -> None:
        self._server = server
        self._name = name
        self._pieces: deque[viser.LineSegmentsHandle] = deque()
        self._points: list[Array] = []
        self._count = 0
        self._visible = True

    def show(self, *, visible: bool) -> None:
        """Show the line or not; it grows in any case."""
        self._visible = visible
        for piece in self._pieces:
            piece.visible = visible

    def add(self, r: Array) -> None:
        """Lengthen the line to `r` (3,), m, if that is far enough from its end."""
        distance = float(np.linalg.norm(r - self._points[-1])) if self._points else np.inf
        if distance < SPACING:
            return
        if distance > JUMP:
            self._points = [r]
            return
        self._points.append(r)
        points = np.array(self._points, dtype=np.float32)
        segments = np.stack([points[:-1], points[1:]], axis=1)
        if len(self._points) == 2:
            self._start_piece(segments)
        else:
            self._pieces[-1].points = segments
            self._pieces[-1].colors = np.full_like(segments, COLOUR, dtype=np.uint8)
        if len(self._points) > CHUNK:
            self._points = [r]

    def _start_piece(self, segments: np.ndarray[tuple[int, ...], np.dtype[np.float32]]) -> None:
        self._count += 1
        piece = self._server.scene.add_line_segments(
            f'{self._name}/{self._count}',
            segments,
            COLOUR,
            thickness=THICKNESS,
            thickness_units='screen',
            visible=self._visible,
        )
        self._pieces.append(piece)
        if len(self._pieces) > CHUNKS:
            self._pieces.popleft().remove()

    def clear(self) -> None:
        """Remove the line."""
        for piece in self._pieces:
            piece.remove()
        self._pieces.clear()
        self._points = []
