"""The functions of robot programs (paper, table 2, and more in its style).

`LUA_FUNCTIONS` describes each once: registration, argument checks, the reference, the editor's help and the
check of a program are made from it.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from robots_controller.interpreter.functions.flow import Flow, MainFlow
from robots_controller.interpreter.functions.guidance import Guidance
from robots_controller.interpreter.functions.interrupts import Interrupts
from robots_controller.interpreter.functions.kinematics import Kinematics
from robots_controller.interpreter.functions.lua_function import LuaFunction
from robots_controller.interpreter.functions.motions import Motions
from robots_controller.interpreter.functions.persistence import Persistence
from robots_controller.interpreter.functions.poses import Poses
from robots_controller.interpreter.functions.positions import Positions
from robots_controller.interpreter.functions.run_context import Family
from robots_controller.interpreter.functions.search import Search
from robots_controller.interpreter.functions.settings import Settings
from robots_controller.interpreter.functions.signals import Signals

TASK_FAMILIES: Final = (Positions, Poses, Kinematics, Signals, Flow, Persistence)
"""Those that tasks have too."""
MAIN_FAMILIES: Final = (Settings, Interrupts, Guidance, MainFlow)
"""Those that the main program alone has, besides its motions and searches."""


def _functions(*families: type[Family]) -> Mapping[str, LuaFunction]:
    return MappingProxyType(
        {function.name: function for family in families for function in family.functions()}
    )


LUA_FUNCTIONS: Final = _functions(Motions, Search, *MAIN_FAMILIES, *TASK_FAMILIES)
"""All functions of robot programs, by name."""

TASK_FUNCTIONS: Final = frozenset(_functions(*TASK_FAMILIES))
"""Those that tasks have."""
