"""A controller before zones, for the tests of zones."""

from __future__ import annotations

from collections.abc import Callable
from types import MappingProxyType

import numpy as np

from robots_controller.control.control_loop import ControlLoop
from robots_controller.control.controller import Controller, ControllerState
from robots_controller.control.controller_rates import ControllerRates
from robots_controller.control.controller_settings import ControllerSettings
from robots_controller.control.speed.frame_speed_limit import FrameSpeedLimit
from robots_controller.control.speed.speed_control import SpeedControl
from robots_controller.control.stops.stop_latch import StopState
from robots_controller.control.streamed_reference import StreamPoint
from robots_controller.control.zones.zone_guard import ZoneGuard
from robots_core.blocks import HalfSpace, Zone
from robots_core.blocks.collision.scene import Scene
from robots_core.cell_interface.motion_result import MotionResult

from .small_arms import small_arm, start_of

PERIOD = 0.004
ROBOT, START = small_arm(3), start_of(3)
SWITCHED = MappingProxyType({'digital_input.1': False})


def turned(angle: float) -> np.ndarray:
    """The start, turned about the vertical by so many radians."""
    return START + np.array([angle, 0.0, 0.0])


def tool(q: np.ndarray) -> np.ndarray:
    return ROBOT.direct_kinematics(q)[0]


def wall(angle: float, *, always: bool = False) -> Zone:
    """Out of the half-space that the tool enters where the start is turned by an angle."""
    r = tool(turned(angle))
    normal = np.array([-r[1], r[0], 0.0])
    return Zone('press', HalfSpace(r, normal), 'out', 'tool', {} if always else SWITCHED)


class Cell:
    """A control loop whose drives are ideal; references are kept."""

    def __init__(
        self, *zones: Zone, limit: float = 0.0, closed: tuple[str, ...] | None = ('press',), name: str = ''
    ) -> None:
        self.zones = ZoneGuard(ROBOT, Scene(zones=zones), name=name) if zones else None
        axes, settings = ROBOT.axes_data, ControllerSettings(period=PERIOD)
        frame_limit = FrameSpeedLimit(ROBOT, limit)
        speed = SpeedControl(axes, settings, frame_limit=frame_limit, zones=self.zones)
        self.controller = Controller(axes, settings, speed=speed)
        self.loop = ControlLoop(self.controller, ControllerRates(1.0 / PERIOD, 0.5), self, progress_every=1)
        self.now, self.q = 0.0, START
        self.references: list[np.ndarray] = []
        self.results: list[MotionResult] = []
        self.stops: list[StopState] = []
        if closed is not None:
            self.loop.close_zones(closed)
        self.step()

    def step(self, times: int = 1) -> None:
        for _ in range(times):
            reference = self.loop.step(self.now, self.q)
            self.loop.report()
            assert reference is not None
            self.now += PERIOD
            self.q = reference[0]
            self.references.append(reference.copy())

    def run(self, until: Callable[[], bool] = lambda: False, longest: float = 20.0) -> None:
        end = self.now + longest
        self.step()
        resting = (ControllerState.HOLDING, ControllerState.STOPPED)
        while not until() and (self.loop.pending or self.controller.state not in resting):
            self.step()
            assert self.now < end

    def held(self) -> bool:
        """The robot stands before a border."""
        return bool(self.controller.obstacle) and not self.references[-1][1].any()

    def clearance(self, zone: Zone) -> float:
        region = zone.region
        assert isinstance(region, HalfSpace)
        return float(region.normal @ (region.point - tool(self.q)))

    def jog(self, velocity: np.ndarray, times: int) -> None:
        for _ in range(times):
            point = StreamPoint(self.q + PERIOD * velocity, velocity, np.zeros(3), self.now + PERIOD)
            self.loop.stream(point, 'jog')
            self.step()

    def result(self, result: MotionResult) -> None:
        self.results.append(result)

    def progress(self, progress: float) -> None:
        """See `ControlPort`."""

    def stream_refused(self, error: Exception, _now: float) -> None:
        raise error

    def stop_changed(self, state: StopState) -> None:
        self.stops.append(state)

    def run_enabled(self, *, enabled: bool) -> None:
        """See `ControlPort`."""
