"""The figures in the pages that explain are those of the code."""

from __future__ import annotations

import re

from robots_controller.control.controller_rates import (
    CHECKS_PER_TIMEOUT,
    FEEDBACK_RATE,
    HOLDING_RATE,
    PROGRESS_RATE,
    SETTLING_RATE,
)
from robots_controller.control.controller_settings import ControllerSettings
from robots_controller.control.stops.limit_guard import RELATIVE_TOLERANCE
from robots_controller.program.turn_clock import CALLS_PER_PERIOD, INSTRUCTIONS_PER_PERIOD
from robots_controller.simulation.simulated_clock import START
from robots_core.blocks.collision.results import RESOLUTION
from robots_core.blocks.drives.reference_check import STAMP_ERROR
from robots_core.blocks.zones.zone_passages import MARGIN
from robots_core.periodic.periodic_schedule import MAX_LATE_PERIODS
from robots_core.periodic.resting_rate import RESTED, RESTING_RATE
from robots_core.robot_model.axes_data import LIMIT_TOLERANCE
from robots_planning.trajectory_generators.trajectory_generator import LIMIT_MARGIN
from robots_planning.verification.trajectory_verification import (
    DYNAMICS_PERIOD,
    LINE_TOLERANCE,
    RATIO_TOLERANCE,
    SAMPLE_PERIOD,
)

from .test_documentation import DOCS, section, table

LIMITS = DOCS / 'explanation' / 'limits.md'
CLOCKS = DOCS / 'explanation' / 'time_and_clocks.md'


def test_the_margins_are_those_of_the_stages() -> None:
    margins = [float(row[0].split()[0]) for row in table(LIMITS, 'Margins')]
    assert margins == [
        LIMIT_MARGIN,
        RATIO_TOLERANCE,
        RELATIVE_TOLERANCE,
        1e6 * STAMP_ERROR,
        LIMIT_TOLERANCE,
        1e3 * RESOLUTION,
        1e3 * MARGIN,
    ]
    path = next(
        row for row in table(LIMITS, 'What limits are guaranteed, and how that is shown') if 'path' in row[0]
    )
    assert path[2] == f'within {1e3 * LINE_TOLERANCE:g} mm and {LINE_TOLERANCE:.0e} rad'.replace(
        'e-05', 'e-5'
    )
    text = section(LIMITS, 'Verification: every plan at 1 kHz')
    assert SAMPLE_PERIOD == 1e-3
    assert f'at {1.0 / DYNAMICS_PERIOD:g} Hz' in text


def test_the_rates_are_those_of_the_controller() -> None:
    title = 'The period of the controller'
    rates = [float(re.findall(r'[\d.]+', row[0])[0]) for row in table(CLOCKS, title)[1:]]
    holding = max(HOLDING_RATE, CHECKS_PER_TIMEOUT / ControllerSettings().feedback_timeout)
    assert rates == [SETTLING_RATE, FEEDBACK_RATE, holding, PROGRESS_RATE, RESTING_RATE]
    text = section(CLOCKS, title)
    assert f'moving average of {1e3 * ControllerSettings().smoothing_time:g} ms' in text
    assert ['five'][MAX_LATE_PERIODS - 5] in text
    assert f'have stood for {RESTED:g} s' in text


def test_the_simulated_time_is_that_of_the_clock() -> None:
    text = CLOCKS.read_text()
    assert f'begins at {START // 10**9} s' in text
    assert f'every {CALLS_PER_PERIOD} calls' in text
    assert f'every {INSTRUCTIONS_PER_PERIOD:,} instructions'.replace(',', ' ') in text
