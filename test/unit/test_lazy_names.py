"""Packages export their names without loading modules that are not used."""

from __future__ import annotations

import json
import sys
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points
from itertools import pairwise
from pathlib import Path
from pkgutil import walk_packages
from subprocess import run
from types import ModuleType

import pytest

import robots_core
import robots_core.blocks
import robots_planning
from robots_core import load_robot_model
from robots_core.blocks import CollisionDetection

WELDING = Path(__file__).parents[2] / 'programs' / 'welding.lua'
PACKAGES = (robots_core, robots_core.blocks, robots_planning)
# Reading meshes, SciPy and compiled functions take most of the time that a process needs to start.
MESHES = ('trimesh', 'yourdfpy', 'networkx')
SCIPY = ('scipy.spatial', 'scipy.linalg', 'scipy.interpolate')
COMPILER = ('numba',)
VIEW = ('viser',)
LUA = ('lupa',)
PLANT = ('asyncua', 'pymodbus', 'paho')
HEAVY = (*MESHES, *SCIPY, *COMPILER, *VIEW, *LUA, *PLANT)
NODES = {
    point.module
    for point in entry_points(group='console_scripts')
    if point.name.endswith('_node') and point.value.startswith('robots_')
}
# Nodes that load something heavy; all others do without.
WITH_COMPILER = (
    'robots_core.nodes.inverse_kinematics_node',
    'robots_core.nodes.dynamics_node',
    'robots_controller.nodes.controller_node',
    'robots_core.nodes.collision_node',
    'robots_planning.nodes.planning_node',
)
LUA_PROGRAM = 'robots_controller.nodes.lua_program_node'
MOTION_CUEING = 'robots_core.nodes.motion_cueing_node'
PENDANT = 'robots_controller.nodes.pendant_node'
VISUALIZER = 'robots_core.nodes.visualizer_node'
WITH_MORE = (LUA_PROGRAM, MOTION_CUEING, PENDANT, VISUALIZER)


@pytest.mark.parametrize('package', PACKAGES, ids=lambda package: package.__name__)
def test_every_name_is_what_its_module_defines(package: ModuleType):
    for module in walk_packages(package.__path__, f'{package.__name__}.'):
        if '.nodes' not in module.name:
            import_module(module.name)
    assert set(package.__all__) <= set(dir(package))
    for name in package.__all__:
        assert not isinstance(getattr(package, name), ModuleType), name


def test_a_name_that_no_module_has_is_refused():
    with pytest.raises(ImportError, match='NoBlock'):
        from robots_core.blocks import NoBlock  # noqa: F401, PLC0415


def imports(*modules: str) -> dict[str, str]:
    return {module: f'import {module}' for module in modules}


PLANNING = (
    'from robots_core import Pose, load_robot_model; from robots_planning import {planner};'
    'robot = load_robot_model("kuka_kr210_r2700"); start = robot.home + 0.1;'
    'r, T = robot.direct_kinematics(start); {planner}(robot).generate(start, {target})'
)
# What processes run step by step, by what they do without. What a step loads is there in all steps after it:
# each set holds those below it.
LEAN: tuple[dict[tuple[str, ...], dict[str, str]], ...] = (
    {
        (*HEAVY, 'coverage', 'numpy', 'pinocchio'): imports('robots_core'),
        (*HEAVY, 'coverage'): {
            **imports(
                *sorted(NODES - {*WITH_COMPILER, *WITH_MORE}),
                'robots_controller.commands.robot_commands',
                'robots_controller.recording.check_bag',
                'robots_controller.nodes.bags.replay_bag',
            ),
            'kinematics and dynamics of a robot': (
                'from robots_core import load_robot_model; robot = load_robot_model("kuka_kr210_r2700");'
                'robot.direct_kinematics(robot.home); robot.jacobian(robot.home);'
                'robot.rigid_dynamics(robot.home, robot.home, robot.home)'
            ),
        },
        (*MESHES, *SCIPY, *VIEW, *LUA, *PLANT, 'coverage'): {
            **imports(
                'robots_core.kernels.compiled',
                *WITH_COMPILER,
            ),
            'a line': PLANNING.format(planner='LinearCartesianLimited', target='Pose(r + 0.02, T)'),
            'a spline': PLANNING.format(
                planner='SplineCartesian', target='[Pose(r + (0.02, 0.0, 0.0), T), Pose(r + 0.02, T)]'
            ),
        },
        (*MESHES, *VIEW, *LUA, *PLANT): imports(MOTION_CUEING),
    },
    {
        (*MESHES, *SCIPY, *COMPILER, *VIEW, *PLANT, 'coverage'): imports(
            LUA_PROGRAM,
            'robots_controller.live_cell.cell_command',
            'robots_controller.live_cell.cell_run',
            'robots_controller.program_check.check_program',
            'robots_controller.commands.error_catalogue',
        ),
        (*MESHES, *SCIPY, *VIEW, *PLANT): {
            **imports(
                PENDANT,
                'robots_controller.simulation.command_line',
                'robots_controller.program_check.walk',
                'robots_controller.report.run_report',
            ),
            'a program, simulated, recorded and reported': (
                'import tempfile; from robots_controller.simulate import simulate\n'
                'from robots_controller.report.run_report import run_report\n'
                'with tempfile.TemporaryDirectory() as folder:\n'
                f'    simulate({str(WELDING)!r}, robot="kuka_kr210_r2700", bag=f"{{folder}}/bag")\n'
                '    assert run_report(f"{folder}/bag").ok'
            ),
        },
    },
    {(*LUA, *COMPILER): imports(VISUALIZER)},
)
STEPS = [(number, step) for number, sets in enumerate(LEAN) for steps in sets.values() for step in steps]


def printed(program: str) -> list[str]:
    """What a process of its own prints, by words."""
    done = run([sys.executable, '-P', '-c', program], capture_output=True, text=True, check=True)
    return done.stdout.split()


@cache
def loaded(process: int) -> dict[str, list[str]]:
    """What was there after each step of a process that the step has to do without."""
    # What is computed from the meshes is kept from then on.
    CollisionDetection(load_robot_model('kuka_kr210_r2700'))
    steps = [
        (name, code, unneeded) for unneeded, codes in LEAN[process].items() for name, code in codes.items()
    ]
    program = (
        'import gc, json, sys\n'
        'found = {}\n'
        f'for name, code, unneeded in {steps!r}:\n'
        '    exec(code, {})\n'
        '    found[name] = sorted(set(unneeded) & set(sys.modules)) + ["garbage"] * (not gc.isenabled())\n'
        'print(json.dumps(found))'
    )
    found: dict[str, list[str]] = json.loads(' '.join(printed(program)))
    return found


@pytest.mark.parametrize(('process', 'step'), STEPS)
def test_a_process_loads_nothing_that_it_does_not_need_and_collects_its_garbage(process: int, step: str):
    assert loaded(process)[step] == []


def test_each_step_of_a_process_does_without_all_that_those_after_it_do():
    for sets in LEAN:
        for before, after in pairwise(sets):
            assert set(before) > set(after)


def test_scipy_and_numba_have_their_linear_algebra_and_no_garbage_is_collected_where_none_was():
    program = (
        'import gc; gc.disable(); import robots_core.kernels.compiled; print(not gc.isenabled());'
        'import numba, numpy as np, scipy.linalg;'
        'from scipy.linalg import cython_blas, cython_lapack;'
        'A = np.array([[2.0, 1.0], [1.0, 3.0]]); b = np.ones(2);'
        'solve = numba.njit(lambda A, b: np.dot(np.linalg.inv(A), b) + np.dot(A, b));'
        'print(np.allclose(solve(A, b), scipy.linalg.solve(A, b) + A @ b));'
        'print("dgemm" in cython_blas.__pyx_capi__, "dgesdd" in cython_lapack.__pyx_capi__)'
    )
    assert printed(program) == ['True'] * 4
