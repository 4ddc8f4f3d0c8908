"""DriveRest: the loop of drive_node sleeps while its axes stand."""

import sys
from typing import Final

from robots_core.blocks.drives.supervised_drives import SupervisedDrives
from robots_core.periodic.resting_rate import RestingRate
from robots_core.periodic.watchdog import CHECKS
from robots_core.ros.streams.polled_subscription import Arrivals

# Periods. With references that come as often, feedback is sent when they come and not in between.
PATIENCE: Final = 2


class DriveRest:
    """See `Rest`: periods in which no message comes and none is sent are left out once the axes have settled.

    Args:
        supervised: The drives.
        resting: When their feedback is sent.
        arrivals: Of all that a step takes.
        period: Of the loop, s.
        watchdog: Of the references, s, which looks several times within that; 0 for none.
    """

    def __init__(
        self,
        supervised: SupervisedDrives,
        resting: RestingRate,
        arrivals: Arrivals,
        *,
        period: float,
        watchdog: float,
    ) -> None:
        self._supervised, self._resting, self.wait = supervised, resting, arrivals.wait
        self._most = max(0, int(watchdog / (CHECKS * period)) - 1) if watchdog else sys.maxsize

    def periods(self) -> int:
        """See `Rest`."""
        if not self._supervised.settled or not (ahead := self._resting.ahead):
            return 0
        return min(ahead + PATIENCE, self._most)

    def left_out(self, periods: int) -> None:
        """See `Rest`."""
        self._resting.pass_over(periods)
