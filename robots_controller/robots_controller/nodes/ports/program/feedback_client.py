"""FeedbackClient: what the robot measures, as a program reads it."""

import threading
import time
from collections.abc import Callable
from typing import Final

from sensor_msgs.msg import JointState

from robots_controller.program.clock import Clock
from robots_controller.program.joint_feedback import JointFeedback
from robots_core.cell_interface.topic_writers import SILENCE
from robots_core.errors import ProgramError
from robots_core.ros.messages import joint_motion
from robots_core.ros.streams.polled_subscription import PolledSubscription
from robots_core.ros.timed_node import TimedNode

# Drives report their position far more often; a program that asks at its start waits for the first one.
FEEDBACK_TIMEOUT: Final = 2.0  # s
FEEDBACK_PERIOD: Final = 0.005  # s


class FeedbackClient:
    """The newest of `joint_states`; for any thread."""

    def __init__(self, node: TimedNode, joint_names: tuple[str, ...]) -> None:
        self._joint_names = joint_names
        self._lasting = node.simulated_time  # a clock that stands still keeps what was measured
        self._feedback = PolledSubscription(node, JointState, 'joint_states')
        self._taking = threading.Lock()
        self._measured: JointFeedback | None = None
        self._waiting = threading.Condition()  # notified by the clock alone

    def newest(self) -> JointFeedback | None:
        """What the robot has measured last; None before the first feedback.

        Raises:
            RobotsError: the feedback lacks positions or joints.
        """
        with self._taking:
            message = self._feedback.take()
            if message is not None:
                self._measured = JointFeedback(*joint_motion(message, self._joint_names))
            return self._measured

    def present(self) -> JointFeedback | None:
        """What the robot measures now; None where no feedback has come for `SILENCE`.

        Older feedback is that of drives which have ended, or were held up: the robot may stand elsewhere.

        Raises:
            RobotsError: as `newest`.
        """
        newest = self.newest()
        age = 1e-9 * (time.time_ns() - self._feedback.received)
        return newest if self._lasting or age <= SILENCE else None

    def measured(self, clock: Clock, stopping: Callable[[], bool]) -> JointFeedback:
        """What the robot measures now; waits for feedback, until the program shall stop.

        Raises:
            RobotsError: none comes, or it lacks positions or joints.
        """
        end = clock.now() + FEEDBACK_TIMEOUT
        while True:
            if (measured := self.present()) is not None:
                return measured
            if clock.now() > end or stopping():
                raise ProgramError('no joint_states received: is drive_node running?')
            with self._waiting:
                clock.wait(self._waiting, clock.now() + FEEDBACK_PERIOD)
