"""Cost: what a simulation costs of the machine's time, by part."""

from time import perf_counter, process_time
from typing import Literal

Part = Literal['program', 'planning', 'controller', 'drives', 'recording', 'other']


class Cost:
    """Books the time to one part after the other."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        """s of the wall's time by part; 'other' is all that belongs to none."""
        self.processor = 0.0
        """s of one core, of all parts together, until `end`."""
        self._part: Part = 'other'
        self._since = perf_counter()
        self._processor_since = process_time()

    def begin(self) -> None:
        """Forget what was before."""
        self.seconds.clear()
        self._since, self._processor_since = perf_counter(), process_time()

    def switch(self, part: Part) -> Part:
        """From now on the time belongs to a part; returns the one before."""
        before, now = self._part, perf_counter()
        self.seconds[before] = self.seconds.get(before, 0.0) + now - self._since
        self._part, self._since = part, now
        return before

    def end(self) -> None:
        """Nothing follows."""
        self.switch('other')
        self.processor = process_time() - self._processor_since
