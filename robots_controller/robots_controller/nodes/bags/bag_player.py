"""BagPlayer: publishes a bag onto real topics, with its timing."""

from typing import Any, Final

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, QoSProfile

from robots_controller.recording.bag_replay import ReplayPlan
from robots_core.ros.lockstep.phases import NANOSECONDS, Phase
from robots_core.ros.messages import message_class
from robots_core.ros.timed_node import TimedNode

POLL: Final = 0.01  # s of the wall clock between searches for subscribers
DEPTH: Final = 1000  # messages that a slow subscriber may lag behind
LAST_ACKNOWLEDGEMENT: Final = Duration(seconds=2.0)


class BagPlayer(TimedNode):
    """Publishes the messages of a plan; latched topics stay latched, all are reliable.

    It begins when all topics have subscribers, and shuts its context down when all is published. In lock-step
    it begins with the run and takes part until that ends.

    Args:
        plan: What to publish when.
        wait: Longest wait for subscribers, s of the wall clock.

    Raises:
        RobotsError: a message type that is not installed.
    """

    phase = Phase.ENVIRONMENT

    def __init__(self, plan: ReplayPlan, *, wait: float, **options: Any) -> None:
        super().__init__('bag_player', **options)
        self._plan = plan
        self.published = 0
        """Messages of the timeline."""
        self._player_publishers: dict[str, Any] = {}
        for name, topic in plan.topics.items():
            durability = DurabilityPolicy.TRANSIENT_LOCAL if topic.latched else DurabilityPolicy.VOLATILE
            # One latched message is the state; more of them would be played again to late subscribers.
            qos = QoSProfile(depth=1 if topic.latched else DEPTH, durability=durability)
            self._player_publishers[name] = self.create_publisher(message_class(topic.type), name, qos)
        for name, data in plan.state:
            self._player_publishers[name].publish(data)
        self._timeline = [(round(NANOSECONDS * due), name, data) for due, name, data in plan.timeline]
        self._start = 0  # ns
        self._timer = self.create_timer(1.0, self._play, autostart=False)
        if self.participant is not None:
            self._begin()
            return
        self._steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._latest = self._steady.now() + Duration(seconds=wait)
        self._search_timer = self.create_timer(POLL, self._find_subscribers, clock=self._steady)

    @property
    def complete(self) -> bool:
        """Everything was published."""
        return self.published == len(self._timeline)

    def _find_subscribers(self) -> None:
        missing = [n for n, one in self._player_publishers.items() if one.get_subscription_count() == 0]
        if missing and self._steady.now() < self._latest:
            return
        if self.simulated_time and self.now() == 0.0:  # `/clock` has not been published yet
            return
        if missing:
            print(f'no subscribers to {", ".join(missing)}')
        self.destroy_timer(self._search_timer)
        self._begin()

    def _begin(self) -> None:
        self._start = self._nanoseconds()
        print(f'{len(self._timeline)} messages in {self._plan.duration:.1f} s', flush=True)
        self._play()

    def _nanoseconds(self) -> int:
        return round(NANOSECONDS * self.now())

    def _play(self) -> None:
        elapsed = self._nanoseconds() - self._start
        while not self.complete and self._timeline[self.published][0] <= elapsed:
            _, name, data = self._timeline[self.published]
            self._player_publishers[name].publish(data)
            self.published += 1
        if self.complete:
            self._timer.cancel()
            self._end()
        else:
            self._timer.timer_period_ns = self._timeline[self.published][0] - elapsed
            self._timer.reset()

    def _end(self) -> None:
        if self.participant is not None:
            return
        for publisher in self._player_publishers.values():
            publisher.wait_for_all_acked(LAST_ACKNOWLEDGEMENT)
        self.context.try_shutdown()
