"""The commands, in one table, which help, documentation and tests read."""

from typing import Final

from robots_controller.commands import cell_arguments, tool_arguments
from robots_controller.commands.command import Command

CELL: Final = Command(
    'cell',
    'starts, monitors, records and stops the nodes of a robot cell',
    cell_arguments.cell_arguments,
    'robots_controller.live_cell.command_line:start_cell',
    json=True,
)
SIMULATE: Final = Command(
    'simulate',
    'runs a program in a simulated cell, without ROS and faster than real time, and writes a bag',
    cell_arguments.simulate_arguments,
    'robots_controller.simulation.command_line:start_simulation',
    json=True,
)
CHECK_PROGRAM: Final = Command(
    'check_program',
    'finds mistakes in robot programs before anything moves, by reading them or by simulating them with '
    'every combination of their inputs',
    tool_arguments.check_program_arguments,
    'robots_controller.program_check.check_program:check_programs',
    json=True,
)
REPORT: Final = Command(
    'report',
    'shows a recorded run as an HTML page and in the terminal, or compares two runs',
    tool_arguments.report_arguments,
    'robots_controller.report.command_line:report',
    json=True,
)
STUDY: Final = Command(
    'study',
    'simulates a program over a grid of robots, drives, speeds and parameters, and writes one table',
    tool_arguments.study_arguments,
    'robots_controller.study.command_line:study',
    json=True,
)
CHECK_BAG: Final = Command(
    'check_bag',
    'compares a recorded bag with an expected one, within tolerances',
    tool_arguments.check_bag_arguments,
    'robots_controller.recording.check_bag:check_bag',
    json=True,
)
REPLAY_BAG: Final = Command(
    'replay_bag',
    'publishes the messages of a recorded bag at their times, the last state of latched topics first',
    tool_arguments.replay_bag_arguments,
    'robots_controller.nodes.bags.replay_bag:replay_bag',
)
LUA_META: Final = Command(
    'lua_meta',
    "prints the editor's help for robot programs (Lua language server)",
    tool_arguments.lua_meta_arguments,
    'robots_controller.editor.lua_meta:print_definitions',
)
LIST: Final = Command(
    'list',
    'lists the robots that are installed',
    lambda _: None,  # it takes none
    'robots_controller.commands.robot_commands:list_robots',
    json=True,
)
SHOW: Final = Command(
    'show',
    'shows a robot: its axes, limits, dimensions and their source',
    tool_arguments.show_arguments,
    'robots_controller.commands.robot_commands:show_robot',
    json=True,
)
CHECK: Final = Command(
    'check',
    'checks a URDF: what was found, what is missing, and what was taken in its place',
    tool_arguments.check_arguments,
    'robots_controller.commands.robot_commands:check_robot',
    json=True,
)
MEASURE: Final = Command(
    'measure',
    'measures a tool or a base from taught points, or a payload from a recorded motion, and saves it by name',
    tool_arguments.measure_arguments,
    'robots_controller.measuring.measure:measure',
    json=True,
)
EXPLAIN: Final = Command(
    'explain',
    'explains an error by its code, and what to do about it',
    tool_arguments.explain_arguments,
    'robots_controller.commands.error_catalogue:explain',
)

ABOUT_ROBOTS: Final = (LIST, SHOW, CHECK, MEASURE, EXPLAIN)
"""Commands that are there below `robots` alone."""
TOOLS: Final = (CELL, SIMULATE, CHECK_PROGRAM, REPORT, STUDY, CHECK_BAG, REPLAY_BAG, LUA_META)
"""Commands that have executables of their own too."""
