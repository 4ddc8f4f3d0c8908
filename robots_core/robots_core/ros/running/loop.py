"""Loops of a node: what is called in each period."""

from robots_core.periodic.periodic_thread import PeriodicThread
from robots_core.ros.lockstep.timed_work import ScheduledLoop

Loop = PeriodicThread | ScheduledLoop
"""Called periodically until it is stopped: on the wall clock, or in simulated time."""
