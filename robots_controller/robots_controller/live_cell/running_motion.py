"""RunningMotion: whether a motion runs, from events that may come out of order."""

from collections import deque

from robots_controller.live_cell.cell_events import MotionPlanned
from robots_core.cell_interface.motion_result import MotionResult

LATE = 100  # motions whose results may overtake their plans


class RunningMotion:
    """Follows plans and results. A result that overtakes its plan ends the motion too."""

    def __init__(self) -> None:
        self._id: str | None = None
        self._ended: deque[str] = deque(maxlen=LATE)
        # Results of streams have the id of their first point, and may overtake their last ones.
        self._streaming, self._stream_end = False, 0.0

    @property
    def runs(self) -> bool:
        """A motion was planned, and has not ended."""
        return self._id is not None

    def note(self, event: MotionPlanned | MotionResult) -> None:
        """Take the next event."""
        if isinstance(event, MotionPlanned):
            late = float(event.id) <= self._stream_end if event.streamed else event.id in self._ended
            if not late:
                self._id, self._streaming = event.id, event.streamed
        elif not event.blocked:  # otherwise the planner leads the robot around the obstacle
            self._ended.append(event.id)
            if event.id == self._id or self._streaming:
                self._id, self._stream_end = None, float(event.details.get('ended', 0.0))
