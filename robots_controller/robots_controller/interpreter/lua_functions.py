"""The functions of robot programs (paper, table 2, and more in its style).

`LUA_FUNCTIONS` describes each once: registration, argument checks, the reference, the editor's help and the
check of a program are made from it.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from robots_controller.interpreter.functions.flow import FLOW
from robots_controller.interpreter.functions.guidance import GUIDANCE
from robots_controller.interpreter.functions.interrupts import INTERRUPTS
from robots_controller.interpreter.functions.kinematics import KINEMATICS
from robots_controller.interpreter.functions.lua_function import LuaFunction
from robots_controller.interpreter.functions.motions import MOTIONS
from robots_controller.interpreter.functions.persistence import PERSISTENCE
from robots_controller.interpreter.functions.poses import POSES
from robots_controller.interpreter.functions.positions import POSITIONS
from robots_controller.interpreter.functions.search import SEARCH
from robots_controller.interpreter.functions.settings import SETTINGS
from robots_controller.interpreter.functions.signals import SIGNALS
from robots_controller.interpreter.functions.tasks import TASKS

_FAMILIES: Final = (
    MOTIONS,
    SEARCH,
    SETTINGS,
    POSITIONS,
    POSES,
    KINEMATICS,
    SIGNALS,
    INTERRUPTS,
    GUIDANCE,
    FLOW,
    PERSISTENCE,
    TASKS,
)
LUA_FUNCTIONS: Final[Mapping[str, LuaFunction]] = MappingProxyType(
    {function.name: function for family in _FAMILIES for function in family}
)
"""All functions of robot programs, by name."""

TASK_FUNCTIONS: Final = frozenset(
    function.name
    for family in (POSITIONS, POSES, KINEMATICS, SIGNALS, FLOW, PERSISTENCE)
    for function in family
    if function.name != 'halt'
)
"""Those that tasks have."""

PAPER_FUNCTIONS: Final = (
    'ptpCartesianSpace',
    'ptpJointSpaceAngles',
    'ptpJointSpacePosition',
    'setDigitalOutput',
    'getDigitalInput',
    'setAnalogOutput',
    'getAnalogInput',
    'wait',
    'print',
)
"""Those of the paper's table 2."""
