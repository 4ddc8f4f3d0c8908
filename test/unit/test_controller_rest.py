"""ControllerRest: a loop that sleeps leaves out no cycle in which something is due."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from robots_controller.nodes.controller.controller_rest import ControllerRest
from robots_core.periodic.resting_rate import RestingRate

from .control_rig import PERIOD, ControlRig

BETWEEN_LOOKS = 0.0399  # s


@pytest.mark.parametrize('health_every', [7, 25])
@pytest.mark.parametrize('first', range(0, 25, 6))
def test_health_and_signs_of_life_are_looked_at_in_time(health_every: int, first: int) -> None:
    rig = ControlRig()
    rig.run(first)
    resting = RestingRate(10, 0)
    references: Any = SimpleNamespace(resting=resting, pass_over=resting.pass_over)
    watch: Any = SimpleNamespace(due=rig.now)
    rest = ControllerRest(rig.loop, references, health_every, [watch])
    looks, begun, run = [], rig.loop.cycle, 0
    while rig.loop.cycle < begun + 500:
        now = rig.now
        rig.run(1)
        run += 1
        resting.due(resting=True)
        assert now < watch.due + PERIOD
        if now >= watch.due:
            watch.due = now + BETWEEN_LOOKS
        if rig.loop.cycle % health_every == 0:
            looks.append(rig.loop.cycle)
        rest.left_out(rest.periods())
    assert run < 350  # of 500 periods
    assert looks == [k for k in range(begun + 1, looks[-1] + 1) if k % health_every == 0]
    assert looks[-1] > begun + 500 - 2 * health_every
