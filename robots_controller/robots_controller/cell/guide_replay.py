"""GuideReplay: the times at which the messages of a recording guide the robot."""

import math
from collections import deque
from collections.abc import Iterator

from robots_controller.cell.guide_recording import GUIDES, GuideRecording, GuidingMessage
from robots_core.blocks.following.guide import Guide


class GuideReplay:
    """Plays a recording from when the program hands its robot over for the first time.

    Jog commands that come while the program does not let anybody jog are left out.

    Args:
        recording: What guides the robot.
    """

    def __init__(self, recording: GuideRecording) -> None:
        self.recording = recording
        self.types = recording.types
        self._messages = deque(recording.messages)
        self._guide = Guide.NONE
        self.start: int | None = None
        """When the robot was handed over for the first time, ns; None before."""

    @property
    def next_time(self) -> float:
        """When the next message comes, ns; infinite for never."""
        if self.start is None or not self._messages:
            return math.inf
        return self.start + self._messages[0].time

    def hand_over(self, guide: Guide, now: int) -> None:
        """The program hands the robot over, or takes it back.

        Args:
            guide: SENSOR or PERSON; NONE takes it back.
            now: ns.

        Raises:
            RobotsError: nothing of it is recorded.
        """
        if guide is not Guide.NONE:
            self.recording.check(guide)
            if self.start is None:
                self.start = now
        self._guide = guide

    def due(self, now: int) -> Iterator[GuidingMessage]:
        """The messages that have come until `now` (ns), with the times and stamps of this replay."""
        while self.next_time <= now:
            assert self.start is not None
            message = self._messages.popleft()
            if message.topic not in GUIDES[Guide.PERSON] or self._guide is Guide.PERSON:
                yield message.replayed(self.start)
