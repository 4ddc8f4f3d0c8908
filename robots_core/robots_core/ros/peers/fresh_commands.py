"""FreshCommands: what was commanded before a node was held up leads to no motion."""

import time

from robots_core.errors import NotNowError
from robots_core.periodic.realtime import processor_share_in_silence
from robots_core.ros.peers.presence import Sender
from robots_core.ros.timed_node import TimedNode


class FreshCommands:
    """A process that was frozen for longer than the watchdog has been missed by all others.

    They have stopped the robot, and programs have failed. What they had commanded still waits for the
    process, and its own threads continue with what they were about to command: no motion may come of that
    when it runs again.

    Args:
        node: That gets or gives commands.
        watchdog: Silence after which the others miss it, s; 0: they do not.
    """

    def __init__(self, node: TimedNode, watchdog: float) -> None:
        self._node, self._watchdog = node, watchdog
        self._resumed = 0  # ns on the clock of the system: until then it was held up last

    def held_up(self, silence: float) -> bool:
        """The process runs again after a silence (s), in which the others have missed it; from any thread."""
        missed = self.missed(silence)
        if missed:
            self._resumed = time.time_ns()
        return missed

    def missed(self, silence: float | None = None) -> bool:
        """The process runs again after the others have missed it, by default with no sign of life since."""
        silence = self._node.silence() if silence is None else silence
        # Looked at for every command: the share is read only after a silence.
        return silence > self._watchdog > 0.0 and silence * processor_share_in_silence() > self._watchdog

    def check(self, sender: Sender) -> None:
        """Pass a command that was sent since.

        Raises:
            NotNowError: it was sent before.
        """
        if self.missed() or 0 < sender.time < self._resumed:
            raise NotNowError(
                f'{self._node.get_name()} was held up after this was commanded; command it again'
            )
