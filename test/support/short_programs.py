"""The programs of programs/ as tests run them: shortened, so that things are done once, nearer, or sooner."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path

PROGRAMS = Path(__file__).parents[2] / 'programs'
# Text of a program and what stands in its place.
SHORTENED = {
    'palletizing.lua': {
        'ROWS, COLUMNS, LAYERS, GAP = 2, 2, 2,': 'ROWS, COLUMNS, LAYERS, GAP = 1, 2, 1,',
        'PALLET = {1.20, -1.30, 0.10,': 'PALLET = {1.20, -0.60, 0.10,',
    },
    'laser_seam.lua': {'LINES, STEP = 70': 'LINES, STEP = 50'},
    # Its first seconds, in which the car speeds up.
    'motion_simulator.lua': {'TIME = 26': 'TIME = 3'},
    'motion_simulator/on_linear_axis.lua': {'TIME = 26': 'TIME = 2'},
    'press_tending.lua': {
        'PATIENCE = 2, 10': 'PATIENCE = 1, 10',
        'FEEDER = {0.30, 1.60, 0.70, 90,': 'FEEDER = {1.60, 0.80, 0.70, 30,',
        'TRAY = {0.30, -1.60, 0.70, -90,': 'TRAY = {1.60, -0.80, 0.70, -30,',
        # The wrist stays as it is at all three places.
        'ptpJointSpaceAngles(0, -100, 110, 0, 80, 0)': 'ptpJointSpaceAngles(0, -100, 110, 0, 80, -180)',
    },
    # One run, nearer to the soil and not as far.
    'wheel_laboratory.lua': {
        '{0, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8}': '{0.2}',
        'PRESSING, DRIVING = 3.5, 7': 'PRESSING, DRIVING = 1.3, 2',
        'NEAR, ABOVE = 0.02, 0.10': 'NEAR, ABOVE = 0.003, 0.03',
    },
    'debris_removal.lua': {'ptpJointSpaceAngles(6, 28, 90)': 'ptpJointSpaceAngles(5, 36, 75)'},
    # The target is close before the gripper, and wheels of more torque steady it.
    'debris_removal/orbit.yaml': {
        'distance: 0.3,': 'distance: 0.04,',
        'torque: 0.4, capacity: 12, time_constant: 2.5': 'torque: 9, capacity: 12, time_constant: 0.5',
    },
    'rover_placement.lua': {
        'DOWN, PATIENCE = 0.15, 3': 'DOWN, PATIENCE = 0.05, 3',
        'setSpeed(0.5) --': 'setSpeed(1) --',
    },
    # A hundred calls in a row now and then: thousands take longer than all else.
    'language/tasks/mirror.lua': {
        'while true do': 'while true do wait(0.05) for _ = 1, 60 do',
        'or 0)': 'or 0) end',
    },
}


# For runs that are only compared with others: as long as it takes for all of it to happen.
SHORTEST = SHORTENED | {
    'language/tasks/mirror.lua': {'while true do': 'while true do wait(0.02)'},
    # A gripper that misses nothing, and the wheels for what it grasps then.
    'debris_removal/orbit.yaml': SHORTENED['debris_removal/orbit.yaml']
    | {
        'reach: 0.005, speed: 0.05, rotation: 0.06': 'reach: 0.06, speed: 0.3, rotation: 0.3',
        'torque: 0.4, capacity: 12, time_constant: 2.5': 'torque: 30, capacity: 60, time_constant: 0.3',
    },
    'motion_simulator/on_linear_axis.lua': {'TIME = 26': 'TIME = 1'},
    'motion_simulator.lua': {'TIME = 26': 'TIME = 1'},
    'wheel_laboratory.lua': SHORTENED['wheel_laboratory.lua']
    | {'PRESSING, DRIVING = 3.5, 7': 'PRESSING, DRIVING = 0.6, 0.9'},
}


def short_copy(folder: Path, program: str, texts: Mapping[str, Mapping[str, str]] = SHORTENED) -> Path:
    """A copy of all programs in a new folder, with this one shortened; returns the path of this one."""
    shutil.copytree(PROGRAMS, folder)
    own = program.removesuffix('.lua') + '/'
    for name in (program, *(name for name in texts if name.startswith(own))):
        path = folder / name
        text = path.read_text()
        for old, new in texts.get(name, {}).items():
            assert text.count(old) == 1
            text = text.replace(old, new)
        path.write_text(text)
    return folder / program
